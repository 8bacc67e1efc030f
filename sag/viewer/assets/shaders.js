// Programs of the graphics card.

// Places around a point at which its shadow is looked up, in the order of a sunflower's seeds.
const TAPS = Array.from({ length: 12 }, (_, tap) => {
  const [angle, reach] = [tap * 2.39996, Math.sqrt((tap + 0.5) / 12) * 0.0075];
  return `vec2(${(Math.cos(angle) * reach).toFixed(6)}, ${(Math.sin(angle) * reach).toFixed(6)})`;
});

const SHADOW = `
uniform highp sampler2DShadow shadow_map;
uniform mat4 shadow_matrix;
const vec2 taps[${TAPS.length}] = vec2[](${TAPS.join(', ')});
float lit(vec3 place) {
  vec3 at = (shadow_matrix * vec4(place, 1.0)).xyz * 0.5 + 0.5;
  if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
  float sum = 0.0;
  for (int tap = 0; tap < ${TAPS.length}; tap++) sum += texture(shadow_map, vec3(at.xy + taps[tap], at.z - 0.004));
  return sum / ${TAPS.length}.0;
}`;

const SURFACE_VERTEX = `#version 300 es
in vec4 place;
uniform mat4 view_matrix;
uniform vec4 camera;
uniform vec2 size;
uniform float dot_size;
out vec3 at;
out vec2 across;
out float seen;
void main() {
  at = place.xyz;
  seen = place.w;
  across = (camera.xy * place.xy / max(place.z, 1e-3) + camera.zw) / size;
  gl_Position = view_matrix * vec4(at, 1.0);
  gl_PointSize = clamp(dot_size * place.z / gl_Position.w, 1.0, 14.0);
  if (place.z == 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`;

const SURFACE_FRAGMENT = `#version 300 es
precision highp float;
in vec3 at;
in vec2 across;
in float seen;
uniform sampler2D colours;
uniform float shaded;
out vec4 colour;
${SHADOW}
void main() {
  vec3 grey = vec3(0.52, 0.54, 0.57);
  bool inside = all(greaterThan(across, vec2(0.0))) && all(lessThan(across, vec2(1.0)));
  vec3 base = inside ? texture(colours, across).rgb : grey;
  base = mix(vec3(dot(base, vec3(0.3, 0.59, 0.11))), base, 0.92);
  if (seen < 0.999) {
    float stripe = smoothstep(0.35, 0.65, abs(fract((gl_FragCoord.x + gl_FragCoord.y) / 9.0) - 0.5) * 2.0);
    base = mix(base, grey, (1.0 - seen) * mix(0.12, 0.34, stripe));
  }
  float light = mix(1.0, mix(0.42, 1.0, lit(at)), shaded);
  colour = vec4(base * light, 1.0);
}`;

const LINK_VERTEX = `#version 300 es
in vec3 corner;
in vec4 start, end, tint;
uniform mat4 view_matrix;
out vec3 at, normal;
out vec4 shade;
void main() {
  vec3 along = end.xyz - start.xyz;
  float span = length(along);
  vec3 axis = span > 1e-5 ? along / span : vec3(0.0, -1.0, 0.0);
  vec3 first = normalize(abs(axis.x) < 0.8 ? cross(axis, vec3(1, 0, 0)) : cross(axis, vec3(0, 1, 0)));
  vec3 second = cross(axis, first);
  float waist = asin(clamp((start.w - end.w) / max(span, 1e-5), -1.0, 1.0));
  float tilt = corner.x < 0.5 ? mix(-1.5707963, waist, corner.y) : mix(waist, 1.5707963, corner.y);
  normal = cos(tilt) * (cos(corner.z) * first + sin(corner.z) * second) + sin(tilt) * axis;
  at = corner.x < 0.5 ? start.xyz + start.w * normal : end.xyz + end.w * normal;
  shade = tint;
  gl_Position = view_matrix * vec4(at, 1.0);
}`;

const LINK_FRAGMENT = `#version 300 es
precision highp float;
in vec3 at, normal;
in vec4 shade;
uniform vec3 eye, up, sun, hot;
out vec4 colour;
${SHADOW}
void main() {
  vec3 n = normalize(normal), look = normalize(eye - at);
  vec3 albedo = pow(mix(shade.rgb, hot, 0.85 * shade.a), vec3(2.2));
  float sky = 0.5 + 0.5 * dot(n, up);
  vec3 light = mix(vec3(0.20, 0.19, 0.18), vec3(0.62, 0.64, 0.68), sky);
  float key = max(0.0, dot(n, sun) * 0.85 + 0.15) * mix(0.25, 1.0, lit(at + 0.05 * n));
  float facing = max(dot(n, look), 0.0);
  vec3 made = albedo * (light + 0.62 * key + 0.18 * facing);
  made += 0.16 * pow(max(dot(n, normalize(sun + look)), 0.0), 36.0) + 0.10 * sky * pow(1.0 - facing, 3.0);
  made *= mix(0.55, 1.0, smoothstep(0.0, 0.32, facing));
  colour = vec4(pow(made, vec3(1.0 / 2.2)), 1.0);
}`;

const DEPTH_FRAGMENT = `#version 300 es
precision highp float;
void main() {}`;

const FLAT_VERTEX = `#version 300 es
in vec3 place;
in vec4 tint;
uniform mat4 view_matrix;
uniform float dot_size;
out vec4 shade;
void main() {
  shade = tint;
  gl_Position = view_matrix * vec4(place, 1.0);
  gl_PointSize = dot_size;
}`;

const FLAT_FRAGMENT = `#version 300 es
precision highp float;
in vec4 shade;
uniform float round_dots;
out vec4 colour;
void main() {
  vec4 made = shade;
  if (round_dots > 0.5) {
    float reach = length(gl_PointCoord - 0.5) * 2.0;
    made.a *= 1.0 - smoothstep(0.85, 1.0, reach);
    made.rgb = mix(made.rgb, vec3(1.0, 0.93, 0.75), 1.0 - smoothstep(0.25, 0.5, reach));
  }
  colour = vec4(made.rgb * made.a, made.a);
}`;
