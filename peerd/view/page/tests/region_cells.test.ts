import { describe, expect, it } from 'vitest';

import { cellsIn, regionOf } from '../src/scene/region_cells';

describe('regionOf', () => {
  it('counts x first, from 1', () => expect([regionOf([0, 0, 0], [4, 1, 3]), regionOf([1, 0, 0], [4, 1, 3]), regionOf([0, 0, 1], [4, 1, 3])]).toEqual([1, 2, 5]));
  it('repeats, also before the origin', () => expect([regionOf([4, 0, 0], [4, 1, 3]), regionOf([-1, 0, -1], [4, 1, 3])]).toEqual([1, 12]));
  it('does not cut an axis of one', () => expect(regionOf([0, 7, 0], [4, 1, 3])).toBe(1));
});

describe('cellsIn', () => {
  it('covers the box, and has the height that is not cut', () => {
    const cells = cellsIn({ cell_m: 10, counts: [8, 1, 8] }, [-5, -1, 0], [25, 3, 9], 100);
    expect(cells.map(({ lo }) => lo[0]).sort((a, b) => a - b)).toEqual([-10, 0, 10, 20]);
    expect(cells.every(({ lo, hi }) => lo[1] === -1 && hi[1] === 3 && lo[2] === 0 && hi[2] === 10)).toBe(true);
  });
  it('is bounded, from the middle on', () => {
    const cells = cellsIn({ cell_m: 1, counts: [8, 1, 8] }, [-1e6, 0, -1e6], [1e6, 0, 1e6], 50);
    expect(cells.length).toBe(50);
    expect(Math.min(...cells.map(({ lo }) => Math.abs(lo[0])))).toBeLessThanOrEqual(1);
  });
  it('is nothing where the scene is not cut', () => expect(cellsIn({ cell_m: 0, counts: [8, 1, 8] }, [0, 0, 0], [1, 1, 1], 9)).toEqual([]));
});
