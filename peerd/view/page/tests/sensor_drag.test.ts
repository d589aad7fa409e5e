import { Quaternion, Ray, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { dragOf, rotationOf, turnOf } from '../src/hand/sensor_drag';
import type { SensorExtras } from '../src/hand/sensor_rules';

const sensor = (type: SensorExtras['type'], fields: Partial<SensorExtras> = {}): SensorExtras => ({ type, path: '', node: 0, node_from_sensor: [], targets: [], ...fields });
const ray = (from: readonly [number, number, number], to: readonly [number, number, number]): Ray => {
  const origin = new Vector3(...from);
  return new Ray(origin, new Vector3(...to).sub(origin).normalize());
};
const ahead = (x: number, y: number): Ray => ray([x, y, 10], [x, y, 0]); // along -z
const close = (found: readonly number[], wanted: readonly number[]): void => {
  expect(found.length).toBe(wanted.length);
  found.forEach((value, i) => expect(value).toBeCloseTo(wanted[i], 9));
};

describe('a PlaneSensor', () => {
  const dragged = (fields: Partial<SensorExtras>, begin: Vector3, to: Ray, offset = [0, 0, 0]): Readonly<Record<string, readonly number[]>> => {
    const drag = dragOf(sensor('PlaneSensor', fields), begin, ahead(begin.x, begin.y), offset);
    drag.follow(to);
    return drag.values();
  };
  it('goes on from the offset', () => close(dragged({}, new Vector3(1, 1, 2), ahead(3, 0), [10, 20, 30])['translation_changed'], [12, 19, 30]));
  it('keeps within bounds, on the axes that have them, where its track point goes on', () => {
    const values = dragged({ min: [-1, 0], max: [1, -1] }, new Vector3(0, 0, 0), ahead(9, 9));
    close(values['translation_changed'], [1, 9, 0]);
    close(values['offset'], [1, 9, 0]);
    close(values['trackPoint_changed'], [9, 9, 0]);
  });
  it('is a line where a bound has no width', () => close(dragged({ min: [0, 0], max: [0, 4] }, new Vector3(0, 0, 0), ahead(9, 9))['translation_changed'], [0, 4, 0]));
  it('stays where the pointer runs away from the plane', () => close(dragged({}, new Vector3(0, 0, 0), ray([5, 0, 10], [5, 0, 20]))['translation_changed'], [0, 0, 0]));
});

describe('a CylinderSensor', () => {
  it('is a cylinder where one looks across its axis', () => {
    const drag = dragOf(sensor('CylinderSensor'), new Vector3(0, 3, 2), ahead(0, 3), [0]);
    drag.follow(ahead(Math.SQRT2, 5)); // along the axis it does not turn
    const { rotation_changed, trackPoint_changed, offset } = drag.values();
    close(rotation_changed, [0, 1, 0, Math.PI / 4]);
    close(trackPoint_changed, [Math.SQRT2, 5, Math.SQRT2]);
    close(offset, [Math.PI / 4]);
  });
  it('turns right-handedly about +y, whatever its radius', () => {
    const drag = dragOf(sensor('CylinderSensor'), new Vector3(0.5, 0, 0), ray([10, 0, 0], [0, 0, 0]), [0]);
    drag.follow(ray([10, 0, -0.25], [0, 0, -0.25]));
    close(drag.values()['rotation_changed'], [0, 1, 0, Math.PI / 6]);
  });
  it('is held at its edge by a pointer beside it', () => {
    const drag = dragOf(sensor('CylinderSensor'), new Vector3(0, 0, 1), ahead(0, 0), [0]);
    drag.follow(ahead(7, 0));
    close(drag.values()['rotation_changed'], [0, 1, 0, Math.PI / 2]);
    close(drag.values()['trackPoint_changed'], [1, 0, 0]);
  });
  it('is held at its inner side where it was taken there', () => {
    const drag = dragOf(sensor('CylinderSensor'), new Vector3(0, 0, -1), ahead(0, 0), [0]);
    drag.follow(ahead(Math.SQRT1_2, 0));
    close(drag.values()['trackPoint_changed'], [Math.SQRT1_2, 0, -Math.SQRT1_2]);
    close(drag.values()['rotation_changed'], [0, 1, 0, -Math.PI / 4]);
  });
  it('surrounds a viewer within it', () => {
    const drag = dragOf(sensor('CylinderSensor'), new Vector3(0, 0, -1), ray([0, 0, 0], [0, 0, -1]), [0]);
    drag.follow(ray([0, 0, 0], [1, 0, 0]));
    close(drag.values()['rotation_changed'], [0, 1, 0, -Math.PI / 2]);
  });

  const down = (x: number, z: number): Ray => ray([x, 10, z], [x, 0, z]);
  it('is a disk where one looks along its axis, and counts turns', () => {
    const drag = dragOf(sensor('CylinderSensor'), new Vector3(0, 1, 2), down(0, 2), [0.5]);
    for (let i = 1; i <= 10; ++i) drag.follow(down(3 * Math.sin(i * 0.7), 3 * Math.cos(i * 0.7)));
    const { rotation_changed, trackPoint_changed } = drag.values();
    close(rotation_changed, [0, 1, 0, 7.5]);
    close(trackPoint_changed, [3 * Math.sin(7), 1, 3 * Math.cos(7)]);
  });
  it('has as its least angle to the axis its diskAngle', () => {
    const tilted = ray([10 * Math.sin(0.3), 10 * Math.cos(0.3), 2], [0, 0, 2]);
    const turned = (disk_angle_rad: number): number => {
      const drag = dragOf(sensor('CylinderSensor', { disk_angle_rad: [disk_angle_rad] }), new Vector3(0, 0, 2), tilted, [0]);
      drag.follow(ray([2, 9, 1], [2, 0, 1]));
      return drag.values()['rotation_changed'][3];
    };
    expect(turned(0.31)).toBeCloseTo(Math.atan2(2, 1), 9); // the ray meets the disk at 2 0 1
    expect(turned(0.29)).toBe(0); // it runs along the cylinder, and meets it nowhere
  });
  it('clamps the angle with its offset, and keeps what was clamped', () => {
    const drag = dragOf(sensor('CylinderSensor', { min: [0], max: [1] }), new Vector3(0, 0, 1), down(0, 1), [0.5]);
    drag.follow(down(1, 0));
    close(drag.values()['rotation_changed'], [0, 1, 0, 1]);
    close(drag.values()['offset'], [1]);
    drag.follow(down(0, 1));
    drag.follow(down(-1, 0));
    close(drag.values()['rotation_changed'], [0, 1, 0, 0]);
  });
  it('does not turn by what is on its axis', () => {
    const drag = dragOf(sensor('CylinderSensor'), new Vector3(0, 0, 1), down(0, 1), [0.25]);
    drag.follow(down(0, 0));
    close(drag.values()['rotation_changed'], [0, 1, 0, 0.25]);
  });
});

describe('a SphereSensor', () => {
  it('turns what is held to where the pointer is', () => {
    const drag = dragOf(sensor('SphereSensor'), new Vector3(0, 0, 2), ahead(0, 0), [0, 1, 0, 0]);
    drag.follow(ahead(0, Math.SQRT2));
    close(drag.values()['rotation_changed'], [-1, 0, 0, Math.PI / 4]);
    close(drag.values()['trackPoint_changed'], [0, Math.SQRT2, Math.SQRT2]);
  });
  it('goes on from its offset, in its own frame', () => {
    const drag = dragOf(sensor('SphereSensor'), new Vector3(0, 0, 1), ahead(0, 0), [0, 0, 1, Math.PI / 2]);
    drag.follow(ahead(1, 0));
    const turn = turnOf(drag.values()['rotation_changed']);
    close(new Vector3(1, 0, 0).applyQuaternion(turn).toArray(), [0, 1, 0]); // first about z, then about y
    close(new Vector3(0, 0, 1).applyQuaternion(turn).toArray(), [1, 0, 0]);
    expect(drag.values()['offset']).toEqual(drag.values()['rotation_changed']);
  });
  it('is held at its edge by a pointer beside it', () => {
    const drag = dragOf(sensor('SphereSensor'), new Vector3(0, 0, 1), ahead(0, 0), [0, 1, 0, 0]);
    drag.follow(ahead(-3, 0));
    close(drag.values()['rotation_changed'], [0, -1, 0, Math.PI / 2]);
  });
  it('stays where the pointer runs away from it', () => {
    const drag = dragOf(sensor('SphereSensor'), new Vector3(0, 0, 1), ahead(0, 0), [0, 1, 0, 0]);
    drag.follow(ray([0, 0, 10], [1, 0, 20]));
    close(drag.values()['rotation_changed'], [0, 1, 0, 0]);
  });
});

it('rotations of VRML are turns, with axes of any length', () => {
  close(rotationOf(turnOf([0, 0, 5, 1.25])), [0, 0, 1, 1.25]);
  expect(turnOf([0, 0, 0, 2]).equals(new Quaternion())).toBe(true);
  expect(rotationOf(new Quaternion())).toEqual([0, 1, 0, 0]);
  close(rotationOf(turnOf([0, 1, 0, 4])), [0, 1, 0, 4]);
});
