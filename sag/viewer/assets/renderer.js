// Draws the scene: surfaces, bodies with their shadow, the ways over the floor, collision points, the camera.

const SHADOW_SIZE = 1024;
const AT_CAMERA = 0.1;
const BEFORE_CAMERA = 1;

class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext('webgl2', { antialias: true, alpha: true });
    if (!gl) throw new Error('no WebGL 2');
    Object.assign(this, { canvas, gl, fineness: 1 });
    this.surfaces = new Program(gl, SURFACE_VERTEX, SURFACE_FRAGMENT);
    this.bodies = new Program(gl, LINK_VERTEX, LINK_FRAGMENT);
    this.casters = new Program(gl, LINK_VERTEX, DEPTH_FRAGMENT);
    this.flat = new Program(gl, FLAT_VERTEX, FLAT_FRAGMENT);
    this.surface = new Geometry(gl, [[[0, 4, 4, 0, false]]]);
    this.screen = new Geometry(gl, [[[0, 4, 4, 0, false]]]);
    this.links = new Geometry(gl, [[[0, 3, 3, 0, false]], [[2, 4, 12, 0, true], [3, 4, 12, 4, true], [1, 4, 12, 8, true]]]);
    this.colour = new Geometry(gl, [[[0, 3, 7, 0, false], [1, 4, 7, 3, false]]]);
    const capsule = capsuleShape(6, 16);
    this.links.fill(0, capsule.corners, gl.STATIC_DRAW);
    this.links.fillIndices(capsule.faces);
    this.texture = colourTexture(gl);
    this.given = colourTexture(gl);
    this.shadow = shadowTarget(gl, SHADOW_SIZE);
  }

  // Takes the surfaces and colours of another window.
  show(view, ready) {
    const { gl } = this;
    this.view = view;
    if (view.scene) {
      const { places, faces, firm } = surfaceOf(view);
      this.firm = firm;
      this.surface.fill(0, places, gl.STATIC_DRAW);
      this.surface.fillIndices(faces);
    }
    this.screen.fill(0, new Float32Array(pictureCorners(view, CAMERA_DEPTH).flatMap((corner) => [...corner, 1])));
    this.load(view, this.given, view.picture, ready);
    if (view.scene) this.load(view, this.texture, view.scene.colours, ready);
  }

  load(view, texture, picture, ready) {
    const { gl } = this;
    const image = new Image();
    image.onload = () => {
      if (this.view !== view) return;
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, gl.RGBA, gl.UNSIGNED_BYTE, image);
      gl.generateMipmap(gl.TEXTURE_2D);
      ready();
    };
    image.src = `data:image/jpeg;base64,${picture}`;
  }

  // Fits the drawing to the size of the canvas on the screen.
  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2) * this.fineness;
    const [width, height] = [this.canvas.clientWidth, this.canvas.clientHeight].map((side) => Math.max(1, Math.round(side * ratio)));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, { width, height });
    this.ratio = ratio;
  }

  matrix(orbit) {
    const aspect = this.canvas.width / this.canvas.height;
    return product(perspective(orbit.field, aspect, 0.05, 80), looking(orbit.eye, orbit.target, this.view.up));
  }

  // Draws a frame of these bodies: { motion, joints, counts, points } each.
  draw(bodies, orbit, look) {
    const { gl, view } = this;
    this.resize();
    const matrix = this.matrix(orbit);
    const instances = this.fillLinks(bodies, look.touches);
    const shadow = this.castShadow(bodies, instances);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.shadow.texture);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    const shared = { view_matrix: matrix, shadow_matrix: shadow, shadow_map: 1 };
    this.drawLines(floorLines(view, orbit.home, 6), [...look.line, 0.22], matrix);
    this.drawSurfaces(orbit, look, shared);
    this.drawRibbons(bodies, look.time, matrix);
    this.bodies.use({ ...shared, eye: orbit.eye, up: view.up, sun: this.sun(), hot: channelsOf(TOUCH_COLOUR) });
    this.links.drawFaces(undefined, instances);
    if (look.touches) this.drawTouches(bodies, matrix);
  }

  // The direction that light comes from: above, and a little from the camera's left.
  sun() {
    const [ahead, right] = floorAxes(this.view);
    return unit(add(this.view.up, add(scaled(ahead, -0.16), scaled(right, -0.22))));
  }

  fillLinks(bodies, touches) {
    const values = [];
    for (const { motion, joints, counts } of bodies) {
      const colour = channelsOf(motion.colour);
      for (const [start, end, thick, thin, bone] of content.links) {
        const heat = touches && counts && bone >= 0 ? Math.min(1, counts[bone] / 12) : 0;
        values.push(...jointOf(joints, start), thick, ...jointOf(joints, end), thin, ...colour, heat);
      }
    }
    this.links.fill(1, new Float32Array(values));
    return values.length / 12;
  }

  castShadow(bodies, instances) {
    const { gl } = this;
    const places = bodies.map(({ joints }) => jointOf(joints, content.root));
    const centre = places.length ? scaled(places.reduce(add), 1 / places.length) : [0, 0, 3];
    const half = 1.4 + Math.max(0, ...places.map((place) => lengthOf(sub(place, centre))));
    const eye = add(centre, scaled(this.sun(), 6));
    const [ahead] = floorAxes(this.view);
    const matrix = product(parallel(half, 0.5, 12), looking(eye, centre, ahead));
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadow.frame);
    gl.viewport(0, 0, this.shadow.size, this.shadow.size);
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    this.casters.use({ view_matrix: matrix });
    this.links.drawFaces(undefined, instances);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return matrix;
  }

  drawSurfaces(orbit, look, shared) {
    const { gl, view } = this;
    const lens = { camera: view.camera, size: view.size, colours: 0 };
    const dots = view.scene ? (1.25 * this.canvas.height) / (2 * Math.tan(orbit.field / 2) * view.scene.camera[1]) : 1;
    this.surfaces.use({ ...shared, ...lens, shaded: 1, dot_size: dots });
    if (view.scene && look.points) this.surface.drawCorners(gl.POINTS, view.scene.depth.length);
    else if (view.scene) {
      gl.enable(gl.CULL_FACE);  // a wall is not seen from behind, so that one looks into the room from outside
      this.surface.drawFaces(lengthOf(orbit.eye) < AT_CAMERA ? undefined : this.firm);
      gl.disable(gl.CULL_FACE);
    }
    if (lengthOf(orbit.eye) < BEFORE_CAMERA) return;  // who looks through the camera does not see it
    gl.bindTexture(gl.TEXTURE_2D, this.given);
    this.surfaces.use({ shaded: 0 });
    this.screen.drawCorners(gl.TRIANGLE_FAN, 4);
    this.drawLines(cameraLines(view), [...look.line, 0.9], shared.view_matrix);
  }

  drawLines(lines, tint, matrix) {
    this.drawFlat(this.gl.LINES, lines.flatMap((ends) => ends.flatMap((end) => [...end, ...tint])), { view_matrix: matrix });
  }

  drawRibbons(bodies, time, matrix) {
    const values = [];
    for (const { motion } of bodies) ribbon(this.view, motion, time, values);
    this.drawFlat(this.gl.TRIANGLES, values, { view_matrix: matrix });
  }

  drawTouches(bodies, matrix) {
    const tint = [...channelsOf(TOUCH_COLOUR), 0.95];
    const values = bodies.flatMap(({ points }) => (points || []).flatMap((point) => [...point, ...tint]));
    this.gl.disable(this.gl.DEPTH_TEST);  // they lie inside the bodies
    this.drawFlat(this.gl.POINTS, values, { view_matrix: matrix, round_dots: 1, dot_size: 5.5 * this.ratio });
    this.gl.enable(this.gl.DEPTH_TEST);
  }

  drawFlat(mode, values, uniforms) {
    if (!values.length) return;
    this.flat.use({ round_dots: 0, dot_size: 1, ...uniforms });
    this.colour.fill(0, new Float32Array(values));
    this.colour.drawCorners(mode, values.length / 7);
  }
}
