// The eye: it turns about a target, by mouse, fingers and keys.

const FIELD_OF_VIEW = 0.75;
const STEEPEST = 1.45;
const NEAREST = 0.6;
const FARTHEST_EYE = 14;
const FARTHEST_FROM_START = 2.2;

// A ball around most of what moves, half a second apart.
function extentOf(motions) {
  const step = Math.max(1, Math.round(content.fps / 2));
  const places = [];
  for (const motion of motions) {
    for (let frame = 0; frame < motion.frames; frame += step) {
      const joints = jointsAt(motion, frame);
      for (let joint = 0; joint < content.joints; joint += 2) places.push(jointOf(joints, joint));
    }
  }
  const start = jointOf(jointsAt(motions[0], 0), content.root);
  const near = places.filter((place) => lengthOf(sub(place, start)) < FARTHEST_FROM_START);
  const [low, high] = [Math.min, Math.max].map((end) => [0, 1, 2].map((axis) => end(...near.map((place) => place[axis]))));
  const centre = mixed(low, high, 0.5);
  return { centre, reach: Math.max(...near.map((place) => lengthOf(sub(place, centre)))) };
}

class Orbit {
  constructor(canvas, changed) {
    Object.assign(this, { canvas, changed, azimuth: 0, elevation: 0.3, distance: 4, field: FIELD_OF_VIEW, target: [0, 0, 3] });
    this.fingers = new Map();
    canvas.addEventListener('pointerdown', (event) => this.press(event));
    canvas.addEventListener('pointermove', (event) => this.drag(event));
    for (const kind of ['pointerup', 'pointercancel']) {
      canvas.addEventListener(kind, (event) => this.fingers.delete(event.pointerId));
    }
    canvas.addEventListener('wheel', (event) => this.wheel(event), { passive: false });
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  // Takes another window: which way is up, and the ball that is looked at.
  place(view, { centre, reach }) {
    this.view = view;
    [this.ahead, this.right] = floorAxes(view);
    Object.assign(this, { home: centre, reach });
  }

  // From beside the camera, a little above it: what it saw has few holes from there.
  reset() {
    const { away } = this.toCamera(this.home);
    const narrow = Math.max(1, this.canvas.clientHeight / Math.max(1, this.canvas.clientWidth));
    const distance = (1.25 * narrow * this.reach) / Math.sin(FIELD_OF_VIEW / 2);
    Object.assign(this, { target: this.home, azimuth: away + 0.45, elevation: 0.3, distance, field: FIELD_OF_VIEW });
    this.changed();
  }

  // Where the picture was taken, with all of the picture in view.
  toTheCamera() {
    const [left, , right] = pictureCorners(this.view, 1);
    const middle = mixed(left, right, 0.5);
    const [wide, tall] = [(right[0] - left[0]) / 2, (right[1] - left[1]) / 2].map((half) => half / lengthOf(middle));
    const target = scaled(unit(middle), lengthOf(this.home));
    const { away, rise, distance } = this.toCamera(target);
    const field = 2 * Math.atan(Math.max(tall, (wide * this.canvas.clientHeight) / this.canvas.clientWidth));
    Object.assign(this, { target, azimuth: away, elevation: rise, distance, field });
    this.changed();
  }

  toCamera(point) {
    const back = scaled(point, -1);
    return {
      away: Math.atan2(-dot(back, this.right), -dot(back, this.ahead)),
      rise: Math.asin(dot(unit(back), this.view.up)),
      distance: lengthOf(point),
    };
  }

  get eye() {
    const flat = add(scaled(this.ahead, -Math.cos(this.azimuth)), scaled(this.right, -Math.sin(this.azimuth)));
    const way = add(scaled(flat, Math.cos(this.elevation)), scaled(this.view.up, Math.sin(this.elevation)));
    return add(this.target, scaled(way, this.distance));
  }

  turn(across, down) {
    this.azimuth += across;
    this.elevation = Math.min(STEEPEST, Math.max(-0.3, this.elevation + down));
    this.changed();
  }

  zoom(factor) {
    this.distance = Math.min(FARTHEST_EYE, Math.max(NEAREST, this.distance * factor));
    this.changed();
  }

  pan(across, down) {
    const look = unit(sub(this.target, this.eye));
    const right = unit(cross(look, this.view.up));
    const step = this.distance / this.canvas.clientHeight;
    this.target = add(this.target, add(scaled(right, -across * step), scaled(cross(right, look), down * step)));
    this.changed();
  }

  press(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
  }

  drag(event) {
    const before = this.fingers.get(event.pointerId);
    if (!before) return;
    const [across, down] = [event.clientX - before[0], event.clientY - before[1]];
    const others = [...this.fingers].filter(([finger]) => finger !== event.pointerId);
    this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
    if (others.length) {
      const [, other] = others[0];
      const spread = (place) => Math.hypot(place[0] - other[0], place[1] - other[1]) || 1;
      this.pan(across / 2, down / 2);
      this.zoom(spread(before) / spread([event.clientX, event.clientY]));
    } else if (event.buttons & 2 || event.shiftKey) this.pan(across, down);
    else this.turn(across * 0.007, down * 0.006);
  }

  wheel(event) {
    event.preventDefault();
    this.zoom(Math.exp(Math.max(-80, Math.min(80, event.deltaY)) * 0.0018));
  }
}
