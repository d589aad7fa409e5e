import { DynamicDrawUsage, InstancedBufferAttribute, InstancedMesh, type MeshBasicMaterial, SphereGeometry } from 'three';

import type { SceneView } from './scene_view';

// Spheres over the picture, in one draw call, with room that grows. Each has a colour where the material has none.
export class SphereInstances {
  private mesh: InstancedMesh | null = null;

  constructor(private readonly geometry: SphereGeometry, private readonly material: MeshBasicMaterial) {}

  hide(): void {
    if (this.mesh !== null) this.mesh.visible = false;
  }

  // A mesh with room for so many.
  withRoom(view: SceneView, count: number): InstancedMesh {
    if (this.mesh !== null && this.mesh.instanceMatrix.count >= count) return this.mesh;
    this.mesh?.removeFromParent();
    this.mesh?.dispose();
    this.mesh = new InstancedMesh(this.geometry, this.material, count);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.mesh.instanceColor = new InstancedBufferAttribute(new Float32Array(3 * count).fill(1), 3);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2;
    view.scene.add(this.mesh);
    return this.mesh;
  }

  // The first ones are drawn, as they have been written.
  show(count: number): void {
    if (this.mesh === null) return;
    this.mesh.count = count;
    this.mesh.visible = count > 0;
    this.mesh.instanceMatrix.needsUpdate = true;
    if (this.mesh.instanceColor !== null) this.mesh.instanceColor.needsUpdate = true;
  }
}

export function writeSphere(out: Float32Array, slot: number, x: number, y: number, z: number, radius_m: number): void {
  const at = 16 * slot;
  out.fill(0, at, at + 16);
  out[at] = out[at + 5] = out[at + 10] = radius_m;
  out[at + 12] = x;
  out[at + 13] = y;
  out[at + 14] = z;
  out[at + 15] = 1;
}
