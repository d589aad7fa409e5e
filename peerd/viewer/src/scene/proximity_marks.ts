import { Color, DynamicDrawUsage, InstancedBufferAttribute, InstancedMesh, MeshBasicMaterial, SphereGeometry } from 'three';

import type { SurroundingsReply } from '../live/surroundings';
import { kFrameNumbers } from './rigid_frames';
import type { Overlay, SceneView } from './scene_view';

// Proximity spheres (the thesis, 4.4.2): of each object that interests name its bounding sphere, and how far it goes within the
// time that counts as close. Where spheres of two peers' objects meet, a collision may be near, and the owner's threshold is
// tight: such a sphere is red.
const kUsual = new Color('#2fa36b');
const kTight = new Color('#e5484d');

export class ProximityMarks implements Overlay {
  visible = false;
  count = 0; // that are drawn
  private mesh: InstancedMesh | null = null;
  private readonly geometry = new SphereGeometry(1, 24, 14);
  private readonly material = new MeshBasicMaterial({ wireframe: true, transparent: true, opacity: 0.3, depthWrite: false, fog: false });

  constructor(private readonly newest: () => SurroundingsReply | null) {}

  update(view: SceneView): void {
    const objects = (this.visible ? this.newest()?.proximity.objects : undefined) ?? [];
    const { frames } = view;
    this.count = 0;
    if (objects.length === 0 || frames === null) {
      if (this.mesh !== null) this.mesh.visible = false;
      return;
    }
    const mesh = this.meshFor(view, objects.length);
    const out = mesh.instanceMatrix.array as Float32Array;
    for (const { node, center_m: c, radius_m, range_m, tight } of objects) {
      if (frames.known[node] !== 1) continue;
      const r = frames.rows;
      const row = node * kFrameNumbers;
      const at = 16 * this.count;
      out.fill(0, at, at + 16);
      out[at] = out[at + 5] = out[at + 10] = radius_m + range_m;
      for (let axis = 0; axis < 3; ++axis) out[at + 12 + axis] = r[row + 4 * axis] * c[0] + r[row + 4 * axis + 1] * c[1] + r[row + 4 * axis + 2] * c[2] + r[row + 4 * axis + 3];
      out[at + 15] = 1;
      mesh.setColorAt(this.count, tight ? kTight : kUsual);
      ++this.count;
    }
    mesh.count = this.count;
    mesh.visible = this.count > 0;
    mesh.instanceMatrix.needsUpdate = true;
    if (mesh.instanceColor !== null) mesh.instanceColor.needsUpdate = true;
  }

  private meshFor(view: SceneView, count: number): InstancedMesh {
    if (this.mesh !== null && this.mesh.instanceMatrix.count >= count) return this.mesh;
    this.mesh?.removeFromParent();
    this.mesh?.dispose();
    this.mesh = new InstancedMesh(this.geometry, this.material, count);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.mesh.instanceColor = new InstancedBufferAttribute(new Float32Array(3 * count), 3);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 2;
    view.scene.add(this.mesh);
    return this.mesh;
  }
}
