import { Group, type BufferGeometry, type Frustum, type Material, type Matrix4 } from 'three';

import { InstanceBatch, type Preview } from './instance_batch';
import { kBehindProxies } from './occlusion';
import type { RigidFrames } from './rigid_frames';
import type { MovingShape } from './scene_file';
import type { ViewGroups } from './view_groups';

// All that moves, in as few draw calls as it has pairs of a geometry and a material. `materialFor` may draw it otherwise
// than its world does: by owner, or translucent.
export class MovingScene {
  readonly group = new Group();
  readonly batches: readonly InstanceBatch[];

  // `standingNode`: shapes of that one stand, and nobody owns them.
  constructor(shapes: readonly MovingShape[], materialFor: (own: Material) => Material = (own) => own, standingNode = -1) {
    this.group.matrixAutoUpdate = false;
    this.batches = [...byGeometryAndMaterial(shapes, standingNode).values()].map(
      (alike) => new InstanceBatch(alike, alike[0].geometry, alike[0].material, alike[0].node === standingNode),
    );
    for (const batch of this.batches) {
      batch.mesh.renderOrder = kBehindProxies;
      this.group.add(batch.mesh);
    }
    this.dress(materialFor);
  }

  dress(materialFor: (own: Material) => Material): void {
    for (const batch of this.batches) batch.mesh.material = batch.standing ? batch.ownMaterial : materialFor(batch.ownMaterial);
  }

  update(frames: RigidFrames, frustum: Frustum, colourOf: Float32Array, groups: ViewGroups | null = null): number {
    let drawn = 0;
    for (const batch of this.batches) drawn += batch.update(frames, frustum, colourOf, groups);
    return drawn;
  }

  place(form: number, nodeFromShape: Matrix4): void {
    for (const batch of this.batches) batch.place(form, nodeFromShape);
  }

  preview(previews: readonly Preview[]): void {
    for (const batch of this.batches) batch.preview(previews);
  }

  remeasure(geometry: BufferGeometry): void {
    for (const batch of this.batches) if (batch.mesh.geometry === geometry) batch.remeasure();
  }

  dispose(): void {
    for (const batch of this.batches) batch.dispose();
    this.group.removeFromParent();
  }
}

function byGeometryAndMaterial(shapes: readonly MovingShape[], standingNode: number): Map<string, MovingShape[]> {
  const groups = new Map<string, MovingShape[]>();
  for (const shape of shapes) {
    const key = `${shape.geometry.uuid} ${shape.material.uuid} ${shape.node === standingNode}`;
    const group = groups.get(key);
    if (group === undefined) groups.set(key, [shape]);
    else group.push(shape);
  }
  return groups;
}
