// The study: instructions, then one motion after the other, then thanks.

const told = content.study;
const parsed = (id) => JSON.parse(byId(id).textContent);

class Study {
  constructor() {
    this.session = parsed('session');
    this.clip = new Clip(() => this.update());
    this.scales = new Scales(told, () => this.update());
    this.instruct();
    if (this.session) this.admit();
    byId('start').addEventListener('click', () => this.start());
    byId('resume').addEventListener('click', () => this.resume());
    byId('questions').addEventListener('submit', (event) => { event.preventDefault(); this.answer(); });
    for (const id of ['download', 'so-far']) byId(id).addEventListener('click', () => this.keeper.download());
    byId('camera-button').addEventListener('click', () => this.clip.look('toTheCamera'));
    byId('reset-button').addEventListener('click', () => this.clip.look('reset'));
    document.addEventListener('keydown', (event) => this.press(event));
  }

  get turns() { return this.session.turns; }
  get next() { return this.turns.findIndex((_, turn) => !this.keeper.answered.has(turn)); }
  get isFile() { return this.session && this.session.place === 'file'; }

  instruct() {
    byId('asked').append(...told.questions.map((question) =>
      element('li', {}, element('b', { textContent: question.asked }), ` ${question.hint}`)));
    byId('lowest').textContent = told.ends[0];
    byId('highest').textContent = told.ends[1];
    byId('length').textContent = `There are ${told.turns} motions, which takes about ${told.minutes} minute` +
      `${told.minutes > 1 ? 's' : ''}. You can stop at any time and go on later where you were: ` +
      (this.isFile ? 'this file remembers, in this browser.' : 'the address of the next page is yours alone.');
    if (this.clip.missing) this.refuse();
    else if (!this.session && storage.of.getItem(`sag-study-${told.name}`)) this.recall();
  }

  refuse() {
    byId('missing').textContent = 'This browser shows no WebGL 2, without which the motions cannot be judged: switch on ' +
      `hardware acceleration, or open the page in another browser. (${this.clip.missing})`;
    byId('missing').hidden = false;
    byId('start').disabled = true;
  }

  // Somebody has begun in this browser before.
  recall() {
    byId('resume').hidden = false;
    byId('start').textContent = 'Start as somebody else';
    byId('start').classList.remove('main');
  }

  // Somebody with a session: goes on at once after a reload in the middle.
  admit() {
    const scenes = parsed('scenes');
    this.keeper = this.isFile ? new FileKeeper(told, this.session, scenes) : new ServerKeeper(told, this.session);
    this.count();
    byId('so-far').hidden = !this.isFile;
    if (this.isFile && !storage.kept) {
      this.trouble('This browser does not keep what you answer here: download your answers before you close the page.');
    }
    if (!this.clip.missing && (!this.isFile || this.keeper.answered.size)) this.go();
  }

  async start() {
    if (this.session) {
      this.go();
      return;
    }
    byId('start').disabled = true;
    try {
      const answer = await insisted('raters', sent({}), () => this.trouble('The server does not answer. Trying again …'));
      location.assign(`?rater=${encodeURIComponent((await answer.json()).rater)}`);
    } catch (error) {
      this.trouble(error.message);
    }
  }

  resume() {
    location.assign(`?rater=${encodeURIComponent(storage.of.getItem(`sag-study-${told.name}`))}`);
  }

  trouble(text) {
    byId('trouble').textContent = text;
    byId('trouble').hidden = !text;
  }

  show(part) {
    for (const name of ['welcome', 'rating', 'done']) byId(name).hidden = name !== part;
    document.body.classList.toggle('reading', part !== 'rating');
  }

  async go() {
    if (this.next < 0) {
      this.finish();
      return;
    }
    this.show('rating');
    const pending = this.keeper.pending();
    await this.open(this.next);
    if (pending && pending.turn === this.turn) {
      this.scales.show(pending.answer.scores);
      await this.save(pending.answer);
    }
  }

  async open(turn) {
    this.turn = turn;
    const [, scene, motion] = this.turns[turn];
    byId('loading').hidden = Boolean(content.windows[scene]);
    byId('loading').textContent = 'Loading the scene …';
    await this.keeper.scene(scene, () => { byId('loading').textContent = 'The server does not answer. Trying again …'; });
    byId('loading').hidden = true;
    this.scales.lock(false);
    this.clip.open(scene, motion);
    this.scales.show();
    this.count();
    const after = this.turns[turn + 1];
    if (after) this.keeper.scene(after[1], () => {});
  }

  count() {
    const done = this.keeper.answered.size;
    byId('count').textContent = `${done} of ${this.turns.length}`;
    byId('progress').setAttribute('aria-valuemax', this.turns.length);
    byId('progress').setAttribute('aria-valuenow', done);
    byId('progress').firstElementChild.style.width = `${(100 * done) / this.turns.length}%`;
  }

  get ready() { return Boolean(this.clip.seen && this.scales.whole && !this.saving); }

  update() {
    if (!this.scales || this.saving) return;
    byId('next').disabled = !this.ready;
    byId('said').textContent = this.scales.whole && !this.clip.seen ? 'Watch the motion to its end once.' : '';
  }

  async answer() {
    if (!this.ready) return;
    const [token] = this.turns[this.turn];
    await this.save({ turn: token, scores: this.scales.scores, seconds: this.clip.seconds, plays: this.clip.plays });
  }

  async save(answer) {
    this.saving = true;
    byId('next').disabled = true;
    this.scales.lock(true);
    try {
      await this.keeper.save(this.turn, answer, () => {
        byId('said').textContent = 'Not saved yet, since the server does not answer. Trying again …';
      });
    } catch (error) {
      byId('said').textContent = `This was not taken: ${error.message}.`;
      return;
    }
    this.saving = false;
    byId('said').textContent = '';
    if (this.next < 0) this.finish();
    else await this.open(this.next);
  }

  finish() {
    this.count();
    this.clip.state.playing = false;
    this.show('done');
    byId('download').hidden = !this.isFile;
    byId('farewell').textContent = this.isFile
      ? 'All motions are answered. Please download your answers and send the file back to whoever gave you this page.'
      : 'All motions are answered and saved. You can close this page.';
    byId('done-title').focus();
  }

  press(event) {
    if (byId('rating').hidden || event.ctrlKey || event.metaKey || event.altKey) return;
    const field = event.target.closest('button, input');
    const turns = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    const acts = {
      ' ': () => this.clip.play(!this.clip.state.playing),
      Enter: () => this.answer(),
      ArrowLeft: () => this.clip.step(-1), ArrowRight: () => this.clip.step(1),
      Home: () => this.clip.seek(0), End: () => this.clip.seek(this.clip.frames - 1),
      0: () => this.clip.look('toTheCamera'), r: () => this.clip.look('reset'),
      '+': () => this.clip.orbit.zoom(0.88), '=': () => this.clip.orbit.zoom(0.88), '-': () => this.clip.orbit.zoom(1.14),
    };
    let act = event.shiftKey && turns[event.key] ? () => this.clip.orbit.turn(...turns[event.key]) : acts[event.key];
    if (told.scale.includes(Number(event.key))) act = () => this.scales.press(Number(event.key));
    if (field && field.type === 'radio' && (event.key.startsWith('Arrow') || (event.key === ' ' && !field.checked))) return;
    if (field && field.localName === 'button' && (event.key === ' ' || event.key === 'Enter')) return;
    if (!act || !this.clip.motion) return;
    event.preventDefault();
    act();
  }
}

window.sagStudy = new Study();
