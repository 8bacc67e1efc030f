// Where answers go: to the server that gave the page, or into this browser until they are downloaded as a file.

const WAITS = [1, 2, 4, 8];
const wait = (seconds) => new Promise((done) => setTimeout(done, 1000 * seconds));

// Storage of the browser, or of the page alone where the browser gives none.
const storage = (() => {
  const spare = new Map();
  const own = { getItem: (key) => spare.get(key) || null, setItem: (key, value) => spare.set(key, value), removeItem: (key) => spare.delete(key) };
  try {
    localStorage.setItem('sag-study', '1');
    localStorage.removeItem('sag-study');
    return { kept: true, of: localStorage };
  } catch {
    return { kept: false, of: own };
  }
})();

class Refusal extends Error {}

// Sends until there is an answer; `late` is told when it takes another try.
async function insisted(url, options, late) {
  for (let turn = 0; ; turn++) {
    try {
      const answer = await fetch(url, options);
      if (answer.ok || answer.status === 409) return answer;
      if (answer.status < 500) throw new Refusal((await answer.json()).error);
    } catch (error) {
      if (error instanceof Refusal) throw error;
    }
    late();
    await wait(WAITS[Math.min(turn, WAITS.length - 1)]);
  }
}

const sent = (body) => ({ method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body) });

class ServerKeeper {
  constructor(study, session) {
    this.rater = session.rater;
    this.answered = new Set(session.answered);
    this.unsent = `sag-study-${study.name}-${session.rater}`;
    storage.of.setItem(`sag-study-${study.name}`, session.rater);
  }

  async scene(name, late) {
    if (!content.windows[name]) content.windows[name] = await (await insisted(`scenes/${name}`, {}, late)).json();
  }

  // What was answered before the page was left, and never acknowledged.
  pending() { return JSON.parse(storage.of.getItem(this.unsent)); }

  // Comes back once the server has the answer on its disk; an answer it had already is as good.
  async save(turn, answer, late) {
    storage.of.setItem(this.unsent, JSON.stringify({ turn, answer }));
    await insisted('answers', sent({ rater: this.rater, ...answer }), late);
    this.answered.add(turn);
    storage.of.removeItem(this.unsent);
  }
}

class FileKeeper {
  constructor(study, session, scenes) {
    content.windows = scenes;
    this.study = study.name;
    this.rater = session.rater;
    this.place = `sag-study-${study.name}-${session.rater}`;
    this.answers = JSON.parse(storage.of.getItem(this.place)) || {};
  }

  get answered() { return new Set(Object.keys(this.answers).map(Number)); }

  async scene() {}

  pending() { return null; }

  async save(turn, answer) {
    this.answers[turn] = answer;
    storage.of.setItem(this.place, JSON.stringify(this.answers));
  }

  download() {
    const text = JSON.stringify({ study: this.study, rater: this.rater, answers: Object.values(this.answers) }, null, 1);
    const link = element('a', { download: `answers-${this.rater.split('.')[0]}.json` });
    link.href = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }
}
