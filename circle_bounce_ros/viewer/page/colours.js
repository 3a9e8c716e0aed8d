// Colours that every kind of eye tells apart, on dark and on light.

// Of Okabe and Ito; bluish green first, because the lesson's moving circle is green.
export const IDENTITY = ['#009e73', '#56b4e9', '#e69f00', '#cc79a7', '#0072b2', '#b8b032', '#8f7ae5', '#a0705a'];

// Equal steps of it look equally far apart (cividis, sampled), cut at its dark end so that no circle sinks into the dark.
const RAMP = ['#2f5fa8', '#4a6b9c', '#66788a', '#7e8584', '#96937c', '#b3a36c', '#d0b555', '#ecc93c', '#ffe945'];

export const SPEED_RAMP = RAMP;

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
