// The clip: one motion of one scene, seen from where all motions of that scene can be seen, and how often it ran.

const BODY_COLOUR = '#56b4e9';

class Clip extends Stage {
  constructor(changed) {
    super({});
    this.changed = changed;
  }

  get view() { return windowOf(this.scene); }
  get listed() { return this.motion ? [this.motion] : []; }
  get seen() { return this.plays > 0; }

  withoutScene(error) { this.missing = error.message; }

  // Shows a motion from its start; the eye stays where it is if the scene does.
  open(scene, motion) {
    const other = this.scene !== scene;
    this.scene = scene;
    const place = this.view.motions.indexOf(motion);
    this.motion = this.view.rows[0].motions[place];
    this.motion.colour = BODY_COLOUR;
    Object.assign(this, { plays: 0, atEnd: false, began: performance.now() });
    if (other) this.showWindow(this.view, this.view.rows[0].motions);
    this.set({ time: 0, playing: !this.still.matches });
    if (!this.running) this.begin();
    this.running = true;
  }

  get seconds() { return Math.round((performance.now() - this.began) / 100) / 10; }

  bodies() { return [{ motion: this.motion, joints: jointsAt(this.motion, this.state.time) }]; }

  // Whoever steps or scrubs to the end has seen it too.
  frameShown() {
    const atEnd = this.state.time >= this.frames - 1;
    if (atEnd && !this.atEnd) {
      this.plays++;
      this.changed();
    }
    this.atEnd = atEnd;
  }
}
