import { Matrix4, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { previewsOf, worldFromSensor } from '../src/hand/sensor_frames';
import { RigidFrames } from '../src/scene/rigid_frames';

const rows = (m: Matrix4): number[] => m.clone().transpose().toArray().slice(0, 12);
const close = (found: Vector3, wanted: readonly [number, number, number]): void => found.toArray().forEach((value, i) => expect(value).toBeCloseTo(wanted[i], 9));

it('a sensor goes with its node', () => {
  const frames = new RigidFrames(2);
  frames.placeAsFiled([{ index: 1, id: '', path: '', def: '', owner: 0, pose: new Float64Array([5, 0, 0, 0, 0, Math.SQRT1_2, Math.SQRT1_2]) }]);
  const sensor = { node: 1, node_from_sensor: rows(new Matrix4().makeTranslation(1, 0, 0)) };
  close(new Vector3(0, 0, 0).applyMatrix4(worldFromSensor(sensor, frames)), [5, 1, 0]);
  close(new Vector3(0, 0, 0).applyMatrix4(worldFromSensor({ ...sensor, node: 0 }, frames)), [1, 0, 0]);
  close(new Vector3(0, 0, 0).applyMatrix4(worldFromSensor(sensor, null)), [1, 0, 0]);
});

describe('previewsOf', () => {
  const targets = [{ event: 'translation_changed', path: 'A', field: 'translation' }, { event: 'rotation_changed', path: 'B', field: 'rotation' }];
  const preview = (target: number, frame: Matrix4, from: readonly number[]): Parameters<typeof previewsOf>[0] => ({ targets, previews: [{ target, path: 'X', node: 3, node_from_frame: rows(frame), from }] });

  it('moves by the way from the value that the field has, in the axes of the target', () => {
    const frame = new Matrix4().makeRotationZ(Math.PI / 2).setPosition(9, 9, 9);
    const [{ path, node, motion }] = previewsOf(preview(0, frame, [1, 0, 0]), { translation_changed: [3, 0, 0] });
    expect([path, node]).toEqual(['X', 3]);
    close(new Vector3(4, 5, 6).applyMatrix4(motion), [4, 7, 6]);
  });
  it('turns about the middle of the target, from the rotation that it has', () => {
    const frame = new Matrix4().makeTranslation(10, 0, 0);
    const [{ motion }] = previewsOf(preview(1, frame, [0, 0, 1, 1]), { rotation_changed: [0, 0, 1, 1 + Math.PI / 2] });
    close(new Vector3(12, 0, 0).applyMatrix4(motion), [10, 2, 0]);
  });
  it('is none for events that the drag does not have, and for values of another kind', () => {
    expect(previewsOf(preview(0, new Matrix4(), [0, 0, 0]), { rotation_changed: [0, 1, 0, 2] })).toEqual([]);
    expect(previewsOf(preview(0, new Matrix4(), [0, 0, 0, 0]), { translation_changed: [0, 1, 0] })).toEqual([]);
  });
  it('leaves what is flat as it is', () => expect(previewsOf(preview(0, new Matrix4().makeScale(1, 0, 1), [0, 0, 0]), { translation_changed: [1, 0, 0] })[0].motion.equals(new Matrix4())).toBe(true));
});
