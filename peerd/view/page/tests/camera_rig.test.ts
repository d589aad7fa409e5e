import { PerspectiveCamera, Quaternion, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { turningPoint } from '../src/scene/camera_rig';

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
