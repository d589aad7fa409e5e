import { Matrix4, type Quaternion } from 'three';
import type { PoseTable } from 'peerd';

import type { SceneNode } from './scene_file';

// The rigid frames of all moving nodes at one instant, as rows of a matrix world_from_node: twelve numbers a node, row by
// row (r00 r01 r02 tx, ..). They are computed once a picture and read by every batch.
export const kFrameNumbers = 12;

export class RigidFrames {
  readonly rows: Float64Array;
  readonly known: Uint8Array;
  private readonly pose = new Float64Array(7);
  private readonly scratch = new Matrix4();

  constructor(nodeCount: number) {
    this.rows = new Float64Array(nodeCount * kFrameNumbers);
    this.known = new Uint8Array(nodeCount);
  }

  // Where the scene file has them, before any pose has come.
  placeAsFiled(nodes: readonly SceneNode[]): void {
    for (const { index, pose } of nodes) {
      this.pose.set(pose);
      this.known[index] = 1;
      this.write(index * kFrameNumbers);
    }
  }

  // A node that never moves: its frame is the world's.
  stand(node: number): void {
    if (node < 0) return;
    this.pose.set([0, 0, 0, 0, 0, 0, 1]);
    this.known[node] = 1;
    this.write(node * kFrameNumbers);
  }

  // `flagged`, where given: the nodes of `table` alone whose flags there have `flag`.
  update(nodes: readonly SceneNode[], table: PoseTable, time_s: number, flagged?: PoseTable, flag = 0): void {
    for (let i = 0; i < nodes.length; ++i) {
      const node = nodes[i].index;
      const wanted = flagged === undefined || (flagged.flags[node] & flag) !== 0;
      const known = wanted && table.sample(node, time_s, this.pose);
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

  matrix(node: number, out: Matrix4): Matrix4 {
    const r = this.rows;
    const a = node * kFrameNumbers;
    return out.set(r[a], r[a + 1], r[a + 2], r[a + 3], r[a + 4], r[a + 5], r[a + 6], r[a + 7], r[a + 8], r[a + 9], r[a + 10], r[a + 11], 0, 0, 0, 1);
  }

  orientation(node: number, out: Quaternion): void {
    out.setFromRotationMatrix(this.matrix(node, this.scratch));
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
