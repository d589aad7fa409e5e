import { Matrix4 } from 'three';

import type { CameraRig } from './camera_rig';
import type { RigidFrames } from './rigid_frames';

// A camera that was put at the viewpoint of a moving node goes with the node, wherever the user turns it, until another
// viewpoint is chosen.
export class Ride {
  private node: number | null = null;
  private readonly before = new Matrix4();
  private readonly now = new Matrix4();
  private readonly step = new Matrix4();

  begin(node: number, frames: RigidFrames): void {
    this.node = node;
    frames.matrix(node, this.before);
  }

  end(): void {
    this.node = null;
  }

  update(frames: RigidFrames, rig: CameraRig): void {
    if (this.node === null || frames.known[this.node] === 0) return;
    frames.matrix(this.node, this.now);
    this.step.copy(this.before).invert().premultiply(this.now);
    this.before.copy(this.now);
    rig.carry(this.step);
  }
}
