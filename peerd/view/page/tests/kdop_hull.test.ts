import { BoxGeometry, SphereGeometry } from 'three';
import { describe, expect, it } from 'vitest';

import { kdopHull, type KdopHull } from '../src/scene/kdop_hull';

// How far a point is outside of the hull, by the planes of its triangles.
function outside(hull: KdopHull, p: readonly number[]): number {
  let farthest = -Infinity;
  for (let i = 0; i < hull.corners.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => [...hull.points.slice(3 * hull.corners[i + k], 3 * hull.corners[i + k] + 3)]);
    const [u, v] = [b.map((x, k) => x - a[k]), c.map((x, k) => x - a[k])];
    const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const length = Math.hypot(...n);
    if (length < 1e-9) continue;
    farthest = Math.max(farthest, n.reduce((sum, x, k) => sum + x * (p[k] - a[k]), 0) / length);
  }
  return farthest;
}

function volume(hull: KdopHull): number {
  let sum = 0;
  for (let i = 0; i < hull.corners.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => [...hull.points.slice(3 * hull.corners[i + k], 3 * hull.corners[i + k] + 3)]);
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

describe('kdopHull', () => {
  it.each([['a sphere', new SphereGeometry(2, 24, 12)], ['a box far from the origin', new BoxGeometry(1, 2, 3).translate(50, -20, 7)]] as const)('holds all of %s', (_name, geometry) => {
    const positions = geometry.getAttribute('position').array;
    const hull = kdopHull(positions);
    expect(hull).not.toBeNull();
    for (let i = 0; hull !== null && i < positions.length; i += 3) expect(outside(hull, [...positions.slice(i, i + 3)])).toBeLessThan(-1e-4);
  });
  it('of a box is the box', () => {
    const hull = kdopHull(new BoxGeometry(1, 2, 3).getAttribute('position').array);
    expect(hull === null ? 0 : volume(hull)).toBeCloseTo(6, 0);
    expect(hull === null ? 0 : volume(hull)).toBeGreaterThan(6);
  });
  it('of a sphere is tighter than its box', () => {
    const hull = kdopHull(new SphereGeometry(1, 48, 24).getAttribute('position').array);
    expect(hull === null ? 8 : volume(hull)).toBeLessThan(5.6);
    expect(hull === null ? 0 : volume(hull)).toBeGreaterThan((4 / 3) * Math.PI);
  });
  it('of a flat geometry is thin, and of nothing is none', () => {
    const hull = kdopHull([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
    expect(hull === null ? 1 : volume(hull)).toBeLessThan(0.02);
    expect(kdopHull([])).toBeNull();
    expect(kdopHull([0, 0, NaN])).toBeNull();
  });
});
