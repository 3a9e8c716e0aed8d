// The picture of the bodies: serialized points go to the graphics card as they came.

import { IDENTITY, SPEED_RAMP, rgb, table } from './colours.js';

// Circles up to this radius are points with a round shader, many times faster than squares in software.
const LARGEST_POINT = 60; // device pixels
// A point vanishes when its centre leaves the picture; so what is drawn is larger than the picture by this.
const BORDER = 64; // device pixels
const MOST_TRAIL_LINES = 40000;
const MOST_PIECES = 600; // of one trail
const LEAST_PIECES = 10; // of one trail: with fewer, what turns at contacts would be cut short
export const MOST_TRAILS = MOST_TRAIL_LINES / LEAST_PIECES; // circles
const WALL_WIDTH = 2; // CSS pixels

const COMMON = `#version 300 es
precision highp float;
`;

const PLACE = `
uniform vec2 centre;   // m
uniform vec2 toClip;   // 1/m
vec2 place(vec2 p) { return (p - centre) * toClip; }
`;

const BODY_COLOUR = `
layout(location=0) in float x;
layout(location=1) in float y;
layout(location=2) in float vx;
layout(location=3) in float vy;
layout(location=4) in float radius;
layout(location=5) in uint id;
uniform int mode;      // 0 speed, 1 identity, 2 one colour
uniform float fastest; // m/s
uniform vec3 one;
uniform vec3 palette[${IDENTITY.length}];
uniform sampler2D ramp;
uniform float pixels;  // device pixels per m
uniform float least;   // device pixels
out vec3 colour;
out float reach;
vec3 colourOf() {
  if (mode == 1) return palette[int(id % ${IDENTITY.length}u)];
  if (mode == 2) return one;
  return texture(ramp, vec2(clamp(length(vec2(vx, vy)) / fastest, 0.0, 1.0), 0.5)).rgb;
}
`;

// The rim keeps circles of one colour that touch apart for the eye; the pin says: locked.
const BODY_FRAGMENT = (from) => `${COMMON}
in vec3 colour;
in float reach;
${from === 'point' ? '' : 'in vec2 local;'}
uniform bool pinned;
out vec4 result;
void main() {
  ${from === 'point' ? 'vec2 local = (gl_PointCoord - 0.5) * (2.0 * reach + 2.0);' : ''}
  float d = length(local);
  float alpha = clamp(reach + 0.5 - d, 0.0, 1.0);
  if (alpha <= 0.0) discard;
  float rim = clamp(0.14 * reach, 0.0, 2.5);
  float inside = rim > 0.0 ? clamp((reach - rim - d) / max(0.7, 0.4 * rim) + 0.5, 0.0, 1.0) : 1.0;
  vec3 shade = mix(colour * 0.55, colour, inside);
  if (pinned && reach > 5.0) {
    float pin = clamp(max(2.0, 0.09 * reach) + 0.5 - d, 0.0, 1.0);
    float ring = clamp(1.2 - abs(d - 0.72 * reach), 0.0, 1.0);
    shade = mix(shade, colour * 0.5, max(pin, 0.55 * ring));
  }
  result = vec4(shade * alpha, alpha);
}`;

const POINT_VERTEX = `${COMMON}${PLACE}${BODY_COLOUR}
void main() {
  colour = colourOf();
  reach = max(radius * pixels, least);
  gl_Position = vec4(place(vec2(x, y)), 0.0, 1.0);
  gl_PointSize = 2.0 * reach + 2.0;
}`;

const SQUARE_VERTEX = `${COMMON}${PLACE}${BODY_COLOUR}
out vec2 local;
void main() {
  colour = colourOf();
  reach = max(radius * pixels, least);
  vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
  local = corner * (reach + 1.0);
  gl_Position = vec4(place(vec2(x, y) + local / pixels), 0.0, 1.0);
}`;

const WALL_VERTEX = `${COMMON}${PLACE}
layout(location=0) in vec4 ends;
uniform float pixels;
uniform float width; // device pixels
out float aside;     // device pixels from the middle of the wall
void main() {
  vec2 along = normalize(ends.zw - ends.xy);
  vec2 side = vec2(-along.y, along.x);
  vec2 end = (gl_VertexID & 1) == 0 ? ends.xy - along * width / (2.0 * pixels) : ends.zw + along * width / (2.0 * pixels);
  aside = ((gl_VertexID >> 1) == 0 ? -1.0 : 1.0) * (0.5 * width + 1.0);
  gl_Position = vec4(place(end + side * aside / pixels), 0.0, 1.0);
}`;

