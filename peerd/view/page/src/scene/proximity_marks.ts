import { Color, MeshBasicMaterial, SphereGeometry } from 'three';
import type { SurroundingsReply } from 'peerd';

import { kFrameNumbers } from './rigid_frames';
import type { Overlay, SceneView } from './scene_view';
import { SphereInstances, writeSphere } from './sphere_instances';

// Proximity spheres (the thesis, 4.4.2): of each object that interests name its bounding sphere, and how far it goes within the
// time that counts as close. Where spheres of two peers' objects meet, a collision may be near, and the owner's threshold is
// tight: such a sphere is red.
const kUsual = new Color('#2fa36b');
const kTight = new Color('#e5484d');

export class ProximityMarks implements Overlay {
  visible = false;
  count = 0; // that are drawn
  private readonly spheres = new SphereInstances(
    new SphereGeometry(1, 24, 14),
    new MeshBasicMaterial({ wireframe: true, transparent: true, opacity: 0.3, depthWrite: false, fog: false }),
  );

  constructor(private readonly newest: () => SurroundingsReply | null) {}

  update(view: SceneView): void {
    const objects = (this.visible ? this.newest()?.proximity.objects : undefined) ?? [];
    const { frames } = view;
    this.count = 0;
    if (objects.length === 0 || frames === null) {
      this.spheres.hide();
      return;
    }
    const mesh = this.spheres.withRoom(view, objects.length);
    const out = mesh.instanceMatrix.array as Float32Array;
    for (const { node, center_m: c, radius_m, range_m, tight } of objects) {
      if (frames.known[node] !== 1) continue;
      const r = frames.rows;
      const row = node * kFrameNumbers;
      const along = (axis: number): number => r[row + 4 * axis] * c[0] + r[row + 4 * axis + 1] * c[1] + r[row + 4 * axis + 2] * c[2] + r[row + 4 * axis + 3];
      writeSphere(out, this.count, along(0), along(1), along(2), radius_m + range_m);
      mesh.setColorAt(this.count, tight ? kTight : kUsual);
      ++this.count;
    }
    this.spheres.show(this.count);
  }
}
