import { Group, type Frustum, type Material } from 'three';

import { InstanceBatch } from './instance_batch';
import type { RigidFrames } from './rigid_frames';
import type { MovingShape } from './scene_file';

// All that moves, in as few draw calls as it has pairs of a geometry and a material. `materialFor` may draw it otherwise
// than its world does: by owner, or translucent.
export class MovingScene {
  readonly group = new Group();
  readonly batches: readonly InstanceBatch[];

  constructor(shapes: readonly MovingShape[], materialFor: (own: Material) => Material = (own) => own) {
    this.group.matrixAutoUpdate = false;
    this.batches = [...byGeometryAndMaterial(shapes).values()].map(
      (alike) => new InstanceBatch(alike, alike[0].geometry, alike[0].material),
    );
    for (const batch of this.batches) this.group.add(batch.mesh);
    this.dress(materialFor);
  }

  dress(materialFor: (own: Material) => Material): void {
    for (const batch of this.batches) batch.mesh.material = materialFor(batch.ownMaterial);
  }

  update(frames: RigidFrames, frustum: Frustum, colourOf: Float32Array): number {
    let drawn = 0;
    for (const batch of this.batches) drawn += batch.update(frames, frustum, colourOf);
    return drawn;
  }

  dispose(): void {
    for (const batch of this.batches) batch.dispose();
    this.group.removeFromParent();
  }
}

function byGeometryAndMaterial(shapes: readonly MovingShape[]): Map<string, MovingShape[]> {
  const groups = new Map<string, MovingShape[]>();
  for (const shape of shapes) {
    const key = `${shape.geometry.uuid} ${shape.material.uuid}`;
    const group = groups.get(key);
    if (group === undefined) groups.set(key, [shape]);
    else group.push(shape);
  }
  return groups;
}
