import { Matrix4, type Quaternion } from 'three';

import type { PoseTable } from '../live/pose_table';
import type { SceneNode } from './scene_file';

// The rigid frames of all moving nodes at one instant, as rows of a matrix world_from_node: twelve numbers a node, row by
// row (r00 r01 r02 tx, ..). They are computed once a picture and read by every batch.
export const kFrameNumbers = 12;

export class RigidFrames {
  readonly rows: Float64Array;
  readonly known: Uint8Array;
  private readonly pose = new Float64Array(7);
  private readonly matrix = new Matrix4();

  constructor(nodeCount: number) {
    this.rows = new Float64Array(nodeCount * kFrameNumbers);
    this.known = new Uint8Array(nodeCount);
  }

  update(nodes: readonly SceneNode[], table: PoseTable, time_s: number): void {
    for (let i = 0; i < nodes.length; ++i) {
      const node = nodes[i].index;
      const known = table.sample(node, time_s, this.pose);
      this.known[node] = known ? 1 : 0;
      if (known) this.write(node * kFrameNumbers);
    }
  }

  position(node: number, out: { x: number; y: number; z: number }): boolean {
    const at = node * kFrameNumbers;
    out.x = this.rows[at + 3];
    out.y = this.rows[at + 7];
    out.z = this.rows[at + 11];
    return this.known[node] === 1;
  }

  orientation(node: number, out: Quaternion): void {
    const r = this.rows;
    const at = node * kFrameNumbers;
    this.matrix.set(r[at], r[at + 1], r[at + 2], 0, r[at + 4], r[at + 5], r[at + 6], 0, r[at + 8], r[at + 9], r[at + 10], 0, 0, 0, 0, 1);
    out.setFromRotationMatrix(this.matrix);
  }

  private write(at: number): void {
    const p = this.pose;
    const r = this.rows;
    const x = p[3];
    const y = p[4];
    const z = p[5];
    const w = p[6];
    r[at] = 1 - 2 * (y * y + z * z);
    r[at + 1] = 2 * (x * y - z * w);
    r[at + 2] = 2 * (x * z + y * w);
    r[at + 3] = p[0];
    r[at + 4] = 2 * (x * y + z * w);
    r[at + 5] = 1 - 2 * (x * x + z * z);
    r[at + 6] = 2 * (y * z - x * w);
    r[at + 7] = p[1];
    r[at + 8] = 2 * (x * z - y * w);
    r[at + 9] = 2 * (y * z + x * w);
    r[at + 10] = 1 - 2 * (x * x + y * y);
    r[at + 11] = p[2];
  }
}
