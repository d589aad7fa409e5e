import { Euler, Quaternion, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { fallsIn, headingOf, sizesOf, smallerAngle_rad } from '../src/hand/avatar';

describe('an avatar', () => {
  it('has the sizes of NavigationInfo, and the standard ones where that says none', () => {
    expect(sizesOf({})).toEqual({ radius_m: 0.25, height_m: 1.6, step_m: 0.75 });
    expect(sizesOf({ navigation: { avatar_size: [1, 2] } })).toEqual({ radius_m: 1, height_m: 2, step_m: 0.75 });
  });

  it('flies where the first type that says how one moves is FLY', () => {
    expect(fallsIn({})).toBe(true);
    expect(fallsIn({ navigation: { type: ['EXAMINE', 'ANY'] } })).toBe(true);
    expect(fallsIn({ navigation: { type: ['EXAMINE', 'FLY', 'WALK'] } })).toBe(false);
    expect(fallsIn({ navigation: { type: 'FLY' } })).toBe(false);
  });

  it('turns with the camera about the vertical alone', () => {
    const turn = new Quaternion().setFromEuler(new Euler(-0.8, 1.1, 0, 'YXZ'));
    const ahead = new Vector3(0, 0, -1).applyQuaternion(headingOf(turn));
    expect(ahead.y).toBeCloseTo(0, 12);
    expect(Math.atan2(-ahead.x, -ahead.z)).toBeCloseTo(1.1, 12);
  });

  it('sees by the smaller of the two angles', () => {
    expect(smallerAngle_rad({ fov: 90, aspect: 2 })).toBeCloseTo(Math.PI / 2, 12);
    expect(smallerAngle_rad({ fov: 90, aspect: 0.5 })).toBeCloseTo(2 * Math.atan(0.5), 12);
  });
});
