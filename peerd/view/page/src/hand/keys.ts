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
  private readonly held = new Map<string, string>(); // the name that a key had when it went down, by its place on the keyboard

  constructor(surface: HTMLElement, private readonly rig: CameraRig, private readonly ask: Ask, private readonly listener: KeyListener) {
    surface.addEventListener('keydown', (event) => this.onDown(event));
    surface.addEventListener('keyup', (event) => this.onUp(event));
    surface.addEventListener('blur', () => this.releaseAll());
  }

  private onDown(event: KeyboardEvent): void {
    if (event.key === 'Tab' || kOnlyModifiers.has(event.key) || event.isComposing) return;
    if (event.altKey || this.listener.cameraKeys()) {
      if (this.rig.key(event, true)) event.preventDefault();
      return;
    }
    if (!event.ctrlKey && !event.metaKey && !/^F\d+$/.test(event.key)) event.preventDefault(); // those stay the browser's, too
    if (!this.listener.mayEdit()) this.listener.onKey('this page is read-only: it has no token, so keys do not reach the world', false);
    else {
      this.held.set(event.code, event.key);
      void this.send(event);
    }
  }

  private onUp(event: KeyboardEvent): void {
    this.rig.key(event, false);
    const key = this.held.get(event.code);
    if (key === undefined) return;
    this.held.delete(event.code);
    void this.release(key);
  }

  // Who holds a key while the picture loses the focus would hold it for ever.
  private releaseAll(): void {
    this.rig.releaseKeys();
    for (const key of this.held.values()) void this.release(key);
    this.held.clear();
  }

  // Most keys are for their presses alone, so only what has happened is said.
  private async release(key: string): Promise<void> {
    const reply = await this.ask({ do: 'key', key, release: true });
    const changes = reply['changes'];
    if (Array.isArray(changes) && changes.length > 0) this.listener.onKey(`key ${key} up: ${recipients(changes)}`, refusalIn(reply) === null);
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
