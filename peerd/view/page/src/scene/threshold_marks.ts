import { MeshBasicMaterial, SphereGeometry } from 'three';
import type { PoseBook } from 'peerd';

import { kFrameNumbers } from './rigid_frames';
import type { Overlay, SceneView } from './scene_view';
import { SphereInstances, writeSphere } from './sphere_instances';

// Dead-reckoning thresholds in force: around what is drawn of each object a sphere that its true place must leave before
// its owner publishes an update.
export class ThresholdMarks implements Overlay {
  visible = false;
  private readonly spheres = new SphereInstances(
    new SphereGeometry(1, 20, 12),
    new MeshBasicMaterial({ color: 0xf59e0b, wireframe: true, transparent: true, opacity: 0.28, depthTest: false, depthWrite: false, fog: false }),
  );

  constructor(private readonly bookOf: () => PoseBook) {}

  update(view: SceneView): void {
    const nodes = view.file?.nodes ?? [];
    const { frames } = view;
    if (!this.visible || nodes.length === 0 || frames === null) {
      this.spheres.hide();
      return;
    }
    const { threshold_m } = this.bookOf().shown;
    const out = this.spheres.withRoom(view, nodes.length).instanceMatrix.array as Float32Array;
    let slot = 0;
    for (const { index } of nodes) {
      if (!(threshold_m[index] > 0) || frames.known[index] === 0) continue;
      const row = index * kFrameNumbers;
      writeSphere(out, slot++, frames.rows[row + 3], frames.rows[row + 7], frames.rows[row + 11], threshold_m[index]);
    }
    this.spheres.show(slot);
  }
}
