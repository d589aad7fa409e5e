import { describe, expect, it } from 'vitest';
import { PoseRow, PoseTable } from 'peerd';

import { frame, type Row } from './frames';

function take(table: PoseTable, row: Row, time_s: number, drawn_s: number): void {
  const read = new PoseRow(frame(time_s, 1, [row]));
  read.moveTo(0);
  table.take(row.node, read, time_s, drawn_s);
}

function placeAt(table: PoseTable, node: number, time_s: number): number[] | null {
  const pose = new Float64Array(7);
  return table.sample(node, time_s, pose) ? [...pose] : null;
}

describe('a table of poses', () => {
  it('goes from what was drawn to what came', () => {
    const table = new PoseTable(4);
    expect(placeAt(table, 2, 0)).toBeNull();
    take(table, { node: 2, position: [0, 0, 0] }, 10, NaN);
    expect(placeAt(table, 2, 9)?.[0]).toBe(0);
    take(table, { node: 2, position: [8, 0, 0] }, 10.1, 10.02);
    expect(placeAt(table, 2, 10.02)?.[0]).toBe(0);
    expect(placeAt(table, 2, 10.06)?.[0]).toBeCloseTo(4, 9);
    expect(placeAt(table, 2, 11)?.[0]).toBe(8);
  });

  it('does not jump where a frame comes while another is on its way', () => {
    const table = new PoseTable(1);
    take(table, { node: 0, position: [0, 0, 0] }, 0, NaN);
    take(table, { node: 0, position: [10, 0, 0] }, 1, 0);
    const before = placeAt(table, 0, 0.4);
    take(table, { node: 0, position: [0, 0, 0] }, 2, 0.4);
    expect(placeAt(table, 0, 0.4)).toEqual(before);
  });

  it('turns along the shorter arc', () => {
    const table = new PoseTable(1);
    take(table, { node: 0, position: [0, 0, 0], orientation: [0, 0, 0, 1] }, 0, NaN);
    const half = Math.SQRT1_2;
    take(table, { node: 0, position: [0, 0, 0], orientation: [0, -half, 0, -half] }, 1, 0); // the same turn as (0 half 0 half)
    const [, , , x, y, z, w] = placeAt(table, 0, 0.5) ?? [];
    expect(Math.hypot(x, y, z, w)).toBeCloseTo(1, 12);
    expect(2 * Math.atan2(y, w)).toBeCloseTo(Math.PI / 4, 6);
  });

  it('forgets, and places what has not come', () => {
    const table = new PoseTable(2);
    table.place(1, [1, 2, 3, 0, 0, 0, 1], 5);
    expect(placeAt(table, 1, 0)?.slice(0, 3)).toEqual([1, 2, 3]);
    expect(table.owner[1]).toBe(5);
    table.forgetAll();
    expect(placeAt(table, 1, 0)).toBeNull();
  });

  it('leaves out nodes beyond its scene', () => {
    const table = new PoseTable(1);
    take(table, { node: 9, position: [0, 0, 0] }, 0, 0);
    expect(table.knows(9)).toBe(false);
  });
});
