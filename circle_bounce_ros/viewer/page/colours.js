// Colours that every kind of eye tells apart, on dark and on light.

// Chosen for the largest smallest difference to every kind of eye, the locked circles' colour included; green first,
// because the lesson's moving circle is green.
export const IDENTITY = ['#009e73', '#66ccee', '#e69f00', '#cc79a7', '#8f7ae5', '#ddcc77', '#ee99aa', '#5e4fa2'];

// Lighter in equal steps, for every kind of eye and in grey (viridis, sampled), cut at its dark end so that no circle
// sinks into the dark.
export const SPEED_RAMP = ['#3b528b', '#2f6b8e', '#26828e', '#1f988b', '#28ae80', '#4ec36b', '#84d44b', '#c2df23', '#fde725'];

export const LOOKS = {
  dark: {
    background: '#0d1419', wall: '#9fb2bf', locked: '#d55e00', text: '#e8eef2', dim: '#93a4b0', grid: '#22303a',
    before: '#6cc3f5', after: '#ffd34d', normal: '#ff8f5a', across: '#f29ac4', along: '#7fe0b4', lit: '#ffb000',
    halo: 'rgba(13,20,25,.85)', bar: '#4a90c2', curve: '#ffd34d',
  },
  light: {
    background: '#fbfcfd', wall: '#45535d', locked: '#d55e00', text: '#14202a', dim: '#566672', grid: '#e1e7eb',
    before: '#00639c', after: '#8a6100', normal: '#b34200', across: '#a03b78', along: '#00724f', lit: '#c26a00',
    halo: 'rgba(251,252,253,.85)', bar: '#5a9bc7', curve: '#a33d00',
  },
};

export function rgb(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

// 256 steps between the colours of a ramp, red, green, blue, 255.
export function table(ramp) {
  const colours = ramp.map(rgb);
  const bytes = new Uint8Array(256 * 4);
  for (let i = 0; i < 256; i += 1) {
    const at = (i / 255) * (colours.length - 1);
    const low = Math.min(Math.floor(at), colours.length - 2);
    for (let c = 0; c < 3; c += 1) {
      bytes[4 * i + c] = Math.round(255 * (colours[low][c] + (at - low) * (colours[low + 1][c] - colours[low][c])));
    }
    bytes[4 * i + 3] = 255;
  }
  return bytes;
}
