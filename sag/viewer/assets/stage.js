// The stage: the scene, the picture and the clock that moves both; what is shown is said by who extends it.

const PAUSE_AT_END = 0.6;
const LONGEST_STEP = 0.5;
const TOO_SLOW = 0.15;

const byId = (id) => document.getElementById(id);

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

class Stage {
  constructor(state) {
    this.still = matchMedia('(prefers-reduced-motion: reduce)');
    this.state = { time: 0, playing: false, speed: 1, touches: false, follow: false, points: false, ...state };
    this.orbit = new Orbit(byId('scene'), () => this.redraw());
    this.picture = new Picture(byId('picture'));
    try {
      this.renderer = new Renderer(byId('scene'));
    } catch (error) {
      this.withoutScene(error);
    }
  }

  // What who extends it tells: the window that is shown, the motions that have marks, and what else is to be said.
  get view() { throw new Error('no window'); }
  get listed() { return []; }
  bodies() { return []; }
  withoutScene() {}
  shown() {}
  frameShown() {}

  get frames() { return this.listed[0].frames; }
  get frame() { return Math.min(this.frames - 1, Math.round(this.state.time)); }

  begin() {
    byId('play').addEventListener('click', () => this.play(!this.state.playing));
    byId('frame').addEventListener('input', () => this.seek(Number(byId('frame').value)));
    new ResizeObserver(() => this.resized()).observe(byId('stage'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.redraw());
    requestAnimationFrame((now) => this.tick(now));
  }

  resized() { this.redraw(); }

  redraw() { this.stale = true; }

  // Takes another window, seen from where all that moves in it can be seen.
  showWindow(view, motions) {
    if (this.renderer) this.renderer.show(view, () => this.redraw());
    this.picture.show(view, () => this.redraw());
    this.orbit.place(view, extentOf(motions));
    this.orbit.reset();
  }

  set(changes) {
    Object.assign(this.state, changes);
    byId('play').setAttribute('aria-label', this.state.playing ? 'Pause' : 'Play');
    byId('play').classList.toggle('playing', this.state.playing);
    this.shown();
    this.redraw();
  }

  play(on) {
    if (on && this.state.time >= this.frames - 1) this.state.time = 0;
    this.set({ playing: on });
  }

  seek(frame) { this.set({ time: Math.min(this.frames - 1, Math.max(0, frame)) }); }

  step(frames) {
    this.state.playing = false;
    this.seek(this.frame + frames);
  }

  look(from) {
    this.set({ follow: false });
    this.orbit[from]();
  }

  tick(now) {
    const passed = Math.min(LONGEST_STEP, (now - (this.last || now)) / 1000);
    this.last = now;
    if (this.state.playing) this.advance(passed);
    this.easeOff(passed);
    if (this.stale) {
      this.stale = false;
      this.draw();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  // Draws fewer pixels where the machine is too slow to play them, as without a graphics card.
  easeOff(seconds) {
    this.late = this.state.playing && seconds > TOO_SLOW ? (this.late || 0) + 1 : 0;
    if (this.late < 5 || !this.renderer || this.renderer.fineness <= 0.5) return;
    this.renderer.fineness /= 2;
    this.late = 0;
  }

  advance(seconds) {
    const end = this.frames - 1;
    const { state } = this;
    this.waited = state.time >= end ? (this.waited || 0) + seconds : 0;
    if (state.time < end) state.time = Math.min(end, state.time + seconds * content.fps * state.speed);
    else if (this.waited > PAUSE_AT_END) state.time = 0;
    this.redraw();
  }

  draw() {
    const bodies = this.bodies();
    if (this.state.follow && bodies.length) {
      const roots = bodies.map(({ joints }) => jointOf(joints, content.root));
      this.orbit.target = mixed(this.orbit.target, scaled(roots.reduce(add), 1 / roots.length), this.still.matches ? 1 : 0.25);
    }
    if (this.renderer) {
      const line = getComputedStyle(document.documentElement).getPropertyValue('--wire').trim();
      this.renderer.draw(bodies, this.orbit, { ...this.state, line: channelsOf(line) });
    }
    this.picture.draw(bodies);
    this.showClock();
    this.frameShown(bodies);
    this.drawn = (this.drawn || 0) + 1;
  }

  showClock() {
    const slider = byId('frame');
    slider.max = this.frames - 1;
    slider.value = this.frame;
    const seconds = (this.state.time / content.fps).toFixed(2);
    slider.setAttribute('aria-valuetext', `frame ${this.frame} of ${this.frames - 1}, ${seconds} seconds`);
    byId('clock').textContent = `${seconds} s`;
  }
}
