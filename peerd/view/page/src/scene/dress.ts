import { MeshStandardMaterial, type Material } from 'three';

import type { Colouring } from './owner_colours';

// The material that a shape is drawn with: its own; one plain white one, which a batch's colours tint by owner; or the
// pale one of ghosts.
export class Dress {
  private readonly made = new Map<string, MeshStandardMaterial>();

  materialFor(own: Material, colouring: Colouring): Material {
    return colouring === 'world' || (own.userData as { text?: boolean }).text === true ? own : this.plainLike(own, false);
  }

  // What all others predict is drawn as a pale copy beside the truth.
  ghostMaterialFor(own: Material): Material {
    return this.plainLike(own, true);
  }

  private plainLike(own: Material, ghost: boolean): MeshStandardMaterial {
    const key = `${own.side} ${ghost}`;
    const kept = this.made.get(key);
    if (kept !== undefined) return kept;
    const material = new MeshStandardMaterial({ color: ghost ? 0xffc53d : 0xffffff, roughness: 0.75, metalness: 0, side: own.side });
    if (ghost) {
      material.transparent = true;
      material.opacity = 0.4;
      material.depthWrite = false;
      material.polygonOffset = true; // a ghost that is right lies behind the truth, and does not flicker through it
      material.polygonOffsetFactor = material.polygonOffsetUnits = 1;
    }
    this.made.set(key, material);
    return material;
  }
}
