import { Vector3 } from 'three';
import { beforeEach, describe, expect, it } from 'vitest';

import { Proximity } from '../src/hand/proximity';
import type { SensorExtras } from '../src/hand/sensor_rules';
import { RigidFrames } from '../src/scene/rigid_frames';

const at = (x: number, scale = 1): number[] => [scale, 0, 0, x, 0, scale, 0, 0, 0, 0, scale, 0];
const sensor = (fields: Partial<SensorExtras> = {}): SensorExtras => ({
  type: 'ProximitySensor',
  path: 'HALL',
  number: 7,
  node: 0,
  node_from_sensor: at(0),
  center: [1, 0, 0],
  size: [2, 4, 6],
  targets: [{ event: 'enterTime', path: 'T', field: 'startTime' }, { event: 'exitTime', path: 'T', field: 'stopTime' }, { event: 'isActive', path: 'L', field: 'on' }],
  ...fields,
});

describe('Proximity', () => {
  let edits: string[] = [];
  let proximity: Proximity;
  beforeEach(() => {
    edits = [];
    proximity = new Proximity((request) => {
      edits.push(`${String(request['path'])}.${String(request['field'])} ${String(request['value'])}`);
      return Promise.resolve({ done: true, sentence: '' });
    });
  });
  const go = (x: number, y: number, z: number, time_s: number, sensors: readonly SensorExtras[], frames: RigidFrames | null = null): string[] => {
    edits = [];
    proximity.update(new Vector3(x, y, z), time_s, sensors, frames);
    return edits;
  };

  it('is entered and left once each, with its time', () => {
    const world = [sensor()];
    expect(go(5, 0, 0, 1, world)).toEqual([]);
    expect(go(1.5, 1.9, 2.9, 2.5, world)).toEqual(['L.on TRUE', 'T.startTime 2.5']);
    expect(go(1.5, 1.9, -2.9, 3, world)).toEqual([]);
    expect(go(1.5, 2.1, 0, 4, world)).toEqual(['L.on FALSE', 'T.stopTime 4']);
    expect(go(1.5, 2.1, 0, 5, world)).toEqual([]);
  });
  it('is entered by whoever is in it at first', () => expect(go(1, 0, 0, 3, [sensor()])).toEqual(['L.on TRUE', 'T.startTime 3']));
  it('is not entered again in the next scene', () => {
    go(1, 0, 0, 1, [sensor()]);
    expect(go(1, 0, 0, 2, [sensor({ number: 9 })])).toEqual([]);
    expect(go(9, 0, 0, 3, [sensor({ number: 4 })])).toEqual(['L.on FALSE', 'T.stopTime 3']);
  });
  it('is forgotten with its node, and then entered anew', () => {
    go(1, 0, 0, 1, [sensor()]);
    expect(go(1, 0, 0, 2, [])).toEqual([]);
    expect(go(1, 0, 0, 3, [sensor()])).toEqual(['L.on TRUE', 'T.startTime 3']);
  });
  it('has as its box all of its boxes', () => {
    const world = [sensor(), sensor({ path: 'YARD', node_from_sensor: at(2) })];
    expect(go(1, 0, 0, 1, world)).toHaveLength(2);
    expect(go(3, 0, 0, 2, world)).toEqual([]);
    expect(go(5, 0, 0, 3, world)).toEqual(['L.on FALSE', 'T.stopTime 3']);
  });
  it('acts for itself beside others', () => {
    const other = sensor({ number: 8, path: 'ROOM', targets: [{ event: 'isActive', path: 'M', field: 'on' }] });
    expect(go(1, 0, 0, 1, [sensor(), other])).toEqual(['L.on TRUE', 'T.startTime 1', 'M.on TRUE']);
  });
  it('goes and grows with its node', () => {
    const frames = new RigidFrames(2);
    frames.placeAsFiled([{ index: 1, id: '', path: '', def: '', owner: 0, pose: new Float64Array([100, 0, 0, 0, 0, 0, 1]) }]);
    const world = [sensor({ node: 1, node_from_sensor: at(0, 10) })];
    expect(go(1, 0, 0, 1, world, frames)).toEqual([]);
    expect(go(119, 19, 0, 2, world, frames)).toHaveLength(2);
  });
  it('without a volume has nobody in it', () => {
    expect(go(1, 0, 0, 1, [sensor({ size: [2, 0, 2] })])).toEqual([]);
    expect(go(1, 0, 0, 2, [sensor({ node_from_sensor: at(0, 0) })])).toEqual([]);
  });
});
