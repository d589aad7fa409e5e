import { describe, expect, it } from 'vitest';

import { HandMotion } from '../src/hand/hand_motion';

describe('the velocity of a hand', () => {
  it('is the slope of its last tenth of a second', () => {
    const motion = new HandMotion();
    for (let i = 0; i <= 30; ++i) motion.add(i / 60, [3 * (i / 60), -1, 0.5 - 2 * (i / 60)]);
    const [x, y, z] = motion.velocityAt(0.5);
    expect(x).toBeCloseTo(3, 9);
    expect(y).toBeCloseTo(0, 9);
    expect(z).toBeCloseTo(-2, 9);
  });

  it('is none of a hand that has rested, or has only just begun', () => {
    const motion = new HandMotion();
    expect(motion.velocityAt(0)).toEqual([0, 0, 0]);
    motion.add(0, [0, 0, 0]);
    motion.add(0.001, [1, 0, 0]);
    expect(motion.velocityAt(0.001)).toEqual([0, 0, 0]);
    expect(motion.velocityAt(0.5)).toEqual([0, 0, 0]);
  });

  it('does not depend on one uneven sample', () => {
    const motion = new HandMotion();
    for (const at_s of [0, 0.016, 0.021, 0.05, 0.066, 0.083, 0.1]) motion.add(at_s, [2 * at_s, 0, 0]);
    expect(motion.velocityAt(0.1)[0]).toBeCloseTo(2, 9);
  });
});
