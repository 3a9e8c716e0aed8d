// The lesson drawn over the picture: what a teacher would draw on the board.

import { clamp } from './camera.js';
import { Labels } from './labels.js';
import { bounceAngles, degrees, showDegrees, length, minus, plus, times, unit } from './lesson.js';
import { squaresThatOverlap } from './story.js';

const MOST_SQUARES = 400;
const SEEN = 450; // ms that a contact has the picture to itself
const COMING = 700; // ms of the wall before the next one that belong to that

export class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
    this.c = canvas.getContext('2d');
    this.isEmpty = true;
    this.corners = null; // what the squares say about the selected circle, or about all
  }

  // view: camera, ratio, look; world, story; trail (s); squares (boolean);
  // untilNext (ms of the wall until the next contact)
  draw(view) {
    const { c, canvas } = this;
    const { world, story } = view;
    const wanted = story.now || view.squares;
    if (!wanted && this.isEmpty) return;
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, canvas.width, canvas.height);
    this.isEmpty = !wanted;
    this.corners = null;
    if (!wanted || !world.cloud) return;
    c.setTransform(view.ratio, 0, 0, view.ratio, 0, 0);
    c.lineCap = 'round';
    c.lineJoin = 'round';
    this.labels = new Labels(c, view.camera, view.look.halo);
    this.view = view;
    if (view.squares) this.drawSquares(view);
    if (!story.now) return;
    this.drawPath(view);
    this.drawSelected(view);
    // The next contact pushes the last one out, but not before that has been seen.
    const near = story.age < SEEN ? 0 : clamp((COMING - view.untilNext) / 200, 0, 1);
    const fresh = story.freshness;
    const approach = Math.max(near, clamp((0.55 - fresh) * 5, 0, 1));
    const contact = clamp(fresh * 3, 0, 1) * (1 - near);
    if (story.next && approach > 0) this.drawApproach(view, approach);
    if (contact > 0) this.drawContact(view, contact);
    c.globalAlpha = 1;
  }

  at(point) {
    return this.view.camera.toScreen(point[0], point[1]);
  }

  line(from, to, colour, width = 1.5, dash = []) {
    const { c } = this;
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    c.moveTo(...from);
    c.lineTo(...to);
    c.stroke();
    c.setLineDash([]);
  }

  ring(centre, radius, colour, width = 1.5, dash = []) {
    const { c } = this;
    c.strokeStyle = colour;
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    c.arc(...centre, Math.max(0, radius), 0, 2 * Math.PI);
    c.stroke();
    c.setLineDash([]);
  }

  arrow(from, step, colour, width = 3) {
    const size = length(step);
    if (size < 3) return;
    const { c } = this;
    const tip = plus(from, step);
    const head = Math.min(11, size * 0.5);
    const back = times(step, -head / size);
    const side = [-back[1] * 0.45, back[0] * 0.45];
    this.line(from, plus(tip, times(back, 0.8)), this.view.look.halo, width + 3);
    this.line(from, plus(tip, times(back, 0.8)), colour, width);
    c.fillStyle = colour;
    c.beginPath();
    c.moveTo(...tip);
    c.lineTo(...plus(plus(tip, back), side));
    c.lineTo(...minus(plus(tip, back), side));
    c.fill();
  }

  // How long arrows are: the selected circle's speed is this many pixels.
  get reach() {
    const { camera, story } = this.view;
    const size = Math.min(camera.width, camera.height);
    return Math.min(Math.max(150, story.now.radius * camera.scale * 2.2), 0.26 * size);
  }

  step(velocity) {
    const { now } = this.view.story;
    const speed = Math.hypot(now.vx, now.vy) || 1;
    return [velocity[0] * this.reach / speed, -velocity[1] * this.reach / speed];
  }

  drawPath({ story: { path }, look, trail }) {
    if (!trail || path.length < 2) return;
    const { c } = this;
    c.strokeStyle = look.before;
    c.lineWidth = 2;
    c.globalAlpha = 0.75;
    c.beginPath();
    path.forEach(({ x, y }, i) => (i ? c.lineTo(...this.at([x, y])) : c.moveTo(...this.at([x, y]))));
    c.stroke();
    c.globalAlpha = 1;
  }

  drawSelected({ story, camera, look }) {
    const { now } = story;
    const centre = this.at([now.x, now.y]);
    const radius = now.radius * camera.scale;
    this.ring(centre, radius + 4, look.halo, 5);
    this.ring(centre, radius + 4, look.text, 2);
    if (story.freshness < 0.55 || story.age > SEEN) this.arrow(centre, this.step([now.vx, now.vy]), look.before);
  }

  drawApproach({ story, camera, look }, alpha) {
    const { c } = this;
    const { now, next } = story;
    c.globalAlpha = alpha;
    const own = this.at([now.x, now.y]);
    const other = this.at(next.centre);
    if (next.time < Infinity) {
      const there = this.at([now.x + now.vx * next.time, now.y + now.vy * next.time]);
      this.line(own, there, look.dim, 1.2, [2, 6]);
      this.ring(there, now.radius * camera.scale, look.dim, 1.5, [5, 5]);
    }
    // D is drawn from centre to centre, and on it the part that the radii cover.
    this.line(own, other, look.halo, 6);
    this.line(own, other, look.text, 1.6, [7, 5]);
    const towards = unit(minus(other, own));
    this.line(own, plus(own, times(towards, now.radius * camera.scale)), look.after, 3.5);
    if (next.radius) this.line(other, minus(other, times(towards, next.radius * camera.scale)), look.after, 3.5);
    const middle = times(plus(own, other), 0.5);
    // Above the line, or to its side where it is steep.
    const side = times([-towards[1], towards[0]], towards[0] > 0 ? -1 : 1);
    const aside = plus(middle, times(side, Math.abs(towards[0]) > 0.5 ? 46 : 74));
    this.labels.write(`D = ${metres(next.distance)}`, aside, look.text);
    this.labels.write(`${next.radius ? 'r_1 + r_2' : 'r'} = ${metres(next.sum)}`, plus(aside, [0, 18]), look.after);
    c.globalAlpha = 1;
  }

  drawContact({ story, camera, look }, alpha) {
    const { c } = this;
    const { last, now } = story;
    c.globalAlpha = alpha;
    const touch = this.at(last.point);
    const normal = [last.normal[0], -last.normal[1]];
    const surface = [-normal[1], normal[0]];
    const radius = now.radius * camera.scale;
    const centre = minus(touch, times(normal, radius));
    const { reach } = this;
    this.ring(centre, radius, look.text, 1.5, [3, 4]);
    this.line(minus(touch, times(surface, reach * 1.15)), plus(touch, times(surface, reach * 1.15)), look.dim, 1.5);
    this.line(centre, plus(touch, times(normal, reach * 0.8)), look.halo, 5);
    this.line(minus(centre, times(normal, reach * 0.35)), plus(touch, times(normal, reach * 0.8)), look.normal, 2, [9, 5]);
    this.labels.write('normal', plus(touch, times(normal, reach * 0.8 + 14)), look.normal);
    this.line(centre, plus(centre, [reach * 1.05, 0]), look.dim, 1, [2, 4]);

    const before = this.step(last.before);
    const after = this.step(last.after);
    // Where they lie on the sides of the rectangle whose diagonal is the velocity.
    const bp = last.before_parts;
    const ap = last.after_parts;
    const tail = minus(centre, before);
    this.arrow(tail, this.step(bp.across), look.across, 1.8);
    this.arrow(tail, this.step(bp.along), look.along, 1.8);
    this.arrow(centre, this.step(ap.across), look.across, 1.8);
    this.arrow(centre, this.step(ap.along), look.along, 1.8);
    this.arrow(tail, before, look.before);
    this.arrow(centre, after, look.after);
    this.labels.write('v before', minus(tail, times(unit(before), 14)), look.before);
    this.labels.write('v after', plus(plus(centre, after), times(unit(after), 16)), look.after);
    this.labels.write('across', plus(plus(centre, this.step(ap.across)), times(normal, -10)), look.across);
    if (length(this.step(ap.along)) > 24) {
      this.labels.write('along', plus(plus(centre, this.step(ap.along)), times(unit(this.step(ap.along)), 20)), look.along);
    }

    const { v, n, pc } = last.angles;
    const turned = last.isLocked ? pc : bounceAngles(last.after, last.normal).v;
    this.arc(centre, v, reach * 0.44, look.before, 'A_v');
    this.arc(centre, n, reach * 0.6, look.normal, 'A_n');
    this.arc(centre, turned, reach * 0.76, look.after, last.isLocked ? 'A_pc' : 'after');
    c.fillStyle = look.halo;
    c.beginPath();
    c.arc(...touch, 7, 0, 2 * Math.PI);
    c.fill();
    c.fillStyle = look.normal;
    c.beginPath();
    c.arc(...touch, 5, 0, 2 * Math.PI);
    c.fill();
    c.globalAlpha = 1;
  }

  // From +x to an angle, the shorter way round; counter-clockwise is positive.
  arc(centre, radians, radius, colour, name) {
    const { c } = this;
    const turn = (degrees(radians) * Math.PI) / 180;
    c.strokeStyle = colour;
    c.lineWidth = 2;
    c.beginPath();
    c.arc(...centre, radius, 0, -turn, turn > 0);
    c.stroke();
    const tip = plus(centre, [radius * Math.cos(turn), -radius * Math.sin(turn)]);
    c.fillStyle = colour;
    c.beginPath();
    c.arc(...tip, 3, 0, 2 * Math.PI);
    c.fill();
    // A flat angle is written beside its arc, where no arrow is.
    const place = Math.abs(turn) < 0.3 ? Math.sign(turn || 1) * 0.3 : turn / 2;
    const far = radius + 12 + 34 * Math.abs(Math.cos(place));
    this.labels.write(`${name} ${showDegrees(radians)}`, plus(centre, [far * Math.cos(place), -far * Math.sin(place)]), colour);
  }

  drawSquares({ world, story, camera, look }) {
    const { c } = this;
    const all = world.count + world.locked.length <= MOST_SQUARES;
    const circles = [];
    for (const { x, y, radius } of world.locked) circles.push([x, y, radius]);
    const locked = circles.length;
    let own = -1;
    for (let row = 0; row < world.count; row += 1) {
      if (story.now && row === story.now.row) own = circles.length;
      circles.push([world.get(row, 'x'), world.get(row, 'y'), world.get(row, 'radius')]);
    }
    if (!all && own < 0) return;
    const isPair = all ? (a, b) => a >= locked || b >= locked : (a, b) => a === own || b === own;
    const { lit, pairs } = squaresThatOverlap(circles, isPair);
    circles.forEach(([x, y, radius], i) => {
      if (!all && i !== own && !lit.has(i)) return;
      const [left, top] = this.at([x - radius, y + radius]);
      const size = 2 * radius * camera.scale;
      c.lineWidth = lit.has(i) ? 2.5 : 1;
      c.strokeStyle = lit.has(i) ? look.lit : look.dim;
      c.strokeRect(left, top, size, size);
      if (lit.has(i)) {
        c.globalAlpha = 0.14;
        c.fillStyle = look.lit;
        c.fillRect(left, top, size, size);
        c.globalAlpha = 1;
      }
    });
    this.corners = { pairs: own < 0 ? pairs : pairs.filter(({ a, b }) => a === own || b === own), own: own >= 0 };
  }
}

export function metres(value) {
  return `${value.toFixed(value < 0.1 ? 4 : 3)} m`;
}
