import { Frustum, Matrix4, MeshStandardMaterial, type Material } from 'three';
import { type PoseBook, PoseFlag } from 'peerd';

import { MovingScene } from './moving_scene';
import { RigidFrames } from './rigid_frames';
import type { SceneFile } from './scene_file';
import type { Overlay, SceneView } from './scene_view';

// Where the objects of others really are, where that is known, beside where this view has them: pale green copies.
const kColour = 0x2f9e64;
const kOpacity = 0.45;

export class TruthShapes implements Overlay {
  visible = false;
  private file: SceneFile | null = null;
  private shapes: MovingScene | null = null;
  private frames = new RigidFrames(0);
  private colours = new Float32Array(0);
  private readonly materials = new Map<number, MeshStandardMaterial>();
  private readonly frustum = new Frustum();
  private readonly viewProjection = new Matrix4();

  constructor(private readonly book: () => PoseBook) {}

  update(view: SceneView, time_s: number): void {
    if (view.file !== this.file) this.follow(view);
    if (this.shapes === null || this.file === null) return;
    this.shapes.group.visible = this.visible;
    if (!this.visible) return;
    const { camera } = view.rig;
    this.frustum.setFromProjectionMatrix(this.viewProjection.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const { truth, shown } = this.book();
    this.frames.update(this.file.nodes, truth, time_s);
    for (const { index } of this.file.nodes) if ((shown.flags[index] & PoseFlag.own) !== 0) this.frames.known[index] = 0;
    this.shapes.update(this.frames, this.frustum, this.colours);
  }

  private follow(view: SceneView): void {
    this.shapes?.dispose();
    this.file = view.file;
    this.shapes = this.file === null ? null : new MovingScene(this.file.shapes, (own) => this.materialLike(own));
    if (this.file === null || this.shapes === null) return;
    this.frames = new RigidFrames(this.file.nodeCount);
    this.colours = new Float32Array(this.file.nodeCount * 3).fill(1);
    view.scene.add(this.shapes.group);
  }

  private materialLike(own: Material): MeshStandardMaterial {
    const kept = this.materials.get(own.side);
    if (kept !== undefined) return kept;
    const material = new MeshStandardMaterial({ color: kColour, roughness: 0.75, metalness: 0, side: own.side, transparent: true, opacity: kOpacity, depthWrite: false });
    material.polygonOffset = true; // a truth that is where it is shown lies behind, and does not flicker through it
    material.polygonOffsetFactor = material.polygonOffsetUnits = 1;
    this.materials.set(own.side, material);
    return material;
  }
}
