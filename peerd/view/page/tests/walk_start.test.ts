import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { walkStart } from '../src/hand/walk_start';

// A floor at 0 with a table on it, 0.8 m high and 2 m long each way around the middle.
const below = (place: Vector3): Promise<Vector3> => Promise.resolve(new Vector3(place.x, Math.abs(place.x) < 1 && Math.abs(place.z) < 1 ? 0.8 : 0, place.z));

describe('a walk', () => {
  const eye = new Vector3(0, 3, 6);

  it('begins on the ground before a table', async () => {
    const start = await walkStart(new Vector3(0, 0.8, 0), eye, 0.5, below);
    expect(start.y).toBe(0);
    expect(start.z).toBeGreaterThan(1);
    expect(start.z).toBeLessThan(2.5);
  });

  it('begins on the ground that is met', async () => {
    expect(await walkStart(new Vector3(3, 0, 0), eye, 0.5, below)).toEqual(new Vector3(3, 0, 0));
  });

  it('begins on a roof that has no edge near', async () => {
    const roof = (place: Vector3): Promise<Vector3> => Promise.resolve(new Vector3(place.x, 5, place.z));
    expect((await walkStart(new Vector3(0, 5, 0), eye, 0.5, roof)).y).toBe(5);
  });

  it('begins where it is met where nothing is below', async () => {
    expect(await walkStart(new Vector3(0, 1, 0), eye, 0.5, () => Promise.resolve(null))).toEqual(new Vector3(0, 1, 0));
  });
});
