import { describe, expect, it } from 'vitest';

import { OpenTree } from '../src/panels/open_tree';
import { treeOf } from './trees';

const kPaths = ['CAR', 'CAR/0', 'CAR/0/appearance', 'CAR/WHEEL', 'HOUSE', 'HOUSE/0'];

function opened(): OpenTree {
  const tree = new OpenTree();
  tree.show(treeOf(kPaths));
  return tree;
}
const seen = ({ tree, rows }: OpenTree): string[] => rows.map((row) => tree.pathOf(row));
const active = ({ tree, active: row }: OpenTree): string => (row < 0 ? '' : tree.pathOf(row));

describe('the rows of the tree that are to be seen', () => {
  it('are those at the top, and those of what is open', () => {
    const tree = opened();
    expect(seen(tree)).toEqual(['CAR', 'HOUSE']);
    tree.toggle(0);
    expect(seen(tree)).toEqual(['CAR', 'CAR/0', 'CAR/WHEEL', 'HOUSE']);
    tree.toggle(0);
    expect(seen(tree)).toEqual(['CAR', 'HOUSE']);
  });

  it('come to what is selected elsewhere', () => {
    const tree = opened();
    expect(tree.reveal('CAR/0/appearance')).toBe(true);
    expect(seen(tree)).toEqual(['CAR', 'CAR/0', 'CAR/0/appearance', 'CAR/WHEEL', 'HOUSE']);
    expect(active(tree)).toBe('CAR/0/appearance');
    expect(tree.reveal('NOBODY')).toBe(false);
    tree.toggle(0); // closed over the active one
    expect(active(tree)).toBe('CAR');
  });

  it('follow edits: what was added is there, and what was open stays so', () => {
    const tree = opened();
    tree.reveal('CAR/WHEEL');
    tree.show(treeOf(['BOX', 'BOX/0', ...kPaths]));
    expect(seen(tree)).toEqual(['BOX', 'CAR', 'CAR/0', 'CAR/WHEEL', 'HOUSE']);
    expect(active(tree)).toBe('CAR/WHEEL');
    tree.show(treeOf(['HOUSE', 'HOUSE/0']));
    expect(seen(tree)).toEqual(['HOUSE']);
    expect(active(tree)).toBe('');
  });

  it('are walked by the keys of a tree', () => {
    const tree = opened();
    const walk: [string, string][] = [
      ['ArrowDown', 'CAR'],
      ['ArrowRight', 'CAR'],
      ['ArrowRight', 'CAR/0'],
      ['ArrowDown', 'CAR/WHEEL'],
      ['ArrowRight', 'CAR/WHEEL'],
      ['ArrowLeft', 'CAR'],
      ['End', 'HOUSE'],
      ['PageUp', 'CAR/0'],
      ['Home', 'CAR'],
      ['ArrowUp', 'CAR'],
      ['ArrowLeft', 'CAR'],
      ['PageDown', 'HOUSE'],
    ];
    for (const [key, path] of walk) {
      expect(tree.onKey(key, 2)).toBe(true);
      expect([key, active(tree)]).toEqual([key, path]);
    }
    expect(seen(tree)).toEqual(['CAR', 'HOUSE']);
    expect(tree.onKey('x', 2)).toBe(false);
  });

  it('are few where ten thousand nodes are closed, and come fast where all are open', () => {
    const tree = new OpenTree();
    const paths = Array.from({ length: 2000 }, (_, i) => [`N${i}`, `N${i}/0`, `N${i}/0/appearance`, `N${i}/0/appearance/material`, `N${i}/0/geometry`]).flat();
    const file = treeOf(paths);
    const began = performance.now();
    tree.show(file);
    expect(tree.rows.length).toBe(2000);
    for (let row = 0; row < file.count; ++row) tree.tree.hasChildren(row) && row % 5 === 0 && tree.toggle(row);
    expect(tree.rows.length).toBe(4000);
    const opened_ms = performance.now() - began;
    const again = performance.now();
    tree.show(file); // as after an edit
    const edit_ms = performance.now() - again;
    expect(tree.rows.length).toBe(4000);
    console.log(`10,000 nodes: ${opened_ms.toFixed(0)} ms for 2,000 openings one by one, ${edit_ms.toFixed(0)} ms for an edit while they are open`);
  });
});
