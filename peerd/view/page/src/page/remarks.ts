import type { LinkState, Status } from 'peerd';

import { make } from './make';

// What the page says over the picture, where that is not the world as it is now; empty: it is.
export function remarkOn(state: LinkState, silent_s: number, status: Pick<Status, 'waits_for'> | null): string {
  if (state === 'closed') return 'No connection to the peer. Trying again…';
  if (silent_s > 0) return `Nothing has come from the peer for ${silent_s} s: what is shown stands as it was then.`;
  const names = (state === 'open' ? (status?.waits_for ?? []) : []).map(({ id, name }) => (name === '' ? `peer ${id}` : name));
  return names.length === 0 ? '' : `The peer waits for ${names.join(', ')}: nothing moves until all are here.`;
}

// In the place of the picture.
export function blindNote(why: string): HTMLElement {
  return make(
    'div',
    { class: 'blind', role: 'alert' },
    make('p', {}, 'There is no picture: this browser has no WebGL here.'),
    make('p', { class: 'muted' }, why),
    make('p', {}, 'The lists, the inspector and edits work without it. A browser shows it at about:gpu (Chromium) or about:support (Firefox); by remote desktop, and in some virtual machines, it is off.'),
  );
}
