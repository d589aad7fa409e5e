import { PerspectiveCamera, Quaternion, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { nearPlane_m, turningPoint } from '../src/scene/camera_rig';

// A camera at `eye` that looks at the point, as an orbit does: its upper edge is the one nearest to the vertical.
function upperEdge(eye: Vector3, point: Vector3): Vector3 {
  const camera = new PerspectiveCamera();
  camera.position.copy(eye);
  camera.lookAt(point);
  return new Vector3(0, 1, 0).applyQuaternion(camera.quaternion);
}

describe('the point that a camera turns around', () => {
  it.each([
    ['straight down', -Math.PI / 2, [0, 0, -1]],
    ['a little beyond it, as 1.5708 is', -1.5708, [0, 0, -1]],
    ['straight up', Math.PI / 2, [0, 0, 1]],
  ] as const)('keeps the upper edge of a picture that looks %s', (_name, angle, edge) => {
    const turn = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), angle);
    const eye = new Vector3(3, 14, 5);
    expect(upperEdge(eye, turningPoint(eye, turn, 10)).distanceTo(new Vector3(...edge))).toBeLessThan(0.01);
  });

  it('lies ahead', () => {
    const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), Math.PI / 2);
    expect(turningPoint(new Vector3(), turn, 4).distanceTo(new Vector3(-4, 0, 0))).toBeLessThan(1e-9);
  });
});

describe('the nearest that is drawn', () => {
  // Of 24 bits of depth: what one step is at a distance.
  const step_m = (distance_m: number, near_m: number): number => distance_m ** 2 / (near_m * 2 ** 24);

  it('lets a road of two centimetres lie on the ground, where all of a town is seen', () => {
    expect(step_m(1500, nearPlane_m(1500, 600))).toBeLessThan(0.002);
    expect(step_m(1500, 600 / 2000)).toBeGreaterThan(0.02);
  });

  it('is near inside of the world', () => {
    expect(nearPlane_m(100, 600)).toBe(0.3);
    expect(nearPlane_m(0, 5)).toBe(0.01);
  });
});
