import type { PoseRow } from './pose_frame.js';

// The poses of one kind (shown, truth or ghost) of all nodes: for each the last one that came, and the one that was drawn
// when it came. What is drawn goes from the one to the other, so that it never jumps, whatever the network's rhythm.
//
// A pose takes seven numbers: x y z [m], then the orientation's x y z w.
const kNumbers = 7;

export class PoseTable {
  private readonly from: Float64Array;
  private readonly to: Float64Array;
  private readonly fromTime_s: Float64Array;
  private readonly toTime_s: Float64Array; // NaN: no pose is known
  readonly owner: Uint32Array;
  readonly flags: Uint16Array;
  readonly threshold_m: Float32Array;

  constructor(readonly nodeCount: number) {
    this.from = new Float64Array(nodeCount * kNumbers);
    this.to = new Float64Array(nodeCount * kNumbers);
    this.fromTime_s = new Float64Array(nodeCount).fill(NaN);
    this.toTime_s = new Float64Array(nodeCount).fill(NaN);
    this.owner = new Uint32Array(nodeCount);
    this.flags = new Uint16Array(nodeCount);
    this.threshold_m = new Float32Array(nodeCount).fill(NaN);
  }

  knows(node: number): boolean {
    return node < this.nodeCount && !Number.isNaN(this.toTime_s[node]);
  }

  forget(node: number): void {
    this.toTime_s[node] = NaN;
  }

  forgetAll(): void {
    this.toTime_s.fill(NaN);
  }

  // A pose of `node` that holds at time_s while the picture shows drawn_s. The first one is there at once.
  take(node: number, row: PoseRow, time_s: number, drawn_s: number): void {
    if (node >= this.nodeCount) return;
    const begin = node * kNumbers;
    const first = !this.knows(node);
    if (!first) {
      const begin_s = drawn_s < time_s ? drawn_s : time_s; // also where nothing has been drawn yet
      this.sample(node, begin_s, this.from, begin);
      this.fromTime_s[node] = begin_s;
    }
    for (let axis = 0; axis < 3; ++axis) this.to[begin + axis] = row.position(axis);
    for (let part = 0; part < 4; ++part) this.to[begin + 3 + part] = row.orientation(part);
    this.toTime_s[node] = time_s;
    this.owner[node] = row.owner;
    this.flags[node] = row.flags;
    this.threshold_m[node] = row.threshold_m;
    if (!first) return;
    for (let i = 0; i < kNumbers; ++i) this.from[begin + i] = this.to[begin + i];
    this.fromTime_s[node] = time_s;
  }

  // A pose from somewhere else than a frame: where the scene file has the node.
  place(node: number, pose: ArrayLike<number>, owner: number): void {
    for (let i = 0; i < kNumbers; ++i) this.from[node * kNumbers + i] = this.to[node * kNumbers + i] = pose[i];
    this.fromTime_s[node] = this.toTime_s[node] = -Infinity;
    this.owner[node] = owner;
  }

  // The last pose that came.
  latest(node: number, out: Float64Array | Float32Array): boolean {
    if (!this.knows(node)) return false;
    for (let i = 0; i < kNumbers; ++i) out[i] = this.to[node * kNumbers + i];
    return true;
  }

  // The pose at an instant between the two that are kept; before and after them the picture stands.
  sample(node: number, time_s: number, out: Float64Array, at = 0): boolean {
    if (!this.knows(node)) return false;
    const begin = node * kNumbers;
    const from_s = this.fromTime_s[node];
    const to_s = this.toTime_s[node];
    const share = to_s > from_s ? Math.min(1, Math.max(0, (time_s - from_s) / (to_s - from_s))) : 1;
    blend(this.from, this.to, begin, share, out, at);
    return true;
  }
}

// Positions go along a line and orientations along the shorter arc, normalised: between two frames the difference to the
// great circle is far below a pixel.
function blend(a: Float64Array, b: Float64Array, begin: number, share: number, out: Float64Array, at: number): void {
  const rest = 1 - share;
  for (let i = 0; i < 3; ++i) out[at + i] = a[begin + i] * rest + b[begin + i] * share;
  const qa = begin + 3;
  const dot = a[qa] * b[qa] + a[qa + 1] * b[qa + 1] + a[qa + 2] * b[qa + 2] + a[qa + 3] * b[qa + 3];
  const weight = dot < 0 ? -share : share;
  const x = a[qa] * rest + b[qa] * weight;
  const y = a[qa + 1] * rest + b[qa + 1] * weight;
  const z = a[qa + 2] * rest + b[qa + 2] * weight;
  const w = a[qa + 3] * rest + b[qa + 3] * weight;
  const length = Math.sqrt(x * x + y * y + z * z + w * w) || 1;
  out[at + 3] = x / length;
  out[at + 4] = y / length;
  out[at + 5] = z / length;
  out[at + 6] = w / length;
}
