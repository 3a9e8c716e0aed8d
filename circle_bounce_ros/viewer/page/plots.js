// Two small plots: how speeds are spread, and what total energy does.

const BINS = 28;
const ENOUGH = 20; // circles that make a histogram worth drawing
const KEPT = 120; // s of energy

function prepare(canvas) {
  const ratio = Math.min(2, window.devicePixelRatio || 1);
  const { clientWidth: width, clientHeight: height } = canvas;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const c = canvas.getContext('2d');
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, width, height);
  c.font = '11px system-ui, sans-serif';
  return { c, width, height };
}

// Returns what is to be said about it.
export function drawSpeeds(canvas, speeds, look) {
  const { c, width, height } = prepare(canvas);
  if (speeds.length < ENOUGH) {
    c.fillStyle = look.dim;
    c.textAlign = 'center';
    c.fillText(`from ${ENOUGH} moving circles on`, width / 2, height / 2);
    return 'With few circles there is no distribution to speak of.';
  }
  const square = speeds.reduce((sum, v) => sum + v * v, 0) / speeds.length;
  const sigma = Math.sqrt(square / 2);
  const most = Math.max(4 * sigma, 1e-12);
  const counts = new Array(BINS).fill(0);
  for (const v of speeds) counts[Math.min(BINS - 1, Math.floor((v / most) * BINS))] += 1;
  const density = counts.map((count) => (count / speeds.length) * (BINS / most));
  const maxwell = (v) => (v / (sigma * sigma)) * Math.exp((-v * v) / (2 * sigma * sigma));
  const highest = Math.max(...density, maxwell(sigma)) * 1.08;
  const base = height - 16;
  const wide = (width - 4) / BINS;
  c.fillStyle = look.bar;
  density.forEach((value, i) => {
    const high = (value / highest) * (base - 4);
    c.fillRect(2 + i * wide, base - high, Math.max(1, wide - 1), high);
  });
  c.strokeStyle = look.curve;
  c.lineWidth = 2;
  c.beginPath();
  for (let px = 0; px <= width - 4; px += 2) {
    const y = base - (maxwell((px / (width - 4)) * most) / highest) * (base - 4);
    if (px) c.lineTo(2 + px, y);
    else c.moveTo(2 + px, y);
  }
  c.stroke();
  axis(c, look, base, width, ['0', `${(most / 2).toPrecision(2)}`, `${most.toPrecision(2)} m/s`]);
  return `Bars: ${speeds.length.toLocaleString('en')} circles. Curve: Maxwell’s law for equal masses with the same mean energy (σ = ${sigma.toPrecision(3)} m/s).`;
}

function axis(c, look, base, width, texts) {
  c.strokeStyle = look.dim;
  c.lineWidth = 1;
  c.beginPath();
  c.moveTo(2, base + 0.5);
  c.lineTo(width - 2, base + 0.5);
  c.stroke();
  c.fillStyle = look.dim;
  texts.forEach((text, i) => {
    c.textAlign = ['left', 'center', 'right'][i];
    c.fillText(text, [2, width / 2, width - 2][i], base + 13);
  });
}

export class EnergyPlot {
  constructor(canvas) {
    this.canvas = canvas;
    this.samples = []; // {time (s), error}
  }

  forget() {
    this.samples = [];
  }

  add(time, error) {
    if (!Number.isFinite(error)) return;
    this.samples.push({ time, error });
    while (this.samples.length && time - this.samples[0].time > KEPT) this.samples.shift();
  }

  draw(look) {
    const { c, width, height } = prepare(this.canvas);
    const base = height - 16;
    const { samples } = this;
    const newest = samples.length ? samples[samples.length - 1].time : 0;
    // Whatever is below one part in 10^12 is drawn as the straight line that it is to any eye.
    const worst = Math.max(1e-12, ...samples.map(({ error }) => Math.abs(error)));
    const decade = 10 ** Math.ceil(Math.log10(worst * 1.000001));
    const x = (time) => width - 2 - ((newest - time) / KEPT) * (width - 4);
    const y = (error) => 14 + (base - 18) / 2 - (error / decade) * ((base - 24) / 2);
    c.strokeStyle = look.grid;
    c.lineWidth = 1;
    for (const level of [-decade, 0, decade]) {
      c.beginPath();
      c.moveTo(2, Math.round(y(level)) + 0.5);
      c.lineTo(width - 2, Math.round(y(level)) + 0.5);
      c.stroke();
    }
    c.fillStyle = look.dim;
    c.textAlign = 'left';
    const power = Math.round(Math.log10(decade));
    c.fillText(`E₀ + 10${raised(power)} E₀`, 4, y(decade) - 3);
    c.fillText('E₀', 4, y(0) - 3);
    c.strokeStyle = look.curve;
    c.lineWidth = 2;
    c.beginPath();
    samples.forEach(({ time, error }, i) => (i ? c.lineTo(x(time), y(error)) : c.moveTo(x(time), y(error))));
    c.stroke();
    axis(c, look, base, width, [`${KEPT} s ago`, '', 'now']);
    if (!samples.length) return 'Waiting for the node’s report on /diagnostics.';
    return `Total kinetic energy against its first value E₀: within ${worst <= 1e-12 ? '1 part in 10¹²' : `1 part in 10${raised(-power)}`} so far.`;
  }
}

export function raised(number) {
  return String(number).replace(/[-\d]/g, (d) => '⁻⁰¹²³⁴⁵⁶⁷⁸⁹'['-0123456789'.indexOf(d)]);
}
