import { describe, expect, it } from 'vitest';

import { HandMotion } from '../src/hand/hand_motion';

describe('the velocity of a hand', () => {
  it('is the slope of its last tenth of a second', () => {
    const motion = new HandMotion();
    for (let i = 0; i <= 20; ++i) motion.add(i / 60, [0, 9, 0]);
    for (let i = 21; i <= 40; ++i) motion.add(i / 60, [3 * (i / 60), -1, 0.5 - 2 * (i / 60)]);
    const [x, y, z] = motion.velocityAt(40 / 60);
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
    for (let i = 1; i <= 20; ++i) motion.add(i / 60, [i, 0, 0]);
    expect(motion.velocityAt(20 / 60)[0]).toBeCloseTo(60, 6);
    expect(motion.velocityAt(20 / 60 + 0.11)).toEqual([0, 0, 0]);
  });

  it('does not depend on how evenly its places come', () => {
    const motion = new HandMotion();
    for (const at_s of [0, 0.016, 0.021, 0.05, 0.066, 0.083, 0.1]) motion.add(at_s, [2 * at_s, 0, 0]);
    expect(motion.velocityAt(0.1)[0]).toBeCloseTo(2, 9);
  });

  it('is known on a page that is drawn four times a second', () => {
    const motion = new HandMotion();
    for (let i = 0; i < 6; ++i) motion.add(i * 0.25, [0, 0.5 * i, 0]);
    expect(motion.velocityAt(1.4)[1]).toBeCloseTo(2, 9);
    expect(motion.velocityAt(2.5)).toEqual([0, 0, 0]);
  });
});
