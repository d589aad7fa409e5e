import { Box3, Box3Helper, Color, Matrix4, Vector3 } from 'three';

import type { SceneFile } from './scene_file';
import type { Overlay, SceneView } from './scene_view';

// A box around the selected object, in the object's own frame.
export class SelectionBox implements Overlay {
  private readonly helper = new Box3Helper(new Box3(), new Color(0xf5b301));
  private measured: { file: SceneFile; node: number } | null = null;
  private readonly frame = new Matrix4();
  private readonly size = new Vector3();
  private readonly centre = new Vector3();

  constructor(view: SceneView) {
    this.helper.visible = false;
    this.helper.matrixAutoUpdate = false;
    this.helper.frustumCulled = false;
    this.helper.updateMatrixWorld = () => undefined; // its own would place it by the box alone
    view.scene.add(this.helper);
  }

  update(view: SceneView): void {
    const node = view.selected;
    const { file, frames } = view;
    this.helper.visible = node !== null && node !== file?.standingNode && file !== null && frames !== null && frames.known[node] === 1;
    if (!this.helper.visible || node === null || file === null || frames === null) return;
    this.measure(file, node);
    frames.matrix(node, this.frame);
    this.helper.matrixWorld.copy(this.frame);
    this.helper.matrixWorld.scale(this.size).setPosition(this.centre.clone().applyMatrix4(this.frame));
  }

  private measure(file: SceneFile, node: number): void {
    if (this.measured?.file === file && this.measured.node === node) return;
    this.measured = { file, node };
    const box = new Box3();
    for (const shape of file.shapes) {
      if (shape.node !== node) continue;
      shape.geometry.computeBoundingBox();
      if (shape.geometry.boundingBox !== null) box.union(shape.geometry.boundingBox.clone().applyMatrix4(shape.nodeFromShape));
    }
    box.expandByScalar(0.02 * box.getSize(this.size).length() + 1e-3);
    box.getSize(this.size).multiplyScalar(0.5);
    box.getCenter(this.centre);
  }
}
