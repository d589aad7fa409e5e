import { Matrix4, Vector3, type Camera } from 'three';

import { kFrameNumbers, type RigidFrames } from './rigid_frames';

// What VRML lets the viewer decide of a scene: the level of an LOD by the distance of the camera, the turn of a Billboard. A
// Shape names the innermost group that it is in.
export interface GroupExtras {
  readonly kind: 'level' | 'billboard' | 'anchor';
  readonly path: string;
  readonly node: number; // of the file: it moves with that one
  readonly above?: number; // the next group outwards
  readonly node_from_group: readonly number[]; // three rows of four
  readonly number?: number; // of the level
  readonly count?: number; // of levels
  readonly center?: readonly [number, number, number];
  readonly range?: readonly number[];
  readonly axis?: readonly [number, number, number];
  readonly url?: readonly string[];
  readonly description?: string;
}

export class ViewGroups {
  readonly count: number;
  readonly visible: Uint8Array;
  readonly turned: Uint8Array; // a Billboard turns what is in the group
  readonly turns: Float64Array; // for each group nodeFromNode, column by column, where it is turned
  private readonly nodeFromGroup: readonly Matrix4[];
  private readonly frame = new Matrix4();
  private readonly turn = new Matrix4();
  private readonly inner = new Matrix4();
  private readonly back = new Matrix4();
  private readonly eye = new Vector3();
  private readonly up = new Vector3();

  constructor(private readonly groups: readonly GroupExtras[]) {
    this.count = groups.length;
    this.visible = new Uint8Array(groups.length).fill(1);
    this.turned = new Uint8Array(groups.length);
    this.turns = new Float64Array(groups.length * 16);
    this.nodeFromGroup = groups.map(({ node_from_group: m }) => new Matrix4().set(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], 0, 0, 0, 1));
  }

  update(frames: RigidFrames, camera: Camera): void {
    for (let i = 0; i < this.count; ++i) {
      const group = this.groups[i];
      const above = group.above ?? -1;
      this.visible[i] = above < 0 ? 1 : this.visible[above];
      this.turned[i] = above < 0 ? 0 : this.turned[above];
      if (above >= 0 && this.turned[above] === 1) this.turns.copyWithin(i * 16, above * 16, above * 16 + 16);
      if (this.visible[i] === 0) continue;
      if (group.kind === 'level') this.visible[i] = this.levelOf(i, frames, camera) === group.number ? 1 : 0;
      else if (group.kind === 'billboard') this.face(i, frames, camera);
    }
  }

  private levelOf(i: number, frames: RigidFrames, camera: Camera): number {
    const { center = [0, 0, 0], range = [], count = 1 } = this.groups[i];
    this.enter(i, frames, camera);
    return levelAt(Math.hypot(this.eye.x - center[0], this.eye.y - center[1], this.eye.z - center[2]), range, count);
  }

  private face(i: number, frames: RigidFrames, camera: Camera): void {
    const [x, y, z] = this.groups[i].axis ?? [0, 1, 0];
    this.enter(i, frames, camera);
    billboardTurn(new Vector3(x, y, z), this.eye, this.up, this.turn);
    this.inner.copy(this.nodeFromGroup[i]).multiply(this.turn).multiply(this.back.copy(this.nodeFromGroup[i]).invert());
    if (this.turned[i] === 1) this.inner.premultiply(this.frame.fromArray(this.turns, i * 16));
    this.inner.toArray(this.turns, i * 16);
    this.turned[i] = 1;
  }

  // The camera's place and upper edge in the group's own frame, which the groups above have turned.
  private enter(i: number, frames: RigidFrames, camera: Camera): void {
    const { node } = this.groups[i];
    if (node * kFrameNumbers < frames.rows.length && frames.known[node] === 1) frames.matrix(node, this.frame);
    else this.frame.identity();
    if (this.turned[i] === 1) this.frame.multiply(this.inner.fromArray(this.turns, i * 16));
    this.frame.multiply(this.nodeFromGroup[i]).invert();
    this.eye.setFromMatrixPosition(camera.matrixWorld).applyMatrix4(this.frame);
    this.up.setFromMatrixColumn(camera.matrixWorld, 1).transformDirection(this.frame);
  }
}

// With ranges r0 < r1 < .. there is a level for each span between them; a distance that is a range is in the farther one. Where
// there are fewer levels, the last one is shown; without ranges, the first.
export function levelAt(distance: number, ranges: readonly number[], count: number): number {
  const nearer = ranges.findIndex((range) => distance < range);
  return Math.min(nearer < 0 ? ranges.length : nearer, count - 1);
}

// The turn about `axis` that brings +Z as near as it can to `eye`, both in the Billboard's own frame; without an axis, +Z looks
// at the eye and +Y is the picture's upper edge (ISO/IEC 14772-1, 6.6).
export function billboardTurn(axis: Vector3, eye: Vector3, up: Vector3, out: Matrix4): Matrix4 {
  if (eye.lengthSq() === 0) return out.identity();
  const to = eye.clone().normalize();
  if (axis.lengthSq() === 0) {
    const x = new Vector3().crossVectors(up, to);
    if (x.lengthSq() < 1e-12) return out.identity();
    x.normalize();
    return out.makeBasis(x, new Vector3().crossVectors(to, x), to);
  }
  const n = axis.clone().normalize();
  const from = new Vector3(0, 0, 1).addScaledVector(n, -n.z);
  const wanted = to.addScaledVector(n, -to.dot(n));
  if (from.lengthSq() < 1e-12 || wanted.lengthSq() < 1e-12) return out.identity(); // +Z, or the eye, is on the axis
  const angle = Math.atan2(n.dot(new Vector3().crossVectors(from, wanted)), from.dot(wanted));
  return out.makeRotationAxis(n, angle);
}
