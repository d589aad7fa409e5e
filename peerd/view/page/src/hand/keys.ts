import { type Ask, refusalIn } from 'peerd';

import type { CameraRig } from '../scene/camera_rig';

// Keys that are pressed while the picture has the focus: to the world's KeySensors, or, with Alt or by a switch, to the
// camera. Tab stays the browser's, so that nobody is caught in the picture.
export interface KeyListener {
  cameraKeys(): boolean;
  mayEdit(): boolean;
  onKey(sentence: string, done: boolean): void;
}

const kOnlyModifiers = new Set(['Shift', 'Control', 'Alt', 'Meta', 'AltGraph', 'CapsLock']);

export class Keys {
  constructor(surface: HTMLElement, private readonly rig: CameraRig, private readonly ask: Ask, private readonly listener: KeyListener) {
    surface.addEventListener('keydown', (event) => this.onDown(event));
    surface.addEventListener('keyup', (event) => this.rig.key(event, false));
    surface.addEventListener('blur', () => this.rig.releaseKeys());
  }

  private onDown(event: KeyboardEvent): void {
    if (event.key === 'Tab' || kOnlyModifiers.has(event.key) || event.isComposing) return;
    if (event.altKey || this.listener.cameraKeys()) {
      if (this.rig.key(event, true)) event.preventDefault();
      return;
    }
    if (!event.ctrlKey && !event.metaKey && !/^F\d+$/.test(event.key)) event.preventDefault(); // those stay the browser's, too
    if (!this.listener.mayEdit()) this.listener.onKey('this page is read-only: it has no token, so keys do not reach the world', false);
    else void this.send(event);
  }

  private async send(event: KeyboardEvent): Promise<void> {
    const flags = { shift: event.shiftKey, control: event.ctrlKey, meta: event.metaKey, keypad: event.location === 3 };
    const set = Object.fromEntries(Object.entries(flags).filter(([, on]) => on));
    const reply = await this.ask({ do: 'key', key: event.key, ...set });
    const refusal = refusalIn(reply);
    const named = event.key === ' ' ? 'Space' : event.key;
    if (refusal !== null) this.listener.onKey(`key ${named}: ${refusal}`, false);
    else this.listener.onKey(`key ${named}: ${recipients(reply['changes'])}`, true);
  }
}

function recipients(changes: unknown): string {
  const rows = Array.isArray(changes) ? (changes as { recipient?: string; done?: boolean; refused?: string }[]) : [];
  if (rows.length === 0) return 'taken';
  return rows.map((row) => `${row.recipient ?? '?'}${row.done === false ? ` refused: ${row.refused ?? ''}` : ' changed'}`).join(', ');
}
