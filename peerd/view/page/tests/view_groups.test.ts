import { Matrix4, PerspectiveCamera, Quaternion, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { RigidFrames } from '../src/scene/rigid_frames';
import { billboardTurn, levelAt, ViewGroups, type GroupExtras } from '../src/scene/view_groups';

const kStand = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
const at = (x: number, y: number, z: number): number[] => [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z];

function cameraAt(x: number, y: number, z: number): PerspectiveCamera {
  const camera = new PerspectiveCamera();
  camera.position.set(x, y, z);
  camera.updateMatrixWorld();
  return camera;
}

function standing(): RigidFrames {
  const frames = new RigidFrames(1);
  frames.stand(0);
  return frames;
}

describe('levelAt', () => {
  it.each([
    ['before the first range', 4.9, [5, 10], 3, 0],
    ['a range belongs to the farther level', 5, [5, 10], 3, 1],
    ['behind the last range', 100, [5, 10], 3, 2],
    ['fewer levels than ranges', 100, [5, 10], 2, 1],
    ['without ranges the first', 100, [], 3, 0],
  ] as const)('%s', (_name, distance, ranges, count, level) => expect(levelAt(distance, ranges, count)).toBe(level));
});

it('the level of an LOD goes by the distance from its centre, in its own frame', () => {
  const level = (number: number): GroupExtras => ({ kind: 'level', path: 'L', node: 0, node_from_group: [2, 0, 0, 10, 0, 2, 0, 0, 0, 0, 2, 0], number, count: 2, center: [1, 0, 0], range: [3] });
  const groups = new ViewGroups([level(0), level(1)]);
  // The centre is at x = 12 of the world, and a metre of the LOD's is two of the world's.
  groups.update(standing(), cameraAt(17.9, 0, 0));
  expect([...groups.visible]).toEqual([1, 0]);
  groups.update(standing(), cameraAt(18.1, 0, 0));
  expect([...groups.visible]).toEqual([0, 1]);
});

it('what is below a hidden level is hidden', () => {
  const level = (number: number): GroupExtras => ({ kind: 'level', path: 'L', node: 0, node_from_group: kStand, number, count: 2, center: [0, 0, 0], range: [3] });
  const groups = new ViewGroups([level(0), level(1), { kind: 'anchor', path: 'L/A', node: 0, node_from_group: kStand, above: 0 }]);
  groups.update(standing(), cameraAt(0, 0, 5));
  expect([...groups.visible]).toEqual([0, 1, 0]);
  groups.update(standing(), cameraAt(0, 0, 2));
  expect([...groups.visible]).toEqual([1, 0, 1]);
});

describe('billboardTurn', () => {
  const turned = (axis: Vector3, eye: Vector3, up = new Vector3(0, 1, 0)): Vector3 => new Vector3(0, 0, 1).applyMatrix4(billboardTurn(axis, eye, up, new Matrix4()));

  it('brings +Z into the plane of the axis and the eye', () => {
    const z = turned(new Vector3(0, 1, 0), new Vector3(3, 8, 0));
    expect(z.distanceTo(new Vector3(1, 0, 0))).toBeLessThan(1e-12);
  });
  it('turns by half where the eye is behind', () => {
    expect(turned(new Vector3(0, 1, 0), new Vector3(0, 0, -4)).distanceTo(new Vector3(0, 0, -1))).toBeLessThan(1e-12);
  });
  it('stands where the eye is on the axis', () => {
    expect(turned(new Vector3(0, 1, 0), new Vector3(0, 4, 0)).distanceTo(new Vector3(0, 0, 1))).toBeLessThan(1e-12);
  });
  it('without an axis looks at the eye, upright in the picture', () => {
    const eye = new Vector3(2, 3, -1);
    const turn = billboardTurn(new Vector3(), eye, new Vector3(0, 1, 0), new Matrix4());
    expect(new Vector3(0, 0, 1).applyMatrix4(turn).distanceTo(eye.clone().normalize())).toBeLessThan(1e-12);
    expect(new Vector3(1, 0, 0).applyMatrix4(turn).y).toBeCloseTo(0, 12);
    expect(turn.determinant()).toBeCloseTo(1, 12);
  });
});

it('a Billboard on a turned, moved node faces the camera in the world, also within another one', () => {
  const frames = new RigidFrames(1);
  const q = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), 0.7);
  frames.placeAsFiled([{ index: 0, id: '', path: '', def: '', owner: 0, pose: new Float64Array([5, 0, -2, q.x, q.y, q.z, q.w]) }]);
  const groups = new ViewGroups([
    { kind: 'billboard', path: 'B', node: 0, node_from_group: at(1, 0, 0), axis: [0, 1, 0] },
    { kind: 'billboard', path: 'B/C', node: 0, node_from_group: at(1, 2, 0), above: 0, axis: [0, 1, 0] },
  ]);
  const camera = cameraAt(-3, 1, 9);
  groups.update(frames, camera);
  for (const [i, local] of [[0, at(1, 0, 0)], [1, at(1, 2, 0)]] as const) {
    const world = frames.matrix(0, new Matrix4()).multiply(new Matrix4().fromArray(groups.turns, i * 16)).multiply(new Matrix4().set(...([...local, 0, 0, 0, 1] as [number, number, number, number, number, number, number, number, number, number, number, number, number, number, number, number])));
    const place = new Vector3().setFromMatrixPosition(world);
    const ahead = new Vector3().setFromMatrixColumn(world, 2);
    const to = camera.position.clone().sub(place).setY(0).normalize();
    expect(ahead.distanceTo(to)).toBeLessThan(1e-9);
  }
});
