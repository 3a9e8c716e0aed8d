// The lesson's steps, from what the messages hold: points and vectors are [horizontal, vertical], SI units.

export const KINDS = ['circle', 'locked', 'wall', 'wall end'];
const CIRCLE = 0;

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1];
export const plus = (a, b) => [a[0] + b[0], a[1] + b[1]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1]];
export const times = (a, k) => [a[0] * k, a[1] * k];
export const length = (a) => Math.hypot(a[0], a[1]);
export const unit = (a) => times(a, 1 / (length(a) || 1));

// Eq. 1.1: the distance between two centres.
export const distance = (a, b) => length(minus(b, a));

// Eq. 1.5: no root is taken, and touching exactly counts.
export function inContact(a, ra, b, rb) {
  const [dh, dv] = minus(b, a);
  return dh * dh + dv * dv <= (ra + rb) * (ra + rb);
}

// The cheap alternative, wrong at the corners.
export function squaresOverlap(a, ra, b, rb) {
  return Math.abs(b[0] - a[0]) <= ra + rb && Math.abs(b[1] - a[1]) <= ra + rb;
}

// Eq. 2.1-2.4, radians. The normal points from the moving circle to what it touches.
export function bounceAngles(velocity, normal) {
  const v = Math.atan2(velocity[1], velocity[0]);
  const n = Math.atan2(normal[1], normal[0]);
  const d = v - n;
  return { v, n, d, pc: v - 2 * d + Math.PI };
}

// The new components: the old speed times cosine and sine of A_pc.
export function reflectByAngles(velocity, normal) {
  const { pc } = bounceAngles(velocity, normal);
  const speed = length(velocity);
  return [speed * Math.cos(pc), speed * Math.sin(pc)];
}

// The parts of a velocity along the normal (across the surface) and along the surface.
export function parts(velocity, normal) {
  const n = unit(normal);
  const across = times(n, dot(velocity, n));
  return { across, along: minus(velocity, across) };
}

// An angle above -180 and up to 180 degrees.
export function degrees(radians) {
  const turns = radians / (2 * Math.PI);
  return 360 * (turns - Math.ceil(turns - 0.5));
}

// As people write numbers: with a minus sign, and none at a zero.
export function signed(value, digits) {
  const text = value.toFixed(digits);
  return Number(text) < 0 ? text.replace('-', '−') : text.replace('-', '');
}

export function showDegrees(radians) {
  return `${signed(degrees(radians), 1)}°`;
}

// A recorded contact from the side of one of its two circles: the normal points from that one to the other.
export function takeApart(contact, circle) {
  const isOwn = contact.a === circle;
  const normal = unit(isOwn ? [contact.nx, contact.ny] : [-contact.nx, -contact.ny]);
  const body = isOwn ? 'a' : 'b';
  const before = [contact[`${body}x0`], contact[`${body}y0`]];
  const after = [contact[`${body}x1`], contact[`${body}y1`]];
  return {
    time: contact.time,
    kind: contact.kind,
    partner: isOwn ? contact.b : contact.a,
    isLocked: contact.kind !== CIRCLE,
    point: [contact.x, contact.y],
    normal,
    before,
    after,
    angles: bounceAngles(before, normal),
    before_parts: parts(before, normal),
    after_parts: parts(after, normal),
  };
}

// When two circles first touch, seconds from now: the smaller root, in the form that keeps its digits.
export function timeToTouch(offset, relative, reach) {
  const a = dot(relative, relative);
  const b = dot(offset, relative);
  const c = dot(offset, offset) - reach * reach;
  if (b >= 0) return Infinity;
  if (c <= 0) return 0;
  const inside = b * b - a * c;
  return inside > 0 ? c / (Math.sqrt(inside) - b) : Infinity;
}

// The point of a wall that is nearest to a place.
export function nearestOnWall([x1, y1, x2, y2], place) {
  const along = [x2 - x1, y2 - y1];
  const share = dot(minus(place, [x1, y1]), along) / (dot(along, along) || 1);
  return plus([x1, y1], times(along, Math.min(1, Math.max(0, share))));
}

// When a circle first touches a wall or one of its ends, seconds from now.
export function timeToWall([x1, y1, x2, y2], place, velocity, radius) {
  const along = [x2 - x1, y2 - y1];
  const size = length(along);
  let side = times([-along[1], along[0]], 1 / (size || 1));
  let gap = dot(minus(place, [x1, y1]), side);
  if (gap < 0) {
    side = times(side, -1);
    gap = -gap;
  }
  const closing = -dot(velocity, side);
  if (size && closing > 0 && gap >= radius * (1 - 1e-6)) {
    const time = Math.max(0, (gap - radius) / closing);
    const share = dot(minus(plus(place, times(velocity, time)), [x1, y1]), along) / (size * size);
    if (share >= 0 && share <= 1) return time;
  }
  const ends = [[x1, y1], [x2, y2]].map((end) => timeToTouch(minus(place, end), velocity, radius));
  return Math.min(...ends);
}
