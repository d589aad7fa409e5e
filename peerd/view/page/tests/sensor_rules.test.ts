import { describe, expect, it } from 'vitest';

import { clamped, editsOf, isDragged, keyOf, sensorsAround, type SensorExtras } from '../src/hand/sensor_rules';

const sensor = (path: string, type: SensorExtras['type'] = 'TouchSensor'): SensorExtras => ({ type, path, node: 0, node_from_sensor: [], targets: [] });

describe('sensorsAround', () => {
  const all = [sensor('HOUSE'), sensor('HOUSE/DOOR'), sensor('HOUSE/DOOR', 'PlaneSensor'), sensor('HOUSE/DOORBELL')];
  it('are the lowest ones, all of one node', () => expect(sensorsAround('HOUSE/DOOR/0', all).map(({ path, type }) => `${path} ${type}`)).toEqual(['HOUSE/DOOR TouchSensor', 'HOUSE/DOOR PlaneSensor']));
  it('are those above where none is lower', () => expect(sensorsAround('HOUSE/WALL/0', all).map(({ path }) => path)).toEqual(['HOUSE']));
  it('of the top level work everything', () => expect(sensorsAround('TREE', [...all, sensor('')]).map(({ path }) => path)).toEqual(['']));
  it('are none elsewhere', () => expect(sensorsAround('TREE', all)).toEqual([]));
  it('are not those of the viewer', () => expect(sensorsAround('HOUSE/DOOR/0', [sensor('HOUSE/DOOR', 'ProximitySensor'), sensor('HOUSE')]).map(({ path }) => path)).toEqual(['HOUSE']));
});

it('three of the sensors are dragged', () => {
  const types = ['TouchSensor', 'PlaneSensor', 'CylinderSensor', 'SphereSensor', 'ProximitySensor'] as const;
  expect(types.filter((type) => isDragged(sensor('A', type)))).toEqual(['PlaneSensor', 'CylinderSensor', 'SphereSensor']);
});

it('bounds count where the lower one is not above the upper one', () => {
  expect([clamped(5, 0, 1), clamped(-5, 0, 1), clamped(0.5, 0, 1), clamped(5, 0, -1), clamped(5, 2, 2)]).toEqual([1, 0, 0.5, 5, 2]);
});

it('an event is one edit for each ROUTE from it, in the notation of VRML', () => {
  const all: SensorExtras = { ...sensor('A'), targets: [{ event: 'touchTime', path: 'T', field: 'startTime' }, { event: 'isActive', path: 'L', field: 'on' }, { event: 'isActive', path: 'M', field: 'on' }] };
  expect(editsOf(all, 'touchTime', 12.5)).toEqual([{ do: 'set', path: 'T', field: 'startTime', value: '12.5' }]);
  expect(editsOf(all, 'isActive', false).map(({ path, value }) => `${path} ${value}`)).toEqual(['L FALSE', 'M FALSE']);
  expect(editsOf({ ...all, targets: [{ event: 'translation_changed', path: 'X', field: 'translation' }] }, 'translation_changed', [1, 0.5, -2])[0].value).toBe('1 0.5 -2');
  expect(editsOf(all, 'isOver', true)).toEqual([]);
});

it('a sensor is known again by its place and by what it does', () => {
  const one: SensorExtras = { ...sensor('A', 'PlaneSensor'), targets: [{ event: 'translation_changed', path: 'X', field: 'translation' }] };
  expect(keyOf({ ...one, node: 7 })).toBe(keyOf(one));
  expect(keyOf({ ...one, targets: [{ ...one.targets[0], path: 'Y' }] })).not.toBe(keyOf(one));
});
