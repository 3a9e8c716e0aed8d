// What buttons, switches and keys do.

import { find } from './dom.js';
import { Keyboard } from './keyboard.js';
import { SPEEDS } from './playback.js';
import { bindPointer } from './pointer.js';
import { bindScenes, hearRefusal } from './scenes.js';

const ZOOM = 1.3; // of a button or a key
const MOVE = 60; // CSS pixels, of an arrow key

const flip = (id) => () => {
  find(id).checked = !find(id).checked;
  find(id).dispatchEvent(new Event('change'));
};

export function bindControls(app) {
  const { looks, node, playback, view } = app;
  const help = () => (find('keys').open ? find('keys').close() : find('keys').showModal());

  bindPointer(find('bodies'), {
    move: (right, down) => view.move(right, down),
    zoom: (factor, x, y) => view.zoom(factor, x, y),
    click: (x, y) => app.selectAt(x, y),
    fit: () => view.fit(),
  });

  const clicks = {
    pause: () => node.pause(),
    step: () => node.step(),
    reset: () => node.reset(),
    theme: () => looks.switchTheme(),
    help,
    fit: () => view.fit(),
    'zoom-in': () => view.zoom(ZOOM),
    'zoom-out': () => view.zoom(1 / ZOOM),
    previous: () => app.selectNext(-1),
    next: () => app.selectNext(1),
    deselect: () => app.select(-1),
  };
  for (const [id, does] of Object.entries(clicks)) find(id).addEventListener('click', does);

  find('speed').max = String(SPEEDS.length - 1);
  find('speed').addEventListener('input', () => playback.choose(Number(find('speed').value)));
  find('trails').addEventListener('input', () => looks.setTrail(Number(find('trails').value)));
  find('slow').addEventListener('change', () => find('slow').checked && app.selectAny());
  find('follow').addEventListener('change', () => app.followSelected(find('follow').checked));
  find('squares').addEventListener('change', () => { app.isDirty = true; });
  for (const radio of document.querySelectorAll('input[name="colour"]')) {
    radio.addEventListener('change', () => looks.chooseColours(radio.value));
  }
  bindScenes(({ scene, seed }) => {
    looks.choice = null;
    playback.endSlow();
    if (!node.ask({ type: 'scene', scene, seed })) hearRefusal(node.values.scene);
  });

  const keyboard = new Keyboard({
    ' ': ['Stop and go on', clicks.pause, 'Space'],
    '.': ['While paused: one period further', clicks.step],
    r: ['From the first instant', clicks.reset],
    '[': ['Slower', () => playback.change(-1)],
    ']': ['Faster', () => playback.change(1)],
    s: ['Choose a scene', () => find('scene').focus()],
    k: ['Next circle', clicks.next],
    j: ['Previous circle', clicks.previous],
    Escape: ['No circle', clicks.deselect, 'Esc'],
    m: ['Slow motion into a contact', flip('slow')],
    z: ['Follow the selected circle', flip('follow')],
    b: ['Bounding squares', flip('squares')],
    t: ['Trails: longer, then off', () => looks.nextTrail()],
    c: ['Colours by speed or by circle', () => looks.switchColours()],
    d: ['Dark or light', clicks.theme],
    f: ['All of the scene', clicks.fit],
    '+': ['Closer', clicks['zoom-in']],
    '=': ['Closer', clicks['zoom-in'], '='],
    '-': ['Further away', clicks['zoom-out'], '−'],
    ArrowLeft: ['Move the view', () => view.move(MOVE, 0), '←'],
    ArrowRight: ['Move the view', () => view.move(-MOVE, 0), '→'],
    ArrowUp: ['Move the view', () => view.move(0, MOVE), '↑'],
    ArrowDown: ['Move the view', () => view.move(0, -MOVE), '↓'],
    '?': ['These keys', help],
  });
  keyboard.list(find('key-list'));
  find('keys-on').addEventListener('change', () => { keyboard.isOn = find('keys-on').checked; });
}
