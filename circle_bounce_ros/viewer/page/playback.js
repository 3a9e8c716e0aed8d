// How fast the scene goes: the speed that the user chose, and slow motion into a contact.

import { clamp } from './camera.js';
import { find, write } from './dom.js';

export const SPEEDS = [0.01, 0.02, 0.05, 0.1, 0.25, 0.5, 1, 2, 4, 8, 16, 32];
const SETTLED = 80; // ms without a move of the slider after which the node is asked
const PATIENCE = 3000; // ms for the node to report what it was asked for
const SLOWDOWN = 0.12; // of the speed chosen
const SLOW_BEFORE = 0.3; // s of the wall, before a contact
const SLOW_AFTER = 1200; // ms of the wall, after one

export class PlaybackSpeed {
  // send(message): returns whether it could be sent.
  constructor(send) {
    this.send = send;
    this.chosen = 1;
    this.timer = null;
    this.slowed = null; // what slow motion has asked for, until the node reports that it is over
    this.forget();
  }

  // The connection is gone, and with it all that was on its way.
  forget() {
    this.isSlow = false;
    this.slowUntil = -Infinity;
    this.awaited = null; // what the node was asked for and has not reported yet
    this.quiet = 0; // answers to slow motion, which nobody asked for in person
    this.show();
  }

  get rate() {
    return this.isSlow ? this.chosen * SLOWDOWN : this.chosen;
  }

  // The node's report. One from before the last change must not undo that.
  hear(timeScale, now) {
    if (this.awaited === timeScale || now - this.asked > PATIENCE) this.awaited = null;
    if (this.awaited === null && this.timer === null && !this.isSlow) {
      // Slow motion whose end got lost, with the connection or with an answer, is nobody's choice.
      if (timeScale === this.slowed) this.askQuietly();
      else {
        this.slowed = null;
        this.chosen = timeScale;
      }
    }
    this.show();
  }

  // Returns whether there is something to be announced.
  hearAnswer(done) {
    if (!done) this.awaited = null;
    if (this.quiet === 0) return true;
    this.quiet -= 1;
    return !done;
  }

  ask() {
    this.awaited = this.rate;
    if (this.isSlow) this.slowed = this.rate;
    this.asked = performance.now();
    return this.send({ type: 'time_scale', value: this.rate });
  }

  askQuietly() {
    if (this.ask()) this.quiet += 1;
  }

  choose(index) {
    this.chosen = SPEEDS[clamp(index, 0, SPEEDS.length - 1)];
    this.show();
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      this.timer = null;
      this.ask();
    }, SETTLED);
  }

  change(steps) {
    this.choose(this.nearest() + steps);
  }

  nearest() {
    const gap = (speed) => Math.abs(Math.log(speed / (this.chosen || SPEEDS[0])));
    return SPEEDS.reduce((best, speed, i) => (gap(speed) < gap(SPEEDS[best]) ? i : best), 0);
  }

  touched(now) {
    this.slowUntil = now + SLOW_AFTER;
  }

  // For each frame while slow motion is wanted; `next` is what the selected circle comes to, or null.
  followContact(now, next) {
    const isSoon = Boolean(next) && next.time / this.chosen < SLOW_BEFORE;
    const wanted = isSoon || now < this.slowUntil;
    if (wanted !== this.isSlow && this.awaited === null) this.turn(wanted);
  }

  endSlow() {
    this.slowUntil = -Infinity;
    if (this.isSlow) this.turn(false);
  }

  turn(isSlow) {
    this.isSlow = isSlow;
    this.askQuietly();
    this.show();
  }

  show() {
    const slider = find('speed');
    if (document.activeElement !== slider) slider.value = String(this.nearest());
    const shown = this.chosen === 0 ? 'as fast as possible' : `${this.chosen} ×`;
    slider.setAttribute('aria-valuetext', shown);
    write('speed-value', this.isSlow ? `slow ${shown}` : shown);
  }
}