// Smooth to both sides, so that a wall at a tilt has no steps.
const WALL_FRAGMENT = `${COMMON}
in float aside;
uniform float width;
uniform vec3 colour;
out vec4 result;
void main() {
  float alpha = clamp(0.5 * width + 0.5 - abs(aside), 0.0, 1.0);
  result = vec4(colour * alpha, alpha);
}`;

const TRAIL_FRAGMENT = `${COMMON}
uniform vec4 flatColour;
out vec4 result;
void main() { result = vec4(flatColour.rgb * flatColour.a, flatColour.a); }`;

const TRAIL_VERTEX = `${COMMON}${PLACE}
layout(location=0) in float x;
layout(location=1) in float y;
layout(location=2) in float nextX;
layout(location=3) in float nextY;
void main() {
  gl_Position = vec4(place(gl_VertexID == 0 ? vec2(x, y) : vec2(nextX, nextY)), 0.0, 1.0);
}`;

export class Picture {
  constructor(canvas) {
    this.canvas = canvas;
    this.gl = canvas.getContext('webgl2', { antialias: false, alpha: false, depth: false });
    if (!this.gl) throw new Error('this browser offers no WebGL2');
    this.start();
  }

  start() {
    const { gl } = this;
    this.points = this.program(POINT_VERTEX, BODY_FRAGMENT('point'));
    this.squares = this.program(SQUARE_VERTEX, BODY_FRAGMENT('square'));
    this.wallProgram = this.program(WALL_VERTEX, WALL_FRAGMENT);
    this.trailProgram = this.program(TRAIL_VERTEX, TRAIL_FRAGMENT);
    const [, largest] = gl.getParameter(gl.ALIASED_POINT_SIZE_RANGE);
    this.largestPoint = Math.min(LARGEST_POINT, largest / 2 - 1);
    this.ramp = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.ramp);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, table(SPEED_RAMP));
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.palette = new Float32Array(IDENTITY.flatMap(rgb));
    this.past = []; // frames, oldest first: {buffer, cloud, count, time}
    this.spare = [];
    this.lockedBuffer = gl.createBuffer();
    this.wallBuffer = gl.createBuffer();
    this.lockedCount = 0;
    this.wallCount = 0;
  }

  program(vertex, fragment) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const logs = gl.getAttachedShaders(program).map((shader) => gl.getShaderInfoLog(shader));
      throw new Error(`shader: ${gl.getProgramInfoLog(program)} ${logs.join(' ')}`);
    }
    const uniforms = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) || 0;
    for (let i = 0; i < count; i += 1) {
      const name = gl.getActiveUniform(program, i).name.replace('[0]', '');
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    return { program, uniforms };
  }

  setStatic(world) {
    const { gl } = this;
    const stride = 7;
    const numbers = new Float32Array(world.locked.length * stride);
    world.locked.forEach(({ x, y, radius }, i) => numbers.set([x, y, 0, 0, radius, 0, 0], i * stride));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.lockedBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    this.lockedCount = world.locked.length;
    this.largestLocked = Math.max(0, ...world.locked.map(({ radius }) => radius));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.wallBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(world.walls.flat()), gl.STATIC_DRAW);
    this.wallCount = world.walls.length;
  }

  // Keeps frames for `trail` seconds, so far apart that they make no more lines than can be drawn; after a jump
  // the trails begin anew.
  setBodies(world, goesOn, trail) {
    const { gl } = this;
    const now = world.seconds ?? performance.now() / 1000;
    if (!goesOn) this.forget();
    const apart = trail / Math.min(MOST_PIECES, MOST_TRAIL_LINES / Math.max(1, world.count));
    while (this.past.length && now - this.past[0].time > trail) this.spare.push(this.past.shift());
    const [last, before] = this.past.slice(-2).reverse();
    const isPassedOver = before && last.time - before.time < apart;
    const frame = isPassedOver || last?.time === now ? this.past.pop() : this.spare.pop() ?? { buffer: gl.createBuffer() };
    gl.bindBuffer(gl.ARRAY_BUFFER, frame.buffer);
    gl.bufferData(gl.ARRAY_BUFFER, world.bytes, gl.STREAM_DRAW);
    Object.assign(frame, { cloud: world.cloud, count: world.count, time: now });
    this.past.push(frame);
  }

  forget() {
    this.spare.push(...this.past.splice(0));
    for (const { buffer } of this.spare.splice(2)) this.gl.deleteBuffer(buffer);
  }

  // view: camera, ratio (device pixels per CSS pixel), look, mode, fastest, largest (radius, m), trail (s)
  draw(view) {
    const { gl, canvas } = this;
    const { camera, ratio, look } = view;
    const pixels = camera.scale * ratio;
    gl.viewport(-BORDER, -BORDER, canvas.width + 2 * BORDER, canvas.height + 2 * BORDER);
    gl.clearColor(...rgb(look.background), 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
    this.place = {
      centre: [camera.x, camera.y],
      toClip: [(2 * pixels) / (canvas.width + 2 * BORDER), (2 * pixels) / (canvas.height + 2 * BORDER)],
      pixels,
    };
    if (view.trail) this.drawTrails(view);
    this.drawWalls(look, ratio);
    if (this.lockedCount) {
      const layout = { step: 28, fields: { x: { offset: 0 }, y: { offset: 4 }, vx: { offset: 8 }, vy: { offset: 12 }, radius: { offset: 16 }, id: { offset: 24 } } };
      this.drawBodies(this.lockedBuffer, layout, this.lockedCount, this.largestLocked, { mode: 2, one: rgb(look.locked), pinned: 1, fastest: 1, ratio });
    }
    const frame = this.past[this.past.length - 1];
    if (frame) {
      const mode = view.mode === 'identity' ? 1 : 0;
      this.drawBodies(frame.buffer, frame.cloud, frame.count, view.largest, { mode, one: [0, 0, 0], pinned: 0, fastest: view.fastest, ratio });
    }
  }

  use({ program, uniforms }) {
    const { gl } = this;
    gl.useProgram(program);
    gl.uniform2fv(uniforms.centre, this.place.centre);
    gl.uniform2fv(uniforms.toClip, this.place.toClip);
    if (uniforms.pixels) gl.uniform1f(uniforms.pixels, this.place.pixels);
    return uniforms;
  }

  attribute(location, size, step, offset, divisor) {
    const { gl } = this;
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, gl.FLOAT, false, step, offset);
    gl.vertexAttribDivisor(location, divisor);
  }

  only(count) {
    for (let location = count; location < 6; location += 1) this.gl.disableVertexAttribArray(location);
  }

  drawBodies(buffer, { step, fields }, count, largest, choice) {
    const { gl } = this;
    const asPoints = largest * this.place.pixels <= this.largestPoint;
    const uniforms = this.use(asPoints ? this.points : this.squares);
    gl.uniform1i(uniforms.mode, choice.mode);
    gl.uniform3fv(uniforms.one, choice.one);
    gl.uniform1i(uniforms.pinned, choice.pinned);
    gl.uniform1f(uniforms.fastest, choice.fastest);
    gl.uniform1f(uniforms.least, 0.75 * choice.ratio);
    gl.uniform3fv(uniforms.palette, this.palette);
    gl.uniform1i(uniforms.ramp, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    const divisor = asPoints ? 0 : 1;
    ['x', 'y', 'vx', 'vy', 'radius'].forEach((name, location) => {
      this.attribute(location, 1, step, fields[name].offset, divisor);
    });
    gl.enableVertexAttribArray(5);
    gl.vertexAttribIPointer(5, 1, gl.UNSIGNED_INT, step, fields.id.offset);
    gl.vertexAttribDivisor(5, divisor);
    if (asPoints) gl.drawArrays(gl.POINTS, 0, count);
    else gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }

  drawWalls(look, ratio) {
    if (!this.wallCount) return;
    const { gl } = this;
    const uniforms = this.use(this.wallProgram);
    gl.uniform1f(uniforms.width, WALL_WIDTH * ratio);
    gl.uniform3f(uniforms.colour, ...rgb(look.wall));
    gl.bindBuffer(gl.ARRAY_BUFFER, this.wallBuffer);
    this.attribute(0, 4, 16, 0, 1);
    this.only(1);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.wallCount);
  }

  drawTrails({ look }) {
    const { gl, past } = this;
    const uniforms = this.use(this.trailProgram);
    this.only(4);
    for (let i = 0; i + 1 < past.length; i += 1) {
      gl.uniform4f(uniforms.flatColour, ...rgb(look.before), 0.08 + 0.6 * ((i + 1) / past.length) ** 1.5);
      [past[i], past[i + 1]].forEach(({ buffer, cloud }, which) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        this.attribute(2 * which, 1, cloud.step, cloud.fields.x.offset, 1);
        this.attribute(2 * which + 1, 1, cloud.step, cloud.fields.y.offset, 1);
      });
      gl.drawArraysInstanced(gl.LINES, 0, 2, Math.min(past[i].count, past[i + 1].count));
    }
  }
}
