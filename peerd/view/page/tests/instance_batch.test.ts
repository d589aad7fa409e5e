import { BoxGeometry, Matrix4, MeshBasicMaterial, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';

import { InstanceBatch, previewAt, type Preview } from '../src/scene/instance_batch';
import { RigidFrames } from '../src/scene/rigid_frames';
import { ViewGroups } from '../src/scene/view_groups';

const preview = (path: string, node: number, x: number): Preview => ({ path, node, motion: new Matrix4().makeTranslation(x, 0, 0) });

it('a preview moves what is at its path and below it, in its node', () => {
  const one = preview('TRAY/KNOB', 2, 1);
  expect(['TRAY/KNOB', 'TRAY/KNOB/0', 'TRAY/KNOBS', 'TRAY'].map((path) => previewAt([one], path, 2) === one)).toEqual([true, true, false, false]);
  expect(previewAt([one], 'TRAY/KNOB', 1)).toBeUndefined();
});

describe('a batch with previews', () => {
  const shape = (path: string, node: number, x: number) => ({ node, path, nodeFromShape: new Matrix4().makeTranslation(x, 0, 0), geometry: new BoxGeometry(), material: new MeshBasicMaterial() });
  const shapes = [shape('CAR/KNOB/0', 0, 1), shape('CAR/BODY/0', 0, 2), shape('VAN/KNOB/0', 1, 3)];
  const batch = new InstanceBatch(shapes, shapes[0].geometry, shapes[0].material);
  const frames = new RigidFrames(2);
  frames.placeAsFiled([0, 1].map((index) => ({ index, id: '', path: '', def: '', owner: 0, pose: new Float64Array([100 * index, 0, 0, 0, 0, 0, 1]) })));
  const groups = new ViewGroups([]);
  const places = (): number[] => shapes.map((_, i) => {
    const world = new Matrix4();
    batch.worldOf(i, frames, groups, world);
    return new Vector3().setFromMatrixPosition(world).x;
  });

  it('draws these elsewhere, and all others where they are', () => {
    expect(places()).toEqual([1, 2, 103]);
    batch.preview([preview('CAR/KNOB', 0, 10)]);
    expect(places()).toEqual([11, 2, 103]);
  });
  it('goes by the last ones, and not on from those before', () => {
    batch.preview([preview('CAR/KNOB', 0, 20), preview('VAN', 1, 5)]);
    expect(places()).toEqual([21, 2, 108]);
    batch.preview([preview('VAN', 1, 6)]);
    expect(places()).toEqual([1, 2, 109]);
  });
  it('draws all where they are without any', () => {
    batch.preview([]);
    expect(places()).toEqual([1, 2, 103]);
  });
});
