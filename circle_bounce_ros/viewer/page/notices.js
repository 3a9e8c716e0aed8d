// What the page says in words: what is missing, and what the node has answered.

import { find, write } from './dom.js';

const SILENCE = 2000; // ms without a frame after which there is something to be said
const ANSWER_SHOWN = 3500; // ms
const REFUSAL_SHOWN = 9000; // ms: it has to be read

// known: connected, silentFor (ms), publishers (names of nodes; null: not known), topic, fault (what could not be read, or null).
// Returns {state, title, text}, or null when nothing is missing.
export function whatIsMissing({ connected, silentFor, publishers, topic, fault }) {
  if (!connected) {
    return { state: 'no viewer', title: 'No connection to the viewer', text: 'Is bounce_viewer running? Trying again every second.' };
  }
  if (fault) return { state: 'unreadable', title: 'What is published cannot be read', text: fault };
  if (publishers?.length > 1) {
    return {
      state: 'mixed up',
      title: 'More than one simulation',
      text: `${publishers.join(' and ')} publish ${topic}, so the picture would jump between them. End all but one, or give each a namespace or ROS_DOMAIN_ID of its own.`,
    };
  }
  if (silentFor <= SILENCE) return null;
  return {
    state: 'silent',
    title: 'Nothing is published',
    text: publishers?.length === 0
      ? `Nobody publishes ${topic}. Start the node, for example with “make run”; this page goes on by itself.`
      : `${topic} is silent. The node may be waiting for /clock, or be very busy.`,
  };
}

// The badge and the notice over the picture. `paused` is null while the node has not reported yet.
export function showState(missing, paused) {
  const usual = paused === null ? 'waiting' : paused ? 'paused' : 'running';
  write('state', missing ? missing.state : usual);
  find('state').dataset.state = missing ? 'missing' : usual;
  find('notice').hidden = !missing;
  if (missing) {
    write('notice-title', missing.title);
    write('notice-text', missing.text);
  }
}

let timer = null;

export function announce(text, isRefusal = false) {
  const answer = find('answer');
  answer.textContent = isRefusal ? `Refused: ${text}` : text;
  answer.className = isRefusal ? 'shown refused' : 'shown';
  window.clearTimeout(timer);
  timer = window.setTimeout(() => answer.classList.remove('shown'), isRefusal ? REFUSAL_SHOWN : ANSWER_SHOWN);
}
