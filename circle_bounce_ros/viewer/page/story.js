// What there is to tell about the selected circle: what it comes to next, and what it touched last.

import { distance, minus, nearestOnWall, plus, squaresOverlap, takeApart, timeToTouch, timeToWall, times } from './lesson.js';

const SHOWN = 3200; // ms that a contact stays in the picture
const WAITING = 400; // contacts that the picture has not come to yet

export class Story {
  constructor() {
    this.select(-1);
  }

  select(circle) {
    this.circle = circle;
    this.next = null;
    this.age = Infinity;
    this.count = 0;
    this.restart();
  }

  hear(message) {
    if (message.circle !== this.circle) return;
    this.waiting.push(...message.contacts.map((contact) => takeApart(contact, this.circle)));
    this.waiting.splice(0, this.waiting.length - WAITING);
  }

  // The scene starts again, or is another one.
  restart() {
    this.last = null;
    this.waiting = [];
    this.path = []; // where the circle has been: {x, y, time}
  }

  // Keeps `trail` seconds of the scene.
  remember(seconds, trail) {
    if (!this.now || seconds === null) return;
    this.path.push({ x: this.now.x, y: this.now.y, time: seconds });
    while (this.path.length && seconds - this.path[0].time > trail) this.path.shift();
  }

  // Returns the contacts that the picture has just come to.
  update(world, passed, paused) {
    const row = world.rowOf(this.circle);
    this.now = row < 0 ? null : world.circle(row);
    this.age += paused ? 0 : passed;
    const come = [];
    while (this.waiting.length && (world.seconds === null || this.waiting[0].time <= world.seconds + 1e-9)) {
      come.push(this.waiting.shift());
    }
    if (come.length) {
      this.last = come[come.length - 1];
      this.age = 0;
      this.count += come.length;
    }
    this.next = this.now && comesTo(world, this.now);
    return come;
  }

  // Milliseconds of the wall until the next contact, at so many seconds of the scene per second.
  untilNext(rate) {
    return this.next && rate ? (1000 * this.next.time) / rate : Infinity;
  }

  // From 1, just now, to 0.
  get freshness() {
    return this.last ? Math.max(0, 1 - this.age / SHOWN) : 0;
  }
}

// The next thing that a circle touches if nothing else moves in between, or the nearest thing when it touches none.
export function comesTo(world, own) {
  const place = [own.x, own.y];
  const velocity = [own.vx, own.vy];
  let best = null;
  const consider = (time, gap, describe) => {
    if (best === null || time < best.time || (time === Infinity && best.time === Infinity && gap < best.gap)) {
      best = { time, gap, ...describe() };
    }
  };
  world.walls.forEach((wall, number) => {
    const foot = nearestOnWall(wall, place);
    const time = timeToWall(wall, place, velocity, own.radius);
    consider(time, distance(place, foot) - own.radius, () => {
      const touched = time < Infinity ? nearestOnWall(wall, plus(place, times(velocity, time))) : foot;
      return { name: `wall ${number}`, kind: 'wall', centre: foot, target: touched, radius: 0 };
    });
  });
  for (const other of world.locked) {
    const centre = [other.x, other.y];
    const reach = own.radius + other.radius;
    consider(timeToTouch(minus(place, centre), velocity, reach), distance(place, centre) - reach, () => ({
      name: other.id < 0 ? 'a locked circle' : `locked circle ${other.id}`, kind: 'locked', centre, target: centre, radius: other.radius,
    }));
  }
  const { count } = world;
  for (let row = 0; row < count; row += 1) {
    if (row === own.row) continue;
    const dx = own.x - world.get(row, 'x');
    const dy = own.y - world.get(row, 'y');
    const ux = own.vx - world.get(row, 'vx');
    const uy = own.vy - world.get(row, 'vy');
    if (dx * ux + dy * uy >= 0) continue;
    const reach = own.radius + world.get(row, 'radius');
    const time = timeToTouch([dx, dy], [ux, uy], reach);
    if (time === Infinity || (best && time >= best.time)) continue;
    consider(time, Math.hypot(dx, dy) - reach, () => {
      const other = world.circle(row);
      const centre = [other.x, other.y];
      return { name: `circle ${other.id}`, kind: 'circle', centre, target: plus(centre, times([other.vx, other.vy], time)), radius: other.radius };
    });
  }
  return best && { ...best, distance: distance(place, best.centre), sum: own.radius + best.radius };
}

// Of circles as [x, y, radius]: which have overlapping squares, and which pairs of them do not touch.
export function squaresThatOverlap(circles, isPair) {
  const lit = new Set();
  const pairs = [];
  const byLeft = circles.map((_, i) => i).sort((a, b) => circles[a][0] - circles[a][2] - (circles[b][0] - circles[b][2]));
  byLeft.forEach((a, at) => {
    const [ax, ay, ar] = circles[a];
    for (let next = at + 1; next < byLeft.length; next += 1) {
      const b = byLeft[next];
      const [bx, by, br] = circles[b];
      if (bx - br > ax + ar) break;
      if (!isPair(a, b) || !squaresOverlap([ax, ay], ar, [bx, by], br)) continue;
      const d = Math.hypot(bx - ax, by - ay);
      if (d > (ar + br) * (1 + 1e-6)) {
        lit.add(a).add(b);
        pairs.push({ a, b, distance: d, sum: ar + br });
      }
    }
  });
  return { lit, pairs };
}
