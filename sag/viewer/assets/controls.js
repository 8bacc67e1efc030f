// Buttons, choices and keys; all of them act on the player and show what it is at.

const SPEEDS = [0.25, 0.5, 1, 1.5, 2];

const KEYS = [
  ['space', 'play or pause'], ['← →', 'a frame back or on'], ['home, end', 'first or last frame'],
  ['1 – 9', 'show or hide a sample'], ['g', 'recorded motion'], ['c', 'collision points'], ['f', 'follow the root'],
  ['t', 'surfaces or points'], ['0', 'view from the camera'], ['r', 'reset the view'], ['[ ]', 'slower, faster'],
  ['↑ ↓', 'row before or after'], ['< >', 'window before or after'], ['shift + arrows', 'orbit'], ['+ −', 'nearer, farther'],
  ['drag, one finger', 'orbit'], ['right drag, two fingers', 'move'], ['wheel, pinch', 'nearer, farther'], ['?', 'this help'],
];

function fillChoice(select, names, chosen) {
  select.replaceChildren(...names.map((name, place) => new Option(name, place)));
  byId(`${select.id}-choice`).hidden = names.length < 2;
  select.addEventListener('change', () => chosen(Number(select.value)));
}

function connect(player) {
  const { state } = player;
  fillChoice(byId('row'), content.windows[0].rows.map((row) => row.name), (row) => player.chooseRow(row));
  fillChoice(byId('window'), content.windows.map((view) => view.name), (place) => player.chooseWindow(place));
  byId('speed').append(...SPEEDS.map((speed) => new Option(`${speed} ×`, speed)));
  byId('speed').addEventListener('change', () => player.set({ speed: Number(byId('speed').value) }));
  byId('truth-button').addEventListener('click', () => player.toggle(player.motions.length));
  byId('touch-button').addEventListener('click', () => player.set({ touches: !state.touches }));
  byId('follow-button').addEventListener('click', () => player.set({ follow: !state.follow }));
  byId('points-button').addEventListener('click', () => player.set({ points: !state.points }));
  byId('camera-button').addEventListener('click', () => player.look('toTheCamera'));
  byId('reset-button').addEventListener('click', () => player.look('reset'));
  byId('help-button').addEventListener('click', () => byId('help').showModal());
  byId('keys').append(...KEYS.flatMap(([key, does]) =>
    [element('dt', {}, element('kbd', { textContent: key })), element('dd', {}, does)]));
  document.addEventListener('keydown', (event) => press(player, event));
}

function press(player, event) {
  const { state } = player;
  const field = event.target.closest('select, input, button, dialog');
  if (event.ctrlKey || event.metaKey || event.altKey || byId('help').open) return;
  if (field && (event.key === ' ' || event.key === 'Enter' || event.key.startsWith('Arrow')) && field.type !== 'range') return;
  if (field && field.matches('select')) return;
  const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
  const acts = {
    ' ': () => player.play(!state.playing),
    ArrowLeft: () => player.step(-1), ArrowRight: () => player.step(1),
    ArrowUp: () => player.chooseRow(state.row - 1), ArrowDown: () => player.chooseRow(state.row + 1),
    Home: () => player.seek(0), End: () => player.seek(player.frames - 1),
    '<': () => player.chooseWindow(state.window - 1), '>': () => player.chooseWindow(state.window + 1),
    ',': () => player.chooseWindow(state.window - 1), '.': () => player.chooseWindow(state.window + 1),
    '[': () => player.quicken(-1), ']': () => player.quicken(1),
    g: () => player.toggle(player.motions.length), c: () => player.set({ touches: !state.touches }),
    f: () => player.set({ follow: !state.follow }), t: () => player.set({ points: !state.points }),
    0: () => player.look('toTheCamera'), r: () => player.look('reset'),
    '+': () => player.orbit.zoom(0.88), '=': () => player.orbit.zoom(0.88), '-': () => player.orbit.zoom(1.14),
    '?': () => byId('help').showModal(),
  };
  let act = event.shiftKey && turns[event.key] ? () => player.orbit.turn(...turns[event.key]) : acts[event.key];
  if (/^[1-9]$/.test(event.key)) act = () => player.toggle(Number(event.key) - 1, true);
  if (!act) return;
  event.preventDefault();
  act();
}

// Shows the state on every control.
function showState(player) {
  const { state } = player;
  const truth = player.view.truth;
  const pressed = {
    truth: truth && state.shown[player.motions.length], touch: state.touches, follow: state.follow, points: state.points,
  };
  for (const [name, on] of Object.entries(pressed)) byId(`${name}-button`).setAttribute('aria-pressed', Boolean(on));
  byId('truth-button').hidden = !truth;
  byId('touch-button').hidden = byId('points-button').hidden = !player.view.scene;
  byId('row').value = state.row;
  byId('window').value = state.window;
  byId('speed').value = state.speed;
}
