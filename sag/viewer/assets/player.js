// The player: what is shown and when, and the loop that draws it.

const PAUSE_AT_END = 0.6;
const LONGEST_STEP = 0.5;
const TOO_SLOW = 0.15;

class Player {
  constructor() {
    this.still = matchMedia('(prefers-reduced-motion: reduce)');
    this.state = {
      window: 0, row: 0, time: 0, playing: false, speed: 1, shown: [], touches: true, follow: false, points: false,
    };
    this.orbit = new Orbit(byId('scene'), () => this.redraw());
    this.picture = new Picture(byId('picture'));
    try {
      this.renderer = new Renderer(byId('scene'));
    } catch (error) {
      this.withoutScene(error);
    }
  }

  get view() { return windowOf(this.state.window); }
  get motions() { return this.view.rows[this.state.row].motions; }
  get listed() { return this.view.truth ? [...this.motions, this.view.truth] : this.motions; }
  get frames() { return this.listed[0].frames; }
  get frame() { return Math.min(this.frames - 1, Math.round(this.state.time)); }

  withoutScene(error) {
    const said = byId('missing');
    said.textContent = 'This browser shows no WebGL 2, which the scene needs: switch on hardware acceleration or take ' +
      `another browser. The picture and the figures work without it. (${error.message})`;
    said.hidden = false;
    byId('stage').classList.add('without');
  }

  start() {
    connect(this);
    this.chooseWindow(0);
    this.state.playing = !this.still.matches;
    showState(this);
    new ResizeObserver(() => this.resized()).observe(byId('stage'));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.redraw());
    requestAnimationFrame((now) => this.tick(now));
  }

  resized() {
    drawLanes(byId('lanes'), this.listed, this.state.shown);
    this.redraw();
  }

  redraw() { this.stale = true; }

  set(changes) {
    Object.assign(this.state, changes);
    showState(this);
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

  quicken(steps) {
    const place = SPEEDS.indexOf(this.state.speed) + steps;
    this.set({ speed: SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, place))] });
  }

  look(from) {
    this.set({ follow: false });
    this.orbit[from]();
  }

  // Shows or hides a motion: samples in order, then the recorded one.
  toggle(place, sample = false) {
    if (place >= (sample ? this.motions : this.listed).length) return;
    this.state.shown[place] = !this.state.shown[place];
    this.resized();
    showState(this);
  }

  chooseRow(row) {
    if (row < 0 || row >= this.view.rows.length) return;
    const truth = this.state.shown[this.motions.length];
    const hidden = this.motions.map((_, place) => this.state.shown[place] === false);
    this.state.row = row;
    this.state.shown = this.motions.map((_, place) => !hidden[place]);
    if (this.view.truth) this.state.shown.push(Boolean(truth));
    fillTable(this.view, this.motions, this.state.shown, (place) => this.toggle(place));
    fillLabels(this.listed);
    this.resized();
    showState(this);
  }

  chooseWindow(place) {
    if (place < 0 || place >= content.windows.length) return;
    const truth = this.state.shown[this.motions.length];
    Object.assign(this.state, { window: place, time: 0, follow: false });
    if (this.state.shown.length) this.state.shown[this.motions.length] = truth;
    const { view } = this;
    if (this.renderer) this.renderer.show(view, () => this.redraw());
    this.picture.show(view, () => this.redraw());
    this.chooseRow(this.state.row);
    this.orbit.place(view, extentOf(this.listed));
    this.orbit.reset();
    this.legend();
  }

  legend() {
    const scene = this.view.scene ? 'Hatched surfaces were behind the person and are a guess. ' : '';
    byId('legend').textContent = `${scene}Bodies are as thick as people are; collisions are of bones of ` +
      `${Math.round(1000 * content.touch)} mm.`;
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

  // The motions that are shown, in this moment.
  bodies() {
    const { view, state } = this;
    return this.listed.filter((_, place) => state.shown[place]).map((motion) => {
      const joints = jointsAt(motion, state.time);
      return { motion, joints, ...(state.touches && view.scene && this.renderer ? this.touches(motion) : {}) };
    });
  }

  // Worked out once for each frame, not again while only the eye moves.
  touches(motion) {
    if (!motion.met || motion.met.frame !== this.frame) {
      motion.met = { frame: this.frame, ...touchesOf(this.view.scene, jointsAt(motion, this.frame)) };
    }
    return { points: motion.met.points, counts: motion.met.counts };
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
      placeLabels(this, bodies);
    }
    this.picture.draw(bodies);
    updateTable(this.listed, this.state.shown, this.frame);
    showFrame(this);
    this.touching = bodies.map(({ points }) => (points || []).length);
    this.drawn = (this.drawn || 0) + 1;
  }
}

const player = new Player();
player.start();
window.sagViewer = player;
