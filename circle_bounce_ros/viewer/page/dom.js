// The page's elements by their ids.

export const find = (id) => document.getElementById(id);

// Touches the document only when there is something new to say: it is asked many times a second.
export function write(id, text) {
  const element = find(id);
  if (element.textContent !== text) element.textContent = text;
}
