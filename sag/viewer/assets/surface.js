// The scene's surfaces: the depth grid as triangles, cut where depth jumps.

const LEAST_JUMP = 0.025;
const GUESSED_JUMP = 0.2;

function pointOf(scene, row, column, depth) {
  const [across, down, x, y] = scene.camera;
  return [((column - x) / across) * depth, ((row - y) / down) * depth, depth];
}

function surfaceOf(view) {
  const { scene } = view;
  const places = new Float32Array(scene.depth.length * 4);
  for (let row = 0, cell = 0; row < scene.rows; row++) {
    for (let column = 0; column < scene.columns; column++, cell++) {
      const depth = scene.depth[cell] / 1000;
      places.set(pointOf(scene, row, column, Math.abs(depth)), 4 * cell);
      places[4 * cell + 3] = depth < 0 ? 0 : 1;
    }
  }
  return { places, ...facesOf(view) };
}

// Triangles of the grid: first those of surfaces, then those over jumps of depth, which only the camera cannot tell apart.
function facesOf(view) {
  const { scene } = view;
  // A floor seen from this height falls off by z / (f h) from one cell to the next; two and a half times that is a jump.
  const slope = 2.5 / (1000 * scene.camera[1] * Math.max(0.4, Math.abs(view.floor)));
  const size = 6 * (scene.rows - 1) * (scene.columns - 1);
  const [whole, jumping] = [new Uint32Array(size), new Uint32Array(size)];
  const counts = [0, 0];
  const face = (a, b, c) => {
    const [first, second, third] = [scene.depth[a], scene.depth[b], scene.depth[c]];
    const near = Math.min(Math.abs(first), Math.abs(second), Math.abs(third));
    const far = Math.max(Math.abs(first), Math.abs(second), Math.abs(third));
    if (near === 0) return;
    const guessed = Math.min(first, second, third) < 0;
    const jumps = far / near - 1 > slope * near + (guessed ? GUESSED_JUMP : LEAST_JUMP) ? 1 : 0;
    (jumps ? jumping : whole).set([a, b, c], counts[jumps]);
    counts[jumps] += 3;
  };
  for (let row = 0; row + 1 < scene.rows; row++) {
    for (let column = 0; column + 1 < scene.columns; column++) {
      const cell = row * scene.columns + column;
      face(cell, cell + scene.columns, cell + 1);
      face(cell + 1, cell + scene.columns, cell + scene.columns + 1);
    }
  }
  const faces = new Uint32Array(counts[0] + counts[1]);
  faces.set(whole.subarray(0, counts[0]));
  faces.set(jumping.subarray(0, counts[1]), counts[0]);
  return { faces, firm: counts[0] };
}
