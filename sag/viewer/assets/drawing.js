// Thin wrappers of WebGL: programs with their uniforms, and buffers with how they are read.

class Program {
  constructor(gl, vertex, fragment) {
    this.gl = gl;
    this.made = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(this.made, shader);
    }
    ['place', 'corner'].forEach((name) => gl.bindAttribLocation(this.made, 0, name));
    ['tint', 'start', 'end'].forEach((name, place) => gl.bindAttribLocation(this.made, 1 + place, name));
    gl.linkProgram(this.made);
    if (!gl.getProgramParameter(this.made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(this.made));
    this.places = new Map();
  }

  // Sets uniforms by name: a number, an array of 2 to 4 numbers, or a matrix of 16.
  use(values) {
    const { gl } = this;
    gl.useProgram(this.made);
    for (const [name, value] of Object.entries(values)) {
      if (!this.places.has(name)) this.places.set(name, gl.getUniformLocation(this.made, name));
      const place = this.places.get(name);
      if (Number.isInteger(value) && name.match(/_map$|^colours$/)) gl.uniform1i(place, value);
      else if (typeof value === 'number') gl.uniform1f(place, value);
      else if (value.length === 16) gl.uniformMatrix4fv(place, false, value);
      else gl[`uniform${value.length}fv`](place, value);
    }
  }
}

// Buffers of one kind of drawing. Each attribute: [place, numbers, floats from one to the next, first float, per instance].
class Geometry {
  constructor(gl, attributes) {
    this.gl = gl;
    this.array = gl.createVertexArray();
    this.buffers = attributes.map(() => gl.createBuffer());
    this.indices = gl.createBuffer();
    gl.bindVertexArray(this.array);
    attributes.forEach((layouts, which) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[which]);
      for (const [place, numbers, stride, first, instanced] of layouts) {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, numbers, gl.FLOAT, false, 4 * stride, 4 * first);
        gl.vertexAttribDivisor(place, instanced ? 1 : 0);
      }
    });
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
    gl.bindVertexArray(null);
  }

  fill(which, values, usage) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffers[which]);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, values, usage || this.gl.DYNAMIC_DRAW);
  }

  fillIndices(faces) {
    this.gl.bindVertexArray(this.array);
    this.gl.bufferData(this.gl.ELEMENT_ARRAY_BUFFER, faces, this.gl.STATIC_DRAW);
    this.gl.bindVertexArray(null);
    this.count = faces.length;
    this.kind = faces instanceof Uint32Array ? this.gl.UNSIGNED_INT : this.gl.UNSIGNED_SHORT;
  }

  // Draws corners in their order.
  drawCorners(mode, count) {
    this.gl.bindVertexArray(this.array);
    this.gl.drawArrays(mode, 0, count);
    this.gl.bindVertexArray(null);
  }

  // Draws triangles, the first few of them or all, once or for each instance.
  drawFaces(count = this.count, instances = 1) {
    const { gl } = this;
    gl.bindVertexArray(this.array);
    gl.drawElementsInstanced(gl.TRIANGLES, count, this.kind, 0, instances);
    gl.bindVertexArray(null);
  }
}

function colourTexture(gl) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 1, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array([128, 130, 134, 255]));
  gl.generateMipmap(gl.TEXTURE_2D);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR_MIPMAP_LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  return texture;
}

// A map of depths that a shader compares with, and what draws into it.
function shadowTarget(gl, size) {
  const texture = gl.createTexture();
  gl.bindTexture(gl.TEXTURE_2D, texture);
  gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, size, size);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
  const frame = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, texture, 0);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return { texture, frame, size };
}
