// The player: rows of motions with their figures, which of them are shown, and their collisions.

class Player extends Stage {
  constructor() {
    super({ window: 0, row: 0, shown: [], touches: true });
  }

  get view() { return windowOf(this.state.window); }
  get motions() { return this.view.rows[this.state.row].motions; }
  get listed() { return this.view.truth ? [...this.motions, this.view.truth] : this.motions; }

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
    this.set({ playing: !this.still.matches });
    this.begin();
  }

  resized() {
    drawLanes(byId('lanes'), this.listed, this.state.shown);
    this.redraw();
  }

  shown() { showState(this); }

  quicken(steps) {
    const place = SPEEDS.indexOf(this.state.speed) + steps;
    this.set({ speed: SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, place))] });
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
    this.chooseRow(this.state.row);
    this.showWindow(this.view, this.listed);
    if (this.view.guessed) this.lookAsThePictureDoes();
    this.legend();
  }

  // What a network takes the place to be holds best where the picture was taken, and no figure rests on it.
  lookAsThePictureDoes() {
    this.state.touches = false;
    this.look('toTheCamera');
  }

  legend() {
    const guess = this.view.guessed ? 'All surfaces are a guess of the depth in this picture, made from it alone. '
      : 'Hatched surfaces were behind the person and are a guess. ';
    const scene = this.view.scene ? guess : '';
    byId('legend').textContent = `${scene}Bodies are as thick as people are; collisions are of bones of ` +
      `${Math.round(1000 * content.touch)} mm.`;
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

  frameShown(bodies) {
    if (this.renderer) placeLabels(this, bodies);
    updateTable(this.listed, this.state.shown, this.frame);
    this.touching = bodies.map(({ points }) => (points || []).length);
  }
}

const player = new Player();
player.start();
window.sagViewer = player;
