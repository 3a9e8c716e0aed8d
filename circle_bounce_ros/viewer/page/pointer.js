// Mouse and fingers on the picture: drag to move, wheel or two fingers to zoom, a click to choose.

import { clamp } from './camera.js';

const STILL = 4; // CSS pixels of movement that are still a click
const WHEEL = 0.0022; // of a step of zoom (logarithm) per pixel of the wheel
const MOST_WHEEL = 200; // pixels of the wheel at a time; some mice send thousands

// does: move(right, down), zoom(factor, x, y), click(x, y), fit(), all in CSS pixels from the picture's corner.
export function bindPointer(canvas, does) {
  const touches = new Map();
  let moved = 0;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };

  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    does.zoom(Math.exp(-clamp(event.deltaY, -MOST_WHEEL, MOST_WHEEL) * WHEEL), ...place(event));
  }, { passive: false });

  canvas.addEventListener('pointerdown', (event) => {
    canvas.setPointerCapture(event.pointerId);
    if (!touches.size) moved = 0;
    touches.set(event.pointerId, place(event));
  });

  canvas.addEventListener('pointermove', (event) => {
    const before = touches.get(event.pointerId);
    if (!before) return;
    const now = place(event);
    moved += Math.hypot(now[0] - before[0], now[1] - before[1]);
    const other = [...touches].find(([id]) => id !== event.pointerId)?.[1];
    if (other) pinch(before, now, other);
    else if (moved > STILL) does.move(now[0] - before[0], now[1] - before[1]);
    touches.set(event.pointerId, now);
  });

  // The point between the fingers stays between them: both what it moves by and the zoom follow from that.
  function pinch(before, now, other) {
    const gap = (at) => Math.max(1, Math.hypot(at[0] - other[0], at[1] - other[1]));
    does.move((now[0] - before[0]) / 2, (now[1] - before[1]) / 2);
    does.zoom(gap(now) / gap(before), (now[0] + other[0]) / 2, (now[1] + other[1]) / 2);
  }

  const lift = (event) => {
    const wasTouching = touches.delete(event.pointerId);
    if (wasTouching && !touches.size && moved <= STILL && event.type === 'pointerup') does.click(...place(event));
  };
  canvas.addEventListener('pointerup', lift);
  canvas.addEventListener('pointercancel', lift);
  canvas.addEventListener('dblclick', () => does.fit());
}
