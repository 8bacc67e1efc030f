// What the page carries: 16-bit steps in base64, made into metres when a window is first shown.

const content = JSON.parse(document.getElementById('data').textContent);

// Okabe and Ito's colours, which hold for the colour-blind, then three of Tol's; vermilion is kept for collisions.
const COLOURS = ['#56b4e9', '#e69f00', '#009e73', '#cc79a7', '#f0e442', '#0072b2', '#999933', '#aa4499', '#88ccee'];
const TRUTH_COLOUR = '#d9d9d6';
const TOUCH_COLOUR = '#e8380d';

function bytesOf(text) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let place = 0; place < raw.length; place++) bytes[place] = raw.charCodeAt(place);
  return bytes;
}

function placesOf(packed) {
  const steps = new Int16Array(bytesOf(packed.places).buffer);
  return Float32Array.from(steps, (value) => value * packed.step);
}

function motionOf(packed, label, mark, colour) {
  return {
    label, mark, colour,
    places: placesOf(packed.joints),
    frames: packed.joints.shape[0],
    figures: packed.figures,
    touched: packed.touched && new Uint16Array(bytesOf(packed.touched).buffer),
  };
}

function sceneOf(packed) {
  return packed && {
    colours: packed.colours,
    depth: new Int16Array(bytesOf(packed.depth).buffer),
    rows: packed.shape[0],
    columns: packed.shape[1],
    // The camera in cells of the grid, whose first cell lies half a stride in.
    camera: [
      packed.camera[0] / packed.stride,
      packed.camera[1] / packed.stride,
      (packed.camera[2] - Math.floor(packed.stride / 2) - 0.5) / packed.stride,
      (packed.camera[3] - Math.floor(packed.stride / 2) - 0.5) / packed.stride,
    ],
  };
}

const unpacked = new Map();

// A window with everything in metres.
function windowOf(place) {
  if (!unpacked.has(place)) {
    const packed = content.windows[place];
    const rows = packed.rows.map((row) => ({
      name: row.name,
      motions: row.motions.map((motion, number) =>
        motionOf(motion, `sample ${number + 1}`, `${number + 1}`, COLOURS[number])),
    }));
    const truth = packed.truth && motionOf(packed.truth, 'recorded', 'R', TRUTH_COLOUR);
    unpacked.set(place, { ...packed, rows, truth, scene: sceneOf(packed.scene) });
  }
  return unpacked.get(place);
}

// Joints of a motion between two frames, metres.
function jointsAt(motion, time) {
  const size = content.joints * 3;
  const first = Math.min(Math.floor(time), motion.frames - 1);
  const next = Math.min(first + 1, motion.frames - 1);
  const share = time - first;
  const joints = new Float32Array(size);
  for (let place = 0; place < size; place++) {
    const from = motion.places[first * size + place];
    joints[place] = from + share * (motion.places[next * size + place] - from);
  }
  return joints;
}

function jointOf(joints, place) {
  return [joints[3 * place], joints[3 * place + 1], joints[3 * place + 2]];
}

// Red, green and blue in 0 .. 1 of a colour as #rrggbb.
function channelsOf(colour) {
  return [1, 3, 5].map((place) => parseInt(colour.slice(place, place + 2), 16) / 255);
}
