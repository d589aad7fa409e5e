import { DynamicDrawUsage, InstancedMesh, MeshBasicMaterial, SphereGeometry } from 'three';

import type { PoseBook } from '../time/pose_book';
import { kFrameNumbers } from './rigid_frames';
import type { Overlay, SceneView } from './scene_view';

// Dead-reckoning thresholds in force: around what is drawn of each object a sphere that its true place must leave before
// its owner publishes an update.
export class ThresholdMarks implements Overlay {
  visible = false;
  private mesh: InstancedMesh | null = null;
  private readonly geometry = new SphereGeometry(1, 20, 12);
  private readonly material = new MeshBasicMaterial({ color: 0xf59e0b, wireframe: true, transparent: true, opacity: 0.28, depthTest: false, depthWrite: false, fog: false });

  constructor(private readonly bookOf: () => PoseBook) {}

  update(view: SceneView): void {
    const nodes = view.file?.nodes ?? [];
    if (!this.visible || nodes.length === 0) {
      if (this.mesh !== null) this.mesh.visible = false;
      return;
    }
    const mesh = this.meshFor(view, nodes.length);
    const { threshold_m } = this.bookOf().shown;
    const out = mesh.instanceMatrix.array as Float32Array;
    let slot = 0;
    for (const { index } of nodes) {
      const radius_m = threshold_m[index];
      if (!(radius_m > 0) || view.frames === null || view.frames.known[index] === 0) continue;
      writeSphere(out, slot++ * 16, view.frames.rows, index * kFrameNumbers, radius_m);
    }
    mesh.count = slot;
    mesh.visible = slot > 0;
    mesh.instanceMatrix.needsUpdate = true;
  }

  private meshFor(view: SceneView, count: number): InstancedMesh {
    if (this.mesh !== null && this.mesh.instanceMatrix.count >= count) return this.mesh;
    this.mesh?.removeFromParent();
    this.mesh?.dispose();
    this.mesh = new InstancedMesh(this.geometry, this.material, count);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2;
    view.scene.add(this.mesh);
    return this.mesh;
  }
}

function writeSphere(out: Float32Array, at: number, rows: Float64Array, row: number, radius_m: number): void {
  out.fill(0, at, at + 16);
  out[at] = out[at + 5] = out[at + 10] = radius_m;
  out[at + 12] = rows[row + 3];
  out[at + 13] = rows[row + 7];
  out[at + 14] = rows[row + 11];
  out[at + 15] = 1;
}
