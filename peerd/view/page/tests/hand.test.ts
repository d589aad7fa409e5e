import { PerspectiveCamera, Ray, Vector3 } from 'three';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import type { Outcome } from 'peerd';

import { Hand } from '../src/hand/hand';
import type { PeerLink } from '../src/live/peer_link';
import type { SceneView } from '../src/scene/scene_view';

type Request = Record<string, unknown>;

// A hand before a camera at z = 10 that looks along -z: a pointer at (x, y) is at that place of the plane z = 0.
class Table {
  readonly asked: Request[] = [];
  readonly said: string[] = [];
  refusals = 0; // how many poses the daemon refuses before it takes one
  stays = false; // what is let go hangs where it is
  give: (outcome: Outcome) => void = () => undefined;
  readonly hand: Hand;

  constructor() {
    const camera = new PerspectiveCamera();
    camera.position.z = 10;
    const ray = (x: number, y: number): Ray => new Ray(camera.position, new Vector3(x, y, -10).normalize());
    const given = new Promise<Outcome>((give) => (this.give = give));
    const edit = (request: Request): Promise<Outcome> => {
      this.asked.push(request);
      return request['do'] === 'grab' ? given : Promise.resolve({ done: true, sentence: 'done' });
    };
    const ask = (request: Request): Promise<unknown> => {
      this.asked.push(request);
      if (request['do'] === 'let_go') return Promise.resolve({ ok: true, done: true, stays: this.stays });
      return Promise.resolve(this.refusals-- > 0 ? { ok: true, refused: [{ why: 'not yours yet' }] } : { ok: true, taken: 1 });
    };
    const link = { edit, ask, connection: { congested: false } } as unknown as PeerLink;
    this.hand = new Hand({ ray, rig: { camera } } as unknown as SceneView, link, { onHolds: () => undefined, onRefused: (sentence) => this.said.push(sentence), onStays: (path) => this.said.push(`${path} stays`) });
    void this.hand.take({ node: 1, path: 'BALL', position_m: [0, 0, 0] } as never, new Vector3());
  }
  // Two metres a second along x, a place each 10 ms.
  sweep(): void {
    for (let i = 0; i <= 10; ++i) this.hand.moveTo(0.02 * i, 0, 0.01 * i);
  }
  get poses(): Request[] {
    return this.asked.filter((request) => request['do'] === 'pose');
  }
  get names(): unknown[] {
    return this.asked.map((request) => request['do']);
  }
}

describe('a hand', () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());

  it('throws with the velocity of the instant at which the pointer went up, however late the page hears of it', async () => {
    const table = new Table();
    table.give({ done: true, sentence: '' });
    await vi.runAllTimersAsync();
    table.sweep();
    table.hand.release(0.105);
    await vi.runAllTimersAsync();
    expect(table.names).toEqual(['grab', 'pose', 'let_go']);
    expect((table.poses[0]['velocity_m_s'] as number[])[0]).toBeCloseTo(2, 9);
    expect(table.hand.path).toBeNull();
  });

  it('throws what it was given only after the pointer went up', async () => {
    const table = new Table();
    table.sweep();
    table.hand.release(0.105);
    await vi.runAllTimersAsync();
    expect(table.names).toEqual(['grab']);
    table.give({ done: true, sentence: '' });
    await vi.runAllTimersAsync();
    expect(table.names).toEqual(['grab', 'pose', 'let_go']);
    expect((table.poses[0]['velocity_m_s'] as number[])[0]).toBeCloseTo(2, 9);
  });

  it('says the last pose until it is taken, and why where it never is', async () => {
    const early = new Table();
    early.refusals = 3;
    early.give({ done: true, sentence: '' });
    await vi.runAllTimersAsync();
    early.hand.release(0);
    await vi.runAllTimersAsync();
    expect(early.names).toEqual(['grab', 'pose', 'pose', 'pose', 'pose', 'let_go']);
    expect(early.said).toEqual([]);

    const never = new Table();
    never.refusals = Infinity;
    never.give({ done: true, sentence: '' });
    await vi.runAllTimersAsync();
    never.hand.release(0);
    await vi.runAllTimersAsync();
    expect(never.names).not.toContain('let_go');
    expect(never.said).toEqual(['pose BALL: not yours yet']);
    expect(never.hand.path).toBeNull();
  });

  it('says that what it lets go stays in the air, where nothing pulls it down', async () => {
    const table = new Table();
    table.stays = true;
    table.give({ done: true, sentence: '' });
    await vi.runAllTimersAsync();
    table.hand.release(0);
    await vi.runAllTimersAsync();
    expect(table.said).toEqual(['BALL stays']);
  });

  it('holds nothing that it was refused', async () => {
    const table = new Table();
    table.give({ done: false, sentence: 'grab BALL: it is fixed' });
    await vi.runAllTimersAsync();
    expect(table.said).toEqual(['grab BALL: it is fixed']);
    expect(table.hand.path).toBeNull();
  });
});
