// Words over the picture, each near its place, inside the picture and not on one another.

const FONT = '600 14px system-ui, sans-serif';
const LOW_FONT = '600 10.5px system-ui, sans-serif';
const LOW_BY = 4; // CSS pixels
const HIGH = 18; // of a line
const EDGE = 8;
const MOST_TRIES = 12;

export class Labels {
  constructor(c, { width, height }, halo) {
    this.c = c;
    this.width = width;
    this.height = height;
    this.halo = halo;
    this.boxes = []; // [left, base line, width]
  }

  // What follows an underscore is set low: A_pc.
  write(text, place, colour) {
    const pieces = text.split(/(_\w+)/).filter(Boolean).map((piece) => this.measure(piece));
    const wide = pieces.reduce((sum, piece) => sum + piece.wide, 0);
    const x = Math.min(this.width - wide - EDGE, Math.max(EDGE, place[0] - wide / 2));
    const y = this.free(x, Math.min(this.height - EDGE, Math.max(HIGH + 2, place[1] + 5)), wide);
    this.boxes.push([x, y, wide]);
    const { c } = this;
    c.lineWidth = 4;
    c.strokeStyle = this.halo;
    c.fillStyle = colour;
    for (const paint of ['strokeText', 'fillText']) {
      let at = x;
      for (const { words, font, low, wide: own } of pieces) {
        c.font = font;
        c[paint](words, at, y + low);
        at += own;
      }
    }
  }

  measure(piece) {
    const isLow = piece.startsWith('_');
    const words = isLow ? piece.slice(1) : piece;
    const font = isLow ? LOW_FONT : FONT;
    this.c.font = font;
    return { words, font, low: isLow ? LOW_BY : 0, wide: this.c.measureText(words).width };
  }

  // The next free line in one direction: away from the first one that is in the way.
  free(x, wanted, wide) {
    let y = wanted;
    let away = 0;
    for (let tries = 0; tries < MOST_TRIES; tries += 1) {
      const hit = this.boxes.find(([left, base, width]) => x < left + width + 6 && left < x + wide + 6 && Math.abs(y - base) < HIGH);
      if (!hit) break;
      away ||= y >= hit[1] ? HIGH + 1 : -HIGH - 1;
      y = hit[1] + away;
    }
    return y;
  }
}
