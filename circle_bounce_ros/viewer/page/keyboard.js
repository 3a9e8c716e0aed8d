// One key for everything that a button does.

export class Keyboard {
  // keys: {key: [what it does in words, function, name of the key to be shown]}
  constructor(keys) {
    this.keys = keys;
    this.isOn = true;
    window.addEventListener('keydown', (event) => this.press(event));
  }

  press(event) {
    if (!this.isOn || event.ctrlKey || event.altKey || event.metaKey || document.querySelector('dialog[open]')) return;
    const { target } = event;
    const writes = target.matches('input[type="text"], input[type="number"], textarea');
    // What these do with the key by themselves comes first.
    const takes = (target.matches('button, summary, a') && [' ', 'Enter'].includes(event.key))
      || (target.matches('input[type="checkbox"]') && event.key === ' ')
      || (target.matches('select') && event.key !== 'Escape')
      || (target.matches('input[type="range"], input[type="radio"]') && (event.key.startsWith('Arrow') || event.key === ' '));
    const found = this.keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (writes || takes || !found) return;
    event.preventDefault();
    found[1]();
  }

  list(into) {
    const lines = new Map();
    for (const [key, [words, , shown]] of Object.entries(this.keys)) {
      lines.set(words, [...(lines.get(words) ?? []), shown ?? key.toUpperCase()]);
    }
    for (const [words, keys] of lines) {
      const line = document.createElement('div');
      const term = document.createElement('dt');
      for (const key of keys) term.append(Object.assign(document.createElement('kbd'), { textContent: key }), ' ');
      line.append(term, Object.assign(document.createElement('dd'), { textContent: words }));
      into.append(line);
    }
  }
}
