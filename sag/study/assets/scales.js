// The questions: a scale of buttons each, answered by mouse, finger, tab and arrows, or digits.

class Scales {
  constructor(asked, changed) {
    this.changed = changed;
    this.questions = asked.questions;
    this.active = 0;
    this.sets = asked.questions.map((question, place) => this.made(question, place, asked));
    byId('scales').replaceChildren(...this.sets);
  }

  made(question, place, { scale, ends }) {
    const choices = scale.map((score) => {
      const meaning = { [scale[0]]: ends[0], [scale[scale.length - 1]]: ends[1] }[score];
      const input = element('input', { type: 'radio', name: question.name, value: score });
      input.setAttribute('aria-label', meaning ? `${score}, ${meaning}` : `${score}`);
      input.addEventListener('change', () => this.choose(place, score));
      return element('label', {}, input, element('span', { textContent: score }));
    });
    const hint = element('p', { className: 'hint', id: `hint-${question.name}`, textContent: question.hint });
    const set = element('fieldset', {},
      element('legend', { textContent: question.asked }), hint,
      element('div', { className: 'scale' }, ...choices),
      element('p', { className: 'ends' }, ...ends.map((end, last) =>
        element('span', { textContent: `${last ? scale[scale.length - 1] : scale[0]} ${end}` }))));
    set.querySelector('.ends').setAttribute('aria-hidden', 'true');
    set.setAttribute('aria-describedby', hint.id);
    set.addEventListener('focusin', () => this.activate(place));
    return set;
  }

  // The scores by name of the question; what is not answered is missing.
  get scores() {
    const given = this.sets.map((set) => set.querySelector('input:checked'));
    return Object.fromEntries(given.flatMap((input) => (input ? [[input.name, Number(input.value)]] : [])));
  }

  get whole() { return Object.keys(this.scores).length === this.questions.length; }

  show(scores = {}) {
    this.sets.forEach((set, place) => set.querySelectorAll('input').forEach((input) => {
      input.checked = scores[this.questions[place].name] === Number(input.value);
    }));
    this.activate(0);
    this.changed();
  }

  // A digit answers the question whose turn it is.
  press(score) {
    const input = this.sets[this.active].querySelector(`input[value="${score}"]`);
    if (!input || input.disabled) return;
    input.checked = true;
    this.choose(this.active);
  }

  choose(place) {
    const open = this.sets.findIndex((set) => !set.querySelector('input:checked'));
    this.activate(open < 0 ? place : open);
    this.changed();
  }

  activate(place) {
    this.active = place;
    this.sets.forEach((set, other) => set.classList.toggle('active', other === place));
  }

  lock(on) { this.sets.forEach((set) => { set.disabled = on; }); }
}
