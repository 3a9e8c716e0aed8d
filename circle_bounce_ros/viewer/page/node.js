// The node as the page knows it: what it says about itself, and what it is asked to do.

import { announce } from './notices.js';

export class RemoteNode {
  // send(message): returns whether it could be sent.
  constructor(send) {
    this.send = send;
    this.values = {}; // of /diagnostics, as they were said
    this.topic = '';
    this.publishers = null; // names of the nodes that publish that topic; null: not known
    this.faults = {}; // what the viewer could not read, by channel
  }

  // null: it has not said so yet.
  get paused() {
    return 'paused' in this.values ? this.values.paused === 'true' : null;
  }

  // Returns whether it shows another scene than before.
  report(values) {
    const isOther = values.scene !== this.values.scene || values.seed !== this.values.seed;
    this.values = values;
    return isOther;
  }

  // Returns whether it could be sent.
  ask(message) {
    const isSent = this.send(message);
    if (!isSent) announce('no connection to the viewer', true);
    return isSent;
  }

  pause() { this.ask({ type: 'pause', paused: !this.paused }); }
  step() { this.ask({ type: 'step' }); }
  reset() { this.ask({ type: 'reset' }); }
}
