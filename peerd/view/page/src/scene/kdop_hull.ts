import { BufferAttribute, BufferGeometry } from 'three';

// The 18-DOP of a geometry as a polytope, by which the geometry is culled: the planes are the axes' and those of the diagonals of
// a cube's sides, in the order of the thesis's listing 3.2. It is a little larger than what it holds.
type Point = readonly [number, number, number];

const kDirections: readonly Point[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, -1, 0], [1, 0, -1], [0, 1, -1]];
const kMargin = 2e-3; // of the largest side

export interface KdopHull {
  readonly points: Float32Array; // the corners, three numbers each; each is there once for each face
  readonly corners: readonly number[]; // of its triangles, outwards
}

// Null: there are no points, or not all are numbers.
export function kdopHull(positions: ArrayLike<number>): KdopHull | null {
  const lo = new Array<number>(kDirections.length).fill(Infinity);
  const hi = new Array<number>(kDirections.length).fill(-Infinity);
  for (let i = 0; i + 2 < positions.length; i += 3) {
    kDirections.forEach(([x, y, z], k) => {
      const along = x * positions[i] + y * positions[i + 1] + z * positions[i + 2];
      lo[k] = Math.min(lo[k], along);
      hi[k] = Math.max(hi[k], along);
    });
  }
  const side = Math.max(hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]);
  if (!Number.isFinite(side)) return null;
  const margin = kMargin * side + 1e-5;
  const planes = kDirections.flatMap((direction, k) => [
    { normal: direction, offset: hi[k] + margin * Math.hypot(...direction) },
    { normal: direction.map((x) => -x) as unknown as Point, offset: -lo[k] + margin * Math.hypot(...direction) },
  ]);
  const points: number[] = [];
  const corners: number[] = [];
  planes.forEach((plane, i) => {
    let face = largeFace(plane, 4 * (side + margin) + Math.max(...[0, 1, 2].map((axis) => Math.max(Math.abs(lo[axis]), Math.abs(hi[axis])))));
    planes.forEach((other, k) => {
      if (k !== i) face = clipped(face, other);
    });
    if (face.length < 3) return;
    const first = points.length / 3;
    for (const point of face) points.push(...point);
    for (let k = 1; k + 1 < face.length; ++k) corners.push(first, first + k, first + k + 1);
  });
  return { points: new Float32Array(points), corners };
}

interface Plane {
  readonly normal: Point; // outwards, of any length
  readonly offset: number; // normal . p of its points
}

// A square on the plane, counter-clockwise from outside.
function largeFace({ normal: [x, y, z], offset }: Plane, reach: number): Point[] {
  const square = x * x + y * y + z * z;
  const at: Point = [(x * offset) / square, (y * offset) / square, (z * offset) / square];
  const helper: Point = Math.abs(x) > Math.abs(y) ? [0, 1, 0] : [1, 0, 0];
  const u = unit(cross(helper, [x, y, z]));
  const v = unit(cross([x, y, z], u));
  const corner = (a: number, b: number): Point => [at[0] + reach * (a * u[0] + b * v[0]), at[1] + reach * (a * u[1] + b * v[1]), at[2] + reach * (a * u[2] + b * v[2])];
  return [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
}

function clipped(face: readonly Point[], { normal, offset }: Plane): Point[] {
  const out: Point[] = [];
  const beyond = (p: Point): number => normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2] - offset;
  face.forEach((a, i) => {
    const b = face[(i + 1) % face.length];
    const [da, db] = [beyond(a), beyond(b)];
    if (da <= 0) out.push(a);
    if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
      const share = da / (da - db);
      out.push([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])]);
    }
  });
  return out;
}

function cross(a: Point, b: Point): Point {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

function unit(a: Point): Point {
  const length = Math.hypot(...a);
  return [a[0] / length, a[1] / length, a[2] / length];
}

export function hullGeometry(hull: KdopHull): BufferGeometry {
  return new BufferGeometry().setAttribute('position', new BufferAttribute(hull.points, 3)).setIndex(hull.corners as number[]);
}
