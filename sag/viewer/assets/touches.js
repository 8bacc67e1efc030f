// Collision points: what the camera saw of the scene that lies within a bone, as the non-collision ratio counts it.

function footprint(scene, starts, radius) {
  const bounds = [Infinity, -Infinity, Infinity, -Infinity];
  for (const [x, y, z] of starts) {
    for (const near of [Math.max(z - radius, 0.05), Math.max(z + radius, 0.05)]) {
      const [across, down, left, top] = scene.camera;
      bounds[0] = Math.min(bounds[0], ((x - radius) / near) * across + left);
      bounds[1] = Math.max(bounds[1], ((x + radius) / near) * across + left);
      bounds[2] = Math.min(bounds[2], ((y - radius) / near) * down + top);
      bounds[3] = Math.max(bounds[3], ((y + radius) / near) * down + top);
    }
  }
  return [
    Math.max(0, Math.floor(bounds[0])), Math.min(scene.columns - 1, Math.ceil(bounds[1])),
    Math.max(0, Math.floor(bounds[2])), Math.min(scene.rows - 1, Math.ceil(bounds[3])),
  ];
}

// Square of the distance of a cell's point to a bone; written out, since it is asked a hundred thousand times a frame.
function squareToBone(scene, row, column, depth, start, along, square) {
  const [across, down, left, top] = scene.camera;
  const x = ((column - left) / across) * depth - start[0];
  const y = ((row - top) / down) * depth - start[1];
  const z = depth - start[2];
  const foot = (x * along[0] + y * along[1] + z * along[2]) / square;
  const share = square > 0 ? Math.min(1, Math.max(0, foot)) : 0;
  const [dx, dy, dz] = [x - share * along[0], y - share * along[1], z - share * along[2]];
  return dx * dx + dy * dy + dz * dz;
}

// Points inside the bones of one body, each once, and how many lie inside each bone.
function touchesOf(scene, joints) {
  const radius = content.touch;
  const found = new Map();
  const counts = content.bones.map(([first, second], bone) => {
    const [start, end] = [jointOf(joints, first), jointOf(joints, second)];
    const along = sub(end, start);
    const square = dot(along, along);
    const [left, right, top, bottom] = footprint(scene, [start, end], radius);
    const [near, far] = [Math.min(start[2], end[2]) - radius, Math.max(start[2], end[2]) + radius];
    let count = 0;
    for (let row = top; row <= bottom; row++) {
      for (let column = left; column <= right; column++) {
        const cell = row * scene.columns + column;
        const depth = scene.depth[cell] / 1000;
        if (depth <= 0 || depth < near || depth > far) continue;
        if (squareToBone(scene, row, column, depth, start, along, square) > radius * radius) continue;
        found.set(cell, pointOf(scene, row, column, depth));
        count++;
      }
    }
    return count;
  });
  return { points: [...found.values()], counts };
}
