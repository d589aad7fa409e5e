import { Color } from 'three';
import { PoseFlag, type PoseTable } from 'peerd';

import type { SceneNode } from './scene_file';

// The colour of each node: white where it is drawn in its world's own materials, and by its owner as in the thesis's
// figure B.13: red what this peer owns, cyan what another one owns, grey what nobody owns. Amber is, in either case, what
// two peers have lately shown at different places.
export type Colouring = 'world' | 'owner';
const kOwn = new Color('#e5484d');
const kRemote = new Color('#22b8cf');
const kNobodys = new Color('#9aa3ad');
const kDiffers = new Color('#f59f00');
const kWhite = new Color('#ffffff');
const kSelected = new Color(1.45, 1.3, 0.75);

export class OwnerColours {
  readonly rgb: Float32Array;

  constructor(nodeCount: number) {
    this.rgb = new Float32Array(nodeCount * 3).fill(1);
  }

  update(nodes: readonly SceneNode[], table: PoseTable, colouring: Colouring, selected: number | null): void {
    for (let i = 0; i < nodes.length; ++i) {
      const node = nodes[i].index;
      const differs = (table.flags[node] & PoseFlag.differs) !== 0;
      const colour = differs ? kDiffers : colouring === 'world' ? kWhite : byOwner(table.owner[node], table.flags[node]);
      const tint = node === selected ? kSelected : kWhite;
      this.rgb[node * 3] = colour.r * tint.r;
      this.rgb[node * 3 + 1] = colour.g * tint.g;
      this.rgb[node * 3 + 2] = colour.b * tint.b;
    }
  }
}

function byOwner(owner: number, flags: number): Color {
  if ((flags & PoseFlag.own) !== 0) return kOwn;
  return owner === 0 ? kNobodys : kRemote;
}
