import { icon } from './icons';
import { make } from './make';

// What the page does, for people who see it for the first time.
const kRows: readonly (readonly [string, string])[] = [
  ['Click', 'select an object; the peer itself finds what lies under the pointer'],
  ['Drag', 'Orbit: turn around the world. Fly: look around. Hand: take the object, and throw it by letting go'],
  ['Click or drag what has a sensor', 'works it, for all peers; what is in an Anchor offers its link'],
  ['Wheel', 'nearer and farther; with a held object: push and pull it'],
  ['Right drag', 'Orbit: move sideways'],
  ['Keys', 'go to the world’s KeySensors, with Shift, Control and Meta, while the picture has the focus (click it). Each repeat of a held key is another press'],
  ['Alt + W A S D Q E, Alt + arrows', 'move the camera. With Show, “Keys move the camera” they do so without Alt, and no key goes to the world'],
  ['Walk', 'an avatar, which all peers see, with this page’s camera as its eye: W A S D and the arrows walk, dragging looks around; it ends at walls and goes up steps. Another tool takes it away again'],
  ['Tab', 'goes through all controls; it never goes to the world'],
  ['Space on the time line’s button', 'pause and play on; the slider goes back up to a minute'],
];

export class Help {
  readonly element: HTMLDialogElement;

  constructor() {
    const close = make('button', { type: 'button', class: 'tool', 'aria-label': 'Close', click: () => this.element.close() }, icon('close'));
    const rows = kRows.flatMap(([term, meaning]) => [make('dt', {}, term), make('dd', {}, meaning)]);
    this.element = make(
      'dialog',
      { class: 'help', 'aria-label': 'Help' },
      make('header', {}, make('h2', {}, 'This page'), close),
      make('p', {}, 'It shows the shared world as one peer has it: its own objects as they are, those of other peers as it predicts them. Time is the session’s.'),
      make('dl', {}, ...rows),
      make('p', { class: 'muted' }, 'Own objects are red, those of other peers cyan, what nobody owns grey: in lists always, in the picture with “Colours by owner”.'),
    );
  }

  open(): void {
    this.element.showModal();
  }
}
