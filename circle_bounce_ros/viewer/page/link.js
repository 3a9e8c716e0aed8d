// The connection to the viewer: it comes back by itself.

const KINDS = { 1: 'bodies', 2: 'static' };
const HEAD = 12; // bytes: kind, number of the frame, length of its first message
const FIRST_WAIT = 150; // ms
const LONGEST_WAIT = 1000; // ms

export class Link {
  // on: opened(), closed(), text(message), frame({kind, number, buffer, start, timeLength})
  constructor(on) {
    this.on = on;
    this.wait = FIRST_WAIT;
    this.connect();
  }

  connect() {
    const socket = new WebSocket(`ws://${window.location.host}/socket`);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.wait = FIRST_WAIT;
      this.socket = socket;
      this.on.opened();
    };
    socket.onmessage = ({ data }) => {
      if (typeof data === 'string') this.on.text(JSON.parse(data));
      else this.receive(data);
    };
    socket.onclose = () => {
      if (this.socket === socket) this.on.closed();
      this.socket = null;
      window.setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(LONGEST_WAIT, this.wait * 2);
    };
  }

  receive(buffer) {
    const head = new DataView(buffer);
    this.on.frame({
      kind: KINDS[head.getUint32(0, true)],
      number: head.getUint32(4, true),
      timeLength: head.getUint32(8, true),
      buffer,
      start: HEAD,
    });
  }

  // Returns whether it could be sent.
  send(message) {
    if (!this.socket || this.socket.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }
}
