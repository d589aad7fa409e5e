import type { Regions } from 'peerd';

// The cells of a region grid within a box, with the region of each, as the daemon counts them: along an axis with n of them,
// cells n apart share one; an axis with one is not cut.
export type Range3 = readonly [number, number, number];

export interface Cell {
  readonly lo: Range3;
  readonly hi: Range3;
  readonly region: number;
}

export function regionOf(cell: Range3, counts: Range3): number {
  let region = 0;
  for (let axis = 2; axis >= 0; --axis) {
    const n = counts[axis];
    region = region * n + (n === 1 ? 0 : ((cell[axis] % n) + n) % n);
  }
  return region + 1;
}

// At most `most`; those in the middle of the box come first, so that the rest of a large world is what is missing.
export function cellsIn(regions: Pick<Regions, 'cell_m' | 'counts'>, lo: Range3, hi: Range3, most: number): Cell[] {
  const { cell_m, counts } = regions;
  if (!(cell_m > 0)) return [];
  const spans = [0, 1, 2].map((axis) => {
    if (counts[axis] === 1) return [0];
    const first = Math.floor(lo[axis] / cell_m);
    const last = Math.floor(hi[axis] / cell_m);
    const middle = (first + last) / 2;
    const reach = Math.min(last - first, most);
    return Array.from({ length: reach + 1 }, (_, i) => Math.ceil(middle - reach / 2) + i).sort((a, b) => Math.abs(a - middle) - Math.abs(b - middle));
  });
  const cells: Cell[] = [];
  for (const y of spans[1]) {
    for (const x of spans[0]) {
      for (const z of spans[2]) {
        if (cells.length === most) return cells;
        const at: Range3 = [x, y, z];
        const edge = (axis: number, end: 0 | 1): number => (counts[axis] === 1 ? (end === 0 ? lo[axis] : hi[axis]) : (at[axis] + end) * cell_m);
        cells.push({ lo: [edge(0, 0), edge(1, 0), edge(2, 0)], hi: [edge(0, 1), edge(1, 1), edge(2, 1)], region: regionOf(at, counts) });
      }
    }
  }
  return cells;
}
