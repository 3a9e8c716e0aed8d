// The newest that was said about the scene.

import { readCloud, readMarkers, readTime } from './cdr.js';

const DELETE_ALL = 3;
const LINE_LIST = 5;
const CYLINDER = 3;
const SPHERE_LIST = 7;
const FLOAT32 = 7;
const UINT32 = 6;
const NEEDED = { x: FLOAT32, y: FLOAT32, vx: FLOAT32, vy: FLOAT32, radius: FLOAT32, id: UINT32 };

export class World {
  constructor() {
    this.locked = []; // {id, x, y, radius}; an id of -1 is not known
    this.walls = []; // [x1, y1, x2, y2]
    this.cloud = null;
    this.count = 0;
    this.seconds = null; // of scene time, if it is known
    this.scene = '';
    this.generation = 0; // changes with the scene
    this.rows = new Map();
  }

  setStatic(buffer, start) {
    const locked = [];
    const walls = [];
    for (const { ns, id, type, action, position, scale, points } of readMarkers(buffer, start)) {
      if (action === DELETE_ALL) continue;
      if (type === LINE_LIST) {
        for (let i = 0; i + 1 < points.length; i += 2) {
          walls.push([points[i][0], points[i][1], points[i + 1][0], points[i + 1][1]]);
        }
      } else if (type === CYLINDER && ns === 'locked') {
        locked.push({ id, x: position[0], y: position[1], radius: scale[0] / 2 });
      } else if (type === SPHERE_LIST) {
        for (const [x, y] of points) locked.push({ id: -1, x, y, radius: scale[0] / 2 });
      }
    }
    this.locked = locked;
    this.walls = walls;
    this.renew();
  }

  // Returns whether time has gone on from the frame before.
  setBodies(buffer, start, timeLength) {
    const from = start + timeLength + ((4 - (timeLength % 4)) % 4);
    let cloud = readCloud(buffer, from);
    for (const [name, type] of Object.entries(NEEDED)) {
      const got = cloud.fields[name]?.type ?? 'none';
      if (got !== type) throw new Error(`fields.${name}: must be there with datatype ${type}, got ${got}`);
    }
    const { count: before, seconds: then } = this;
    const time = timeLength ? readTime(buffer, start) : null;
    if (!isForCard(cloud)) cloud = copyForCard(buffer, cloud);
    this.cloud = cloud;
    this.view = new DataView(cloud.buffer ?? buffer, cloud.start, cloud.length);
    this.bytes = new Uint8Array(cloud.buffer ?? buffer, cloud.start, cloud.length);
    this.count = cloud.count;
    this.seconds = time ? time.seconds : null;
    if (time) this.scene = time.scene;
    if (this.count !== before) this.renew();
    return this.count === before && !(this.seconds !== null && then !== null && this.seconds < then);
  }

  renew() {
    this.generation += 1;
    this.rows.clear();
  }

  get(row, name) {
    const at = row * this.cloud.step + this.cloud.fields[name].offset;
    return name === 'id' ? this.view.getUint32(at, true) : this.view.getFloat32(at, true);
  }

  circle(row) {
    const circle = { row };
    for (const name of Object.keys(NEEDED)) circle[name] = this.get(row, name);
    return circle;
  }

  // The row of a circle in the newest frame, or -1.
  rowOf(id) {
    if (!this.cloud) return -1;
    const known = this.rows.get(id);
    if (known !== undefined && known < this.count && this.get(known, 'id') === id) return known;
    for (let row = 0; row < this.count; row += 1) {
      if (this.get(row, 'id') === id) {
        this.rows.set(id, row);
        return row;
      }
    }
    return -1;
  }

  largestRadius() {
    let largest = 0;
    for (let row = 0; row < this.count; row += 1) largest = Math.max(largest, this.get(row, 'radius'));
    return largest;
  }

  // Of at most `most` circles, evenly chosen: their speeds, m/s.
  speeds(most) {
    const every = Math.max(1, Math.ceil(this.count / most));
    const speeds = [];
    for (let row = 0; row < this.count; row += every) {
      speeds.push(Math.hypot(this.get(row, 'vx'), this.get(row, 'vy')));
    }
    return speeds;
  }

  // The moving circle at a place, or the nearest one within reach of it; -1 for none.
  pick(x, y, reach) {
    let best = -1;
    let nearest = reach;
    for (let row = 0; row < this.count; row += 1) {
      const gap = Math.hypot(this.get(row, 'x') - x, this.get(row, 'y') - y) - this.get(row, 'radius');
      if (gap < nearest) {
        nearest = gap;
        best = row;
      }
    }
    return best < 0 ? -1 : this.get(best, 'id');
  }

  // What has to be seen: walls and locked circles, else whatever moves.
  bounds() {
    const box = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
    const add = (x, y, reach) => {
      box.left = Math.min(box.left, x - reach);
      box.right = Math.max(box.right, x + reach);
      box.bottom = Math.min(box.bottom, y - reach);
      box.top = Math.max(box.top, y + reach);
    };
    for (const [x1, y1, x2, y2] of this.walls) {
      add(x1, y1, 0);
      add(x2, y2, 0);
    }
    for (const { x, y, radius } of this.locked) add(x, y, radius);
    for (let row = 0; row < this.count; row += 1) add(this.get(row, 'x'), this.get(row, 'y'), this.get(row, 'radius'));
    return box.left <= box.right ? box : { left: -1, right: 1, bottom: -1, top: 1 };
  }
}

// Graphics cards want numbers of 4 bytes at multiples of 4, and points not further apart than this.
const LARGEST_STRIDE = 252; // bytes

function isForCard({ step, fields }) {
  return step <= LARGEST_STRIDE && step % 4 === 0 && Object.keys(NEEDED).every((name) => fields[name].offset % 4 === 0);
}

// The same points with the needed fields only, one after the other.
function copyForCard(buffer, cloud) {
  const names = Object.keys(NEEDED);
  const step = 4 * names.length;
  const length = step * cloud.count;
  const from = new DataView(buffer, cloud.start, cloud.length);
  const to = new DataView(new ArrayBuffer(length));
  const fields = {};
  names.forEach((name, i) => {
    fields[name] = { ...cloud.fields[name], offset: 4 * i };
    for (let row = 0; row < cloud.count; row += 1) {
      to.setUint32(row * step + 4 * i, from.getUint32(row * cloud.step + cloud.fields[name].offset, true), true);
    }
  });
  return { ...cloud, fields, step, length, start: 0, buffer: to.buffer };
}
