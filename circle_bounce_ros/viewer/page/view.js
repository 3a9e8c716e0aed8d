// Which part of the scene fills the two canvases that lie on each other.

import { Camera } from './camera.js';
import { find } from './dom.js';

const MOST_PIXELS = 2; // device pixels per CSS pixel; more of them nobody sees, and they cost
const CLOSE_UP = 0.07; // of the picture's shorter side: the radius of a circle that is followed

export class View {
  // bounds(): what has to be seen of the scene; changed(): what is seen is no longer what was drawn.
  constructor(canvases, bounds, changed) {
    this.canvases = canvases;
    this.bounds = bounds;
    this.changed = changed;
    this.camera = new Camera();
    const stage = canvases[0].parentElement;
    new ResizeObserver(() => this.resize(stage.clientWidth, stage.clientHeight)).observe(stage);
    this.resize(stage.clientWidth, stage.clientHeight);
  }

  resize(width, height) {
    this.ratio = Math.min(MOST_PIXELS, window.devicePixelRatio || 1);
    for (const canvas of this.canvases) {
      canvas.width = Math.round(width * this.ratio);
      canvas.height = Math.round(height * this.ratio);
    }
    const [{ width: wide, height: high }] = this.canvases;
    const { fits } = this.camera;
    this.camera.resize(wide / this.ratio, high / this.ratio);
    if (fits) this.fit();
    this.changed();
  }

  fit() {
    find('follow').checked = false;
    this.camera.fit(this.bounds());
    this.changed();
  }

  move(right, down) {
    find('follow').checked = false;
    this.camera.pan(right, down);
    this.changed();
  }

  zoom(factor, px, py) {
    this.camera.zoom(factor, px, py);
    this.changed();
  }

  // Keeps a circle in the middle.
  follow({ x, y }) {
    this.camera.lookAt(x, y);
    this.changed();
  }

  comeClose(circle) {
    const { width, height, scale } = this.camera;
    const wanted = (CLOSE_UP * Math.min(width, height)) / circle.radius;
    if (wanted > scale) this.camera.zoom(wanted / scale);
    this.follow(circle);
  }
}
