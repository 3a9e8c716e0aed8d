// What the user chose about the picture: dark or light, colours and their legend, trails.

import { IDENTITY, LOOKS, SPEED_RAMP } from './colours.js';
import { find, write } from './dom.js';
import { MOST_TRAILS } from './gl.js';

const FEW = 8; // circles that are told apart by colour rather than by speed
const FEW_TRAILS = 64; // circles whose trails can be told apart
const USUAL_TRAIL = 1; // s
const LONGEST_TRAIL = 4; // s
const CALM = window.matchMedia('(prefers-reduced-motion: reduce)');
const LIGHT = window.matchMedia('(prefers-color-scheme: light)');

export class Looks {
  // changed(): what is to be seen is no longer what was drawn.
  constructor(changed) {
    this.changed = changed;
    this.choice = null; // of colours: what the user chose, else what suits the scene
    this.trailChoice = null; // s: the same of trails
    this.count = 0; // moving circles
    this.fastest = 1; // m/s: the end of the ramp
    this.chooseTheme(localStorage.getItem('theme') ?? (LIGHT.matches ? 'light' : 'dark'));
    this.setTrail(null);
  }

  chooseTheme(theme) {
    this.theme = theme;
    this.colours = LOOKS[theme];
    document.documentElement.dataset.theme = theme;
    this.changed();
  }

  switchTheme() {
    this.chooseTheme(this.theme === 'dark' ? 'light' : 'dark');
    localStorage.setItem('theme', this.theme);
  }

  get mode() {
    return this.choice ?? (this.count <= FEW ? 'identity' : 'speed');
  }

  chooseColours(mode) {
    this.choice = mode;
    this.showLegend();
    this.changed();
  }

  switchColours() {
    this.chooseColours(this.mode === 'speed' ? 'identity' : 'speed');
  }

  // Another scene: so many moving and locked circles.
  suit(count, locked) {
    this.count = count;
    this.fastest = null;
    find('legend-locked').hidden = !locked;
    this.setTrail(this.trailChoice);
    this.showLegend();
  }

  // The ramp ends near the fastest of these speeds (m/s), and follows them slowly.
  measure(speeds) {
    const sorted = [...speeds].sort((a, b) => a - b);
    const top = sorted[sorted.length - 1] ?? 0;
    const high = Math.max(sorted[Math.floor(0.98 * (sorted.length - 1))] ?? 0, 0.25 * top) || 1;
    this.fastest = this.fastest === null ? high : this.fastest + 0.1 * (high - this.fastest);
    this.showLegend();
  }

  showLegend() {
    const { mode } = this;
    document.querySelector(`input[name="colour"][value="${mode}"]`).checked = true;
    const isBySpeed = mode === 'speed';
    write('legend-title', isBySpeed ? 'speed' : 'by circle');
    write('legend-low', isBySpeed ? '0' : '');
    const repeat = this.count > IDENTITY.length ? 'colours repeat' : '';
    write('legend-high', isBySpeed ? `${(this.fastest ?? 1).toPrecision(2)} m/s` : repeat);
    const background = isBySpeed ? ramp(SPEED_RAMP) : swatches(IDENTITY.slice(0, Math.max(1, this.count)));
    if (this.legend !== background) find('legend-ramp').style.background = background;
    this.legend = background;
  }

  // null: what suits the scene. Many trails tell nothing and cost much.
  setTrail(seconds) {
    this.trailChoice = seconds;
    const isTooMany = this.count > MOST_TRAILS;
    const suits = CALM.matches || this.count > FEW_TRAILS ? 0 : USUAL_TRAIL;
    this.trail = isTooMany ? 0 : seconds ?? suits;
    find('trails').value = String(this.trail);
    write('trails-value', this.trail ? `${this.trail} s` : isTooMany && seconds ? 'too many circles' : 'off');
    this.changed();
  }

  // From off to the longest, then off again.
  nextTrail() {
    this.setTrail(this.trail >= LONGEST_TRAIL ? 0 : this.trail ? Math.min(LONGEST_TRAIL, 2 * this.trail) : USUAL_TRAIL / 2);
  }
}

function ramp(colours) {
  return `linear-gradient(90deg, ${colours.join(',')})`;
}

function swatches(colours) {
  const part = 100 / colours.length;
  return ramp(colours.map((colour, i) => `${colour} ${i * part}% ${(i + 1) * part}%`));
}
