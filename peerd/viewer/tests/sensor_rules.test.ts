import { describe, expect, it } from 'vitest';

import { editsOf, planeTranslation, sensorsAround, type SensorExtras } from '../src/hand/sensor_rules';

const sensor = (path: string, type: SensorExtras['type'] = 'TouchSensor'): SensorExtras => ({ type, path, node: 0, node_from_sensor: [], targets: [] });

describe('sensorsAround', () => {
  const all = [sensor('HOUSE'), sensor('HOUSE/DOOR'), sensor('HOUSE/DOOR', 'PlaneSensor'), sensor('HOUSE/DOORBELL')];
  it('are the lowest ones, all of one node', () => expect(sensorsAround('HOUSE/DOOR/0', all).map(({ path, type }) => `${path} ${type}`)).toEqual(['HOUSE/DOOR TouchSensor', 'HOUSE/DOOR PlaneSensor']));
  it('are those above where none is lower', () => expect(sensorsAround('HOUSE/WALL/0', all).map(({ path }) => path)).toEqual(['HOUSE']));
  it('of the top level work everything', () => expect(sensorsAround('TREE', [...all, sensor('')]).map(({ path }) => path)).toEqual(['']));
  it('are none elsewhere', () => expect(sensorsAround('TREE', all)).toEqual([]));
});

describe('planeTranslation', () => {
  it('goes on from the offset', () => expect(planeTranslation([1, 1, 2], [3, 0, 2], {}, [10, 20, 30])).toEqual([12, 19, 30]));
  it('keeps within bounds, on the axes that have them', () => expect(planeTranslation([0, 0, 0], [9, 9, 0], { min: [-1, 0], max: [1, -1] }, [0, 0, 0])).toEqual([1, 9, 0]));
  it('a bound of no width is a line', () => expect(planeTranslation([0, 0, 0], [9, 9, 0], { min: [0, 0], max: [0, 4] }, [0, 0, 0])).toEqual([0, 4, 0]));
});

it('an event is one edit for each ROUTE from it, in the notation of VRML', () => {
  const all: SensorExtras = { ...sensor('A'), targets: [{ event: 'touchTime', path: 'T', field: 'startTime' }, { event: 'isActive', path: 'L', field: 'on' }, { event: 'isActive', path: 'M', field: 'on' }] };
  expect(editsOf(all, 'touchTime', 12.5)).toEqual([{ do: 'set', path: 'T', field: 'startTime', value: '12.5' }]);
  expect(editsOf(all, 'isActive', false).map(({ path, value }) => `${path} ${value}`)).toEqual(['L FALSE', 'M FALSE']);
  expect(editsOf({ ...all, targets: [{ event: 'translation_changed', path: 'X', field: 'translation' }] }, 'translation_changed', [1, 0.5, -2])[0].value).toBe('1 0.5 -2');
  expect(editsOf(all, 'isOver', true)).toEqual([]);
});
