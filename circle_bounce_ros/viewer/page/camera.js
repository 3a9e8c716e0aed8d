// Which part of the plane is seen: x to the right, y up, one scale for both.

const CLOSEST = 1e6; // CSS pixels per metre
const FURTHEST = 1e-6;
const MARGIN = 24; // CSS pixels around a scene that fits
const BELOW = 34; // more of them below it, for what is written there

export class Camera {
  constructor() {
    this.x = 0;
    this.y = 0;
    this.scale = 100; // CSS pixels per metre
    this.width = 1;
    this.height = 1;
    this.fits = true; // as long as nobody has moved it
  }

  resize(width, height) {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
  }

  fit({ left, right, bottom, top }) {
    this.x = (left + right) / 2;
    this.y = (bottom + top) / 2;
    const wide = (this.width - 2 * MARGIN) / Math.max(right - left, 1e-9);
    const high = (this.height - 2 * MARGIN - BELOW) / Math.max(top - bottom, 1e-9);
    this.scale = clamp(Math.min(wide, high), FURTHEST, CLOSEST);
    this.y -= BELOW / 2 / this.scale;
    this.fits = true;
  }

  lookAt(x, y) {
    this.x = x;
    this.y = y;
    this.fits = false;
  }

  pan(right, down) {
    this.x -= right / this.scale;
    this.y += down / this.scale;
    this.fits = false;
  }

  zoom(factor, px = this.width / 2, py = this.height / 2) {
    const [x, y] = this.toWorld(px, py);
    this.scale = clamp(this.scale * factor, FURTHEST, CLOSEST);
    const [nx, ny] = this.toWorld(px, py);
    this.x += x - nx;
    this.y += y - ny;
    this.fits = false;
  }

  toScreen(x, y) {
    return [this.width / 2 + (x - this.x) * this.scale, this.height / 2 - (y - this.y) * this.scale];
  }

  toWorld(px, py) {
    return [this.x + (px - this.width / 2) / this.scale, this.y - (py - this.height / 2) / this.scale];
  }
}

export function clamp(value, least, most) {
  return Math.min(most, Math.max(least, value));
}
