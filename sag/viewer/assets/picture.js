// The given picture with the motions projected into it, far bodies first.

const OUTLINE = 0.9;

class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext('2d');
  }

  show(view, ready) {
    this.view = view;
    const image = new Image();
    image.onload = () => {
      if (this.view !== view) return;
      this.image = image;
      ready();
    };
    image.src = `data:image/jpeg;base64,${view.picture}`;
    this.canvas.style.aspectRatio = `${view.size[0]} / ${view.size[1]}`;
  }

  draw(bodies) {
    const { canvas, pen, view } = this;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round((width * view.size[1]) / view.size[0]));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    if (this.image) pen.drawImage(this.image, 0, 0, width, height);
    const scale = width / view.size[0];
    pen.lineCap = 'round';
    const depthOf = ({ joints }) => joints[3 * content.root + 2];
    for (const { motion, joints } of [...bodies].sort((one, other) => depthOf(other) - depthOf(one))) {
      const strokes = this.strokes(joints, scale).sort((one, other) => other.depth - one.depth);
      for (const [colour, wider] of [['rgba(10, 12, 16, .8)', 2 * OUTLINE * ratio], [motion.colour, 0]]) {
        for (const stroke of strokes) this.stroke(stroke, colour, wider);
      }
    }
  }

  stroke({ from, to, thick }, colour, wider) {
    const { pen } = this;
    pen.strokeStyle = colour;
    pen.lineWidth = thick + Math.min(wider, 0.3 * thick);
    pen.beginPath();
    pen.moveTo(...from);
    pen.lineTo(...to);
    pen.stroke();
  }

  // Bones before the camera as lines in pixels of the canvas.
  strokes(joints, scale) {
    const [across, down, left, top] = this.view.camera;
    const seen = ([x, y, z]) => [((x / z) * across + left) * scale, ((y / z) * down + top) * scale];
    return content.links.map(([start, end, thick, thin]) => {
      const ends = [jointOf(joints, start), jointOf(joints, end)];
      const depth = (ends[0][2] + ends[1][2]) / 2;
      if (Math.min(ends[0][2], ends[1][2]) < 0.1) return null;
      const [from, to] = ends.map(seen);
      return { from, to, depth, thick: Math.max(1.6, (0.85 * (thick + thin) * across * scale) / depth) };
    }).filter(Boolean);
  }
}
