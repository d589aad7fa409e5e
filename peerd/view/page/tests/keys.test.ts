import type { Reply } from 'peerd';
import { describe, expect, it } from 'vitest';

import { Keys } from '../src/hand/keys';
import type { CameraRig } from '../src/scene/camera_rig';

type Request = Record<string, unknown>;

// A picture that hears what a test does with the keyboard.
class Keyboard {
  readonly asked: Request[] = [];
  readonly said: string[] = [];
  mayEdit = true;
  private readonly listeners = new Map<string, (event: unknown) => void>();

  constructor() {
    const surface = { addEventListener: (kind: string, hear: (event: unknown) => void) => this.listeners.set(kind, hear) } as unknown as HTMLElement;
    const rig = { key: () => false, releaseKeys: () => undefined } as unknown as CameraRig;
    const ask = (request: Request): Promise<Reply> => {
      this.asked.push(request);
      return Promise.resolve({ ok: true, done: true, changes: [{ recipient: 'CAR', done: true }] });
    };
    new Keys(surface, rig, ask, { cameraKeys: () => false, mayEdit: () => this.mayEdit, onKey: (sentence) => this.said.push(sentence) });
  }
  does(kind: 'keydown' | 'keyup' | 'blur', key = '', code = key): void {
    this.listeners.get(kind)?.({ key, code, preventDefault: () => undefined });
  }
}

describe('keys', () => {
  it('go down and up', async () => {
    const keyboard = new Keyboard();
    keyboard.does('keydown', 'ArrowUp');
    keyboard.does('keyup', 'ArrowUp');
    await Promise.resolve();
    expect(keyboard.asked).toEqual([{ do: 'key', key: 'ArrowUp' }, { do: 'key', key: 'ArrowUp', release: true }]);
  });

  it('go up by the name that they had when they went down', () => {
    const keyboard = new Keyboard();
    keyboard.does('keydown', 'A', 'KeyA');
    keyboard.does('keyup', 'a', 'KeyA'); // Shift went up before
    expect(keyboard.asked[1]).toEqual({ do: 'key', key: 'A', release: true });
  });

  it('go up where the picture loses the focus, each once', () => {
    const keyboard = new Keyboard();
    keyboard.does('keydown', 'w', 'KeyW');
    keyboard.does('blur');
    keyboard.does('keyup', 'w', 'KeyW');
    expect(keyboard.asked.filter((request) => request['release'] === true)).toHaveLength(1);
  });

  it('do not go up where they never went down to the world', () => {
    const keyboard = new Keyboard();
    keyboard.mayEdit = false;
    keyboard.does('keydown', 'w', 'KeyW');
    keyboard.does('keyup', 'w', 'KeyW');
    expect(keyboard.asked).toEqual([]);
  });
});
