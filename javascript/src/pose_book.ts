import { PoseKind, PoseRow, type PoseFrame } from './pose_frame.js';
import { PoseTable } from './pose_table.js';

// The poses of all kinds, by the scene file's nodes.
export class PoseBook {
  readonly shown: PoseTable;
  readonly truth: PoseTable;
  readonly ghost: PoseTable;
  private readonly a = new Float64Array(7);
  private readonly b = new Float64Array(7);

  constructor(nodeCount: number) {
    this.shown = new PoseTable(nodeCount);
    this.truth = new PoseTable(nodeCount);
    this.ghost = new PoseTable(nodeCount);
  }

  // `nodeOf` says which node a row's node is now; -1: none. Without it they are the same.
  take(frame: PoseFrame, time_s: number, drawn_s: number, nodeOf?: Int32Array): void {
    const row = new PoseRow(frame);
    for (let i = 0; i < frame.rowCount; ++i) {
      row.moveTo(i);
      const node = nodeOf === undefined ? row.node : (nodeOf[row.node] ?? -1);
      if (node < 0) continue;
      if (row.owner === 0 && row.kind !== PoseKind.shown) this.tableOf(row.kind)?.forget(node); // it is not known any more
      else this.tableOf(row.kind)?.take(node, row, time_s, drawn_s);
    }
  }

  forgetAll(): void {
    for (const table of [this.shown, this.truth, this.ghost]) table.forgetAll();
  }

  // How wrong the ghost is at an instant, by default that of the last frame [m]; NaN where truth and ghost are not both
  // known, as those of others are only where all of a run is.
  errorOf(node: number, time_s = Infinity): number {
    const { a, b } = this;
    if (!this.truth.sample(node, time_s, a) || !this.ghost.sample(node, time_s, b)) return NaN;
    return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  }

  private tableOf(kind: number): PoseTable | null {
    if (kind === PoseKind.shown) return this.shown;
    if (kind === PoseKind.truth) return this.truth;
    return kind === PoseKind.ghost ? this.ghost : null;
  }
}
