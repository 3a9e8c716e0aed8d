// The words and numbers beside the picture.

import { find, write } from './dom.js';
import { KINDS, dot, length, showDegrees, signed } from './lesson.js';
import { metres } from './overlay.js';
import { raised } from './plots.js';

const PAUSE_ICON = 'M3 2h4v12H3zM9 2h4v12H9z';
const GO_ON_ICON = 'M4 2l10 6-10 6z';

const speed = (value) => `${value.toFixed(3)} m/s`;
const part = (value) => signed(value, 2);

export function showTime(seconds) {
  if (seconds === null) return 'not known';
  const whole = Math.floor(seconds);
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const pad = (value) => String(value).padStart(2, '0');
  return `${h ? `${h}:` : ''}${pad(m)}:${pad(s)}.${String(Math.floor((seconds - whole) * 1000)).padStart(3, '0')}`;
}

// What the node reports on /diagnostics.
export function showReport({ values, message, warns }, paused) {
  const factor = Number(values['real-time factor']);
  write('n-factor', Number.isFinite(factor) ? `${factor.toFixed(2)} ×` : 'measuring');
  write('n-contacts', Math.round(Number(values['contacts/s'])).toLocaleString('en'));
  write('n-energy', power(Number(values['energy error'])));
  find('pause').querySelector('span').textContent = paused ? 'Go on' : 'Pause';
  find('pause-icon').setAttribute('d', paused ? GO_ON_ICON : PAUSE_ICON);
  write('warning', warns ? `The node warns: ${message}` : '');
  find('warning').hidden = !warns;
}

function power(value) {
  if (value === 0) return '0';
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  return `${value < 0 ? '−' : ''}${(Math.abs(value) / 10 ** exponent).toFixed(1)} · 10${raised(exponent)}`;
}

export function showApproach({ now, next, circle }) {
  find('lesson').hidden = !now;
  find('lesson-hint').hidden = Boolean(now);
  write('selected', circle < 0 ? 'no circle selected' : `circle ${circle}${now ? '' : ' is not there'}`);
  if (!now) return;
  if (!next) {
    for (const id of ['gap-partner', 'gap-d', 'gap-sum', 'gap-time']) write(id, '–');
    return;
  }
  write('gap-name', next.time < Infinity ? 'touches next' : 'nearest');
  write('gap-partner', next.name);
  write('gap-d', metres(next.distance));
  write('gap-sum-name', next.radius ? 'r₁ + r₂' : 'r');
  write('gap-sum', metres(next.sum));
  write('gap-time', next.time < Infinity ? `${next.time.toFixed(2)} s` : 'never');
  const whole = Math.max(next.sum * 3, next.distance);
  find('gap-reach').style.width = `${(100 * next.sum) / whole}%`;
  find('gap-distance').style.left = `${(100 * next.distance) / whole}%`;
}

export function showContact(last) {
  const dashes = ['a-v', 'a-n', 'a-d', 'a-pc', 's-before', 's-after', 'p-across', 'p-along'];
  if (!last) {
    for (const id of dashes) write(id, '–');
    write('contact-when', '');
    for (const id of ['note-locked', 'note-free']) find(id).hidden = true;
    return;
  }
  const { angles, before, after, before_parts: bp, after_parts: ap, normal } = last;
  write('contact-when', `${KINDS[last.kind]} ${last.partner}, at ${last.time.toFixed(3)} s`);
  write('a-v', showDegrees(angles.v));
  write('a-n', showDegrees(angles.n));
  write('a-d', showDegrees(angles.d));
  write('a-pc', last.isLocked ? showDegrees(angles.pc) : '–');
  write('s-before', speed(length(before)));
  write('s-after', speed(length(after)));
  const side = [-normal[1], normal[0]];
  write('p-across', `${part(dot(bp.across, normal))} → ${part(dot(ap.across, normal))} m/s`);
  write('p-along', `${part(dot(bp.along, side))} → ${part(dot(ap.along, side))} m/s`);
  find('note-locked').hidden = !last.isLocked;
  find('note-free').hidden = last.isLocked;
}

export function showSquares(corners) {
  const say = find('squares-say');
  if (!corners) {
    say.hidden = true;
    return;
  }
  say.hidden = false;
  const first = corners.pairs[0];
  write('squares-say', first
    ? `Squares overlap, circles do not touch: D = ${metres(first.distance)} > ${metres(first.sum)}${corners.pairs.length > 1 ? ` (and ${corners.pairs.length - 1} more)` : ''}.`
    : 'No squares overlap unless their circles touch.');
  say.classList.toggle('lit', Boolean(first));
}

// For those who do not see the picture.
export function describeScene(canvas, { count, locked, walls, scene }, { circle, now }, { values, paused }) {
  const own = now ? ` Circle ${circle} is selected, at ${now.x.toFixed(2)}, ${now.y.toFixed(2)} m.` : '';
  canvas.setAttribute('aria-label', `Scene ${values.scene ?? scene}: ${count} moving and ${locked.length} locked circles, `
    + `${walls.length} walls, ${paused ? 'paused' : 'running'}.${own} Arrow keys move the view, plus and minus zoom.`);
}
