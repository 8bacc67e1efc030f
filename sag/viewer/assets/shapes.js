// Shapes that are drawn again and again: a capsule, the camera, the floor, the ways over it.

const CAMERA_DEPTH = 0.3;
const RIBBON = 0.014;

// A capsule's skin: which end a corner is of, how far round that end, and the angle about the axis.
function capsuleShape(rings, sides) {
  const corners = [];
  for (let ring = 0; ring < 2 * rings; ring++) {
    const end = ring < rings ? 0 : 1;
    const share = end ? (ring - rings) / (rings - 1) : ring / (rings - 1);
    for (let side = 0; side <= sides; side++) corners.push(end, share, (2 * Math.PI * side) / sides);
  }
  const faces = [];
  for (let ring = 0; ring + 1 < 2 * rings; ring++) {
    for (let side = 0; side < sides; side++) {
      const low = ring * (sides + 1) + side;
      const high = low + sides + 1;
      faces.push(low, low + 1, high, high, low + 1, high + 1);
    }
  }
  return { corners: new Float32Array(corners), faces: new Uint16Array(faces) };
}

// Corners of the picture at some depth before the camera.
function pictureCorners(view, depth) {
  const [across, down, x, y] = view.camera;
  const [width, height] = view.size;
  return [[0, 0], [width, 0], [width, height], [0, height]]
    .map(([u, v]) => [((u - x) / across) * depth, ((v - y) / down) * depth, depth]);
}

function cameraLines(view) {
  const corners = pictureCorners(view, CAMERA_DEPTH);
  const middle = mixed(corners[0], corners[1], 0.5);
  const rise = scaled(unit(sub(corners[0], corners[3])), 0.08);
  const lines = [];
  corners.forEach((corner, place) => lines.push([[0, 0, 0], corner], [corner, corners[(place + 1) % 4]]));
  const tip = add(middle, rise);
  lines.push([mixed(middle, corners[0], 0.25), tip], [mixed(middle, corners[1], 0.25), tip]);
  return lines;
}

// Two directions along the floor, the first one away from the camera.
function floorAxes(view) {
  const ahead = unit(sub([0, 0, 1], scaled(view.up, view.up[2])));
  return [ahead, cross(ahead, view.up)];
}

function onFloor(view, point) {
  return add(point, scaled(view.up, view.floor - dot(point, view.up)));
}

// Lines of a square metre each around a place on the floor.
function floorLines(view, centre, half) {
  const [ahead, right] = floorAxes(view);
  const origin = add(onFloor(view, centre), scaled(view.up, -0.012));
  const lines = [];
  for (let step = -half; step <= half; step++) {
    for (const [along, beside] of [[ahead, right], [right, ahead]]) {
      const middle = add(origin, scaled(beside, step));
      const reach = Math.sqrt(Math.max(0, half * half - step * step));
      lines.push([add(middle, scaled(along, -reach)), add(middle, scaled(along, reach))]);
    }
  }
  return lines;
}

// The root's way over the floor as a band of triangles; what is still to come is faint.
function ribbon(view, motion, time, into) {
  const size = content.joints * 3;
  const colour = channelsOf(motion.colour);
  const lift = scaled(view.up, 0.02);
  const way = [];
  for (let frame = 0; frame < motion.frames; frame++) {
    const root = jointOf(motion.places.subarray(frame * size, (frame + 1) * size), content.root);
    way.push(add(onFloor(view, root), lift));
  }
  for (let frame = 0; frame + 1 < way.length; frame++) {
    const [from, to] = [way[frame], way[frame + 1]];
    if (lengthOf(sub(to, from)) < 1e-4) continue;
    const aside = scaled(unit(cross(sub(to, from), view.up)), RIBBON);
    const strength = frame < time ? 0.95 : 0.28;
    const corners = [sub(from, aside), add(from, aside), sub(to, aside), sub(to, aside), add(from, aside), add(to, aside)];
    for (const corner of corners) into.push(...corner, ...colour, strength);
  }
}
