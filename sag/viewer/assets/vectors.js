// Vectors as arrays of three numbers; matrices of 4 x 4 by columns, as WebGL wants them.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const lengthOf = (a) => Math.hypot(a[0], a[1], a[2]);
const unit = (a) => scaled(a, 1 / (lengthOf(a) || 1));
const mixed = (a, b, share) => add(scaled(a, 1 - share), scaled(b, share));

function product(a, b) {
  const made = new Float32Array(16);
  for (let column = 0; column < 4; column++) {
    for (let row = 0; row < 4; row++) {
      for (let inner = 0; inner < 4; inner++) made[4 * column + row] += a[4 * inner + row] * b[4 * column + inner];
    }
  }
  return made;
}

function perspective(angle, aspect, near, far) {
  const tall = 1 / Math.tan(angle / 2);
  const depth = 1 / (near - far);
  return new Float32Array([tall / aspect, 0, 0, 0, 0, tall, 0, 0, 0, 0, (near + far) * depth, -1,
    0, 0, 2 * near * far * depth, 0]);
}

function parallel(half, near, far) {
  const depth = 1 / (near - far);
  return new Float32Array([1 / half, 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, 2 * depth, 0, 0, 0, (near + far) * depth, 1]);
}

function looking(eye, target, up) {
  const back = unit(sub(eye, target));
  const right = unit(cross(up, back));
  const above = cross(back, right);
  return new Float32Array([right[0], above[0], back[0], 0, right[1], above[1], back[1], 0,
    right[2], above[2], back[2], 0, -dot(right, eye), -dot(above, eye), -dot(back, eye), 1]);
}

// Where a matrix puts a point: x, y, z divided by w, and w.
function transformed(matrix, point) {
  const [x, y, z, w] = [0, 1, 2, 3].map((row) =>
    matrix[row] * point[0] + matrix[4 + row] * point[1] + matrix[8 + row] * point[2] + matrix[12 + row]);
  return [x / w, y / w, z / w, w];
}
