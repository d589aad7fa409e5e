import { describe, expect, it } from 'vitest';

import { NodeTree } from '../src/scene/node_tree';
import { treeOf } from './trees';

const kPaths = ['0', 'CAR', 'CAR/0', 'CAR/0/appearance', 'CAR/WHEEL', 'CAR/WHEEL/0', 'HOUSE'];

describe('the tree of nodes', () => {
  it('knows each node by its path, and the path of each node', () => {
    const tree = treeOf(kPaths);
    expect(tree.count).toBe(kPaths.length);
    kPaths.forEach((path, row) => {
      expect(tree.pathOf(row)).toBe(path);
      expect(tree.rowOf(path)).toBe(row);
    });
    for (const wrong of ['', 'CAR/1', 'WHEEL', 'HOUSE/0', 'CAR/0/appearance/material']) expect(tree.rowOf(wrong)).toBe(-1);
  });

  it('says what stands around a node and below it', () => {
    const tree = treeOf(kPaths);
    expect([1, 2, 3, 4].map((row) => tree.endOf(row))).toEqual([6, 4, 4, 6]);
    expect(kPaths.map((_, row) => tree.parentOf(row))).toEqual([-1, -1, 1, 2, 1, 4, -1]);
    expect(kPaths.map((_, row) => tree.amongSiblings(row).place)).toEqual([0, 1, 0, 0, 1, 0, 2]);
    expect([0, 2, 3].map((row) => tree.amongSiblings(row).count)).toEqual([3, 2, 1]);
    expect([tree.hasChildren(2), tree.hasChildren(3)]).toEqual([true, false]);
    expect([tree.defOf(1), tree.defOf(2), tree.typeOf(1)]).toEqual(['CAR', '', 'Group']);
  });

  it('is empty where a file has none', () => {
    expect(new NodeTree().count).toBe(0);
    expect(new NodeTree().rowOf('CAR')).toBe(-1);
  });
});
