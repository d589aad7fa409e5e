import { expect, it } from 'vitest';

import type { SceneNode } from '../src/scene/scene_file';
import { NodeIds } from '../src/time/node_ids';

function fileOf(revision: number, ids: Record<number, string>): { revision: number; nodes: SceneNode[] } {
  const nodes = Object.entries(ids).map(([index, id]) => ({ index: Number(index), id, path: id, def: id, owner: 0, pose: new Float64Array(7) }));
  return { revision, nodes };
}

it('finds the nodes of an earlier scene by their ids', () => {
  const ids = new NodeIds();
  ids.add(fileOf(1, { 2: 'a', 4: 'b', 6: 'c' }));
  expect(ids.nodeOf(1)).toBeUndefined();
  ids.add(fileOf(2, { 1: 'c', 2: 'new', 4: 'b' }));
  expect([...(ids.nodeOf(1) ?? [])]).toEqual([-1, -1, -1, -1, 4, -1, 1]);
  expect(ids.knows(3)).toBe(false);
});
