// The chooser of scenes: packaged ones by name, others by their path.

import { find } from './dom.js';
import { announce } from './notices.js';

const OWN = '…'; // the entry for a file
const FIRST = 'lesson'; // what a node shows that has not said yet what it shows

const isOwn = () => find('scene').value === OWN;

export function fillScenes(names, current = FIRST) {
  const chosen = find('scene').value;
  const packaged = names.map((name) => new Option(name.replaceAll('_', ' '), name));
  find('scene').replaceChildren(...packaged, new Option('a file …', OWN));
  find('scene').value = chosen || current;
}

// What the node shows.
export function showScene(name = FIRST) {
  const isPackaged = [...find('scene').options].some(({ value }) => value === name);
  find('scene').value = isPackaged ? name : OWN;
  find('own-field').hidden = isPackaged;
}

// `name` is what the node shows still. A path stays to be mended; a name that stayed could not be chosen again.
export function hearRefusal(name) {
  if (!isOwn()) showScene(name);
}

// load({scene, seed}): -1 for the seed of the file.
export function bindScenes(load) {
  const submit = () => {
    // The browser says which rule is broken; the viewer would take it for a stranger's message and hang up.
    if (!find('seed').reportValidity() || (isOwn() && !find('own').reportValidity())) return;
    const scene = isOwn() ? find('own').value.trim() : find('scene').value;
    const seed = find('seed').value;
    if (scene) {
      load({ scene, seed: seed === '' ? -1 : Number(seed) });
    } else {
      announce('which file? A path as the node sees it, ending in .yaml', true);
      find('own').focus();
    }
  };
  find('scene-form').addEventListener('submit', (event) => {
    event.preventDefault();
    submit();
  });
  find('scene').addEventListener('change', () => {
    find('own-field').hidden = !isOwn();
    if (isOwn()) find('own').focus();
    else submit();
  });
}
