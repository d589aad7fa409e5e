import { BoxGeometry, Matrix4, MeshBasicMaterial, Quaternion, Vector3 } from 'three';
import { expect, it } from 'vitest';

import { supportPlace } from '../src/scene/support_place';

const shape = { node: 3, geometry: new BoxGeometry(2, 4, 6), material: new MeshBasicMaterial(), nodeFromShape: new Matrix4().makeTranslation(0, 1, 0) };

it.each([
  ['a face has its middle', new Quaternion(), [1, 0, 0], [1, 1, 0]],
  ['an edge has its middle', new Quaternion(), [Math.SQRT1_2, Math.SQRT1_2, 0], [1, 3, 0]],
  ['a turned node counts as it is turned', new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), Math.PI / 2), [1, 0, 0], [3, 1, 0]],
] as const)('%s', (_name, turn, direction, place) => {
  const found = supportPlace({ shapes: [shape] }, 3, turn, new Vector3(...direction));
  expect(found.distanceTo(new Vector3(...place))).toBeLessThan(1e-6);
});
