import { DynamicDrawUsage, InstancedBufferAttribute, InstancedMesh, Matrix4, type BufferGeometry, type Frustum, type Material } from 'three';

import { kFrameNumbers, type RigidFrames } from './rigid_frames';
import type { MovingShape } from './scene_file';
import type { ViewGroups } from './view_groups';

// What is at a path and below it, drawn elsewhere in the frame of its node, until the scene is another one.
export interface Preview {
  readonly path: string;
  readonly node: number;
  readonly motion: Matrix4;
}

export function previewAt(previews: readonly Preview[], path: string, node: number): Preview | undefined {
  return previews.find((preview) => preview.node === node && (path === preview.path || path.startsWith(`${preview.path}/`)));
}

// All moving shapes that share one geometry and one material: one draw call. Each picture writes the matrices of those
// instances that the camera can see, one after the other, and draws as many.
export class InstanceBatch {
  readonly mesh: InstancedMesh;
  readonly count: number;
  private readonly nodes: Uint32Array;
  private readonly locals: Float64Array; // nodeFromShape of each instance, column by column
  private readonly centres: Float64Array; // of bounding spheres, in the node's frame
  private readonly radii_m: Float64Array;
  private readonly nodeOfSlot: Uint32Array;
  private readonly instanceOfSlot: Uint32Array;
  private readonly paths: readonly (string | undefined)[];
  private readonly colours: Float32Array;
  private readonly groups: Int32Array; // -1: it is in none
  private readonly forms: Int32Array; // -1: its place in its node never changes
  private readonly turned = new Float64Array(16);
  private readonly scratch = new Matrix4();
  private readonly unmoved = new Map<number, Matrix4>(); // nodeFromShape of the instances that a preview moves
  private readonly leftOut: Uint8Array; // by who knows that it cannot be seen

  constructor(shapes: readonly MovingShape[], geometry: BufferGeometry, readonly ownMaterial: Material, readonly standing = false) {
    this.count = shapes.length;
    this.nodes = Uint32Array.from(shapes, (shape) => shape.node);
    this.leftOut = new Uint8Array(this.count);
    this.groups = Int32Array.from(shapes, (shape) => shape.group ?? -1);
    this.forms = Int32Array.from(shapes, (shape) => shape.form ?? -1);
    this.nodeOfSlot = new Uint32Array(this.count);
    this.instanceOfSlot = new Uint32Array(this.count);
    this.paths = shapes.map(({ path }) => path);
    this.locals = new Float64Array(this.count * 16);
    this.centres = new Float64Array(this.count * 3);
    this.radii_m = new Float64Array(this.count);
    this.mesh = new InstancedMesh(geometry, ownMaterial, this.count);
    this.mesh.frustumCulled = false; // each instance is culled below
    this.mesh.matrixAutoUpdate = false;
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.colours = new Float32Array(this.count * 3).fill(1);
    this.mesh.instanceColor = new InstancedBufferAttribute(this.colours, 3).setUsage(DynamicDrawUsage);
    geometry.computeBoundingSphere();
    shapes.forEach((shape, i) => this.put(i, shape.nodeFromShape));
  }

  // Writes the instances that are in the frustum; `colourOf` has three numbers a node. Returns how many there are.
  update(frames: RigidFrames, frustum: Frustum, colourOf: Float32Array, groups: ViewGroups | null = null): number {
    const out = this.mesh.instanceMatrix.array as Float32Array;
    let slot = 0;
    for (let i = 0; i < this.count; ++i) {
      const node = this.nodes[i];
      const group = this.groups[i];
      if (frames.known[node] === 0 || this.leftOut[i] === 1 || (group >= 0 && groups !== null && groups.visible[group] === 0)) continue;
      if (group >= 0 && groups !== null && groups.turned[group] === 1) {
        compose(groups.turns, group * 16, this.locals, i * 16, this.turned);
        multiply(frames.rows, node * kFrameNumbers, this.turned, 0, out, slot * 16);
      } else {
        if (!this.isVisible(frames.rows, node * kFrameNumbers, i, frustum)) continue;
        multiply(frames.rows, node * kFrameNumbers, this.locals, i * 16, out, slot * 16);
      }
      this.nodeOfSlot[slot] = node;
      this.instanceOfSlot[slot] = i;
      this.colours[slot * 3] = colourOf[node * 3];
      this.colours[slot * 3 + 1] = colourOf[node * 3 + 1];
      this.colours[slot * 3 + 2] = colourOf[node * 3 + 2];
      ++slot;
    }
    this.publish(slot);
    return slot;
  }

  nodeAt(slot: number): number {
    return this.nodeOfSlot[slot];
  }

  pathAt(slot: number): string | undefined {
    return this.paths[this.instanceOfSlot[slot]];
  }

  dispose(): void {
    this.mesh.dispose();
  }

  leaveOut(i: number, out: boolean): void {
    this.leftOut[i] = out ? 1 : 0;
  }

  isHiddenByGroup(i: number, groups: ViewGroups): boolean {
    return this.groups[i] >= 0 && groups.visible[this.groups[i]] === 0;
  }

  // Where an instance is in the world; false: its node is not known.
  worldOf(i: number, frames: RigidFrames, groups: ViewGroups, out: Matrix4): boolean {
    if (frames.known[this.nodes[i]] === 0) return false;
    const group = this.groups[i];
    frames.matrix(this.nodes[i], out);
    if (group >= 0 && groups.turned[group] === 1) out.multiply(this.scratch.fromArray(groups.turns, group * 16));
    out.multiply(this.scratch.fromArray(this.locals, i * 16));
    return true;
  }

  // Moves the shapes of a form to another place in their nodes.
  place(form: number, nodeFromShape: Matrix4): void {
    for (let i = 0; i < this.count; ++i) if (this.forms[i] === form) this.put(i, nodeFromShape);
  }

  preview(previews: readonly Preview[]): void {
    if (previews.length === 0 && this.unmoved.size === 0) return;
    this.paths.forEach((path, i) => {
      const preview = path === undefined ? undefined : previewAt(previews, path, this.nodes[i]);
      const unmoved = this.unmoved.get(i) ?? (preview === undefined ? undefined : new Matrix4().fromArray(this.locals, i * 16));
      if (unmoved === undefined) return;
      this.unmoved.set(i, unmoved);
      this.put(i, preview === undefined ? unmoved : this.scratch.multiplyMatrices(preview.motion, unmoved));
    });
  }

  // The geometry has another shape.
  remeasure(): void {
    for (let i = 0; i < this.count; ++i) this.put(i, this.scratch.fromArray(this.locals, i * 16));
  }

  private put(i: number, nodeFromShape: Matrix4): void {
    const m = nodeFromShape.elements;
    this.locals.set(m, i * 16);
    const sphere = this.mesh.geometry.boundingSphere;
    if (sphere === null) return;
    const c = sphere.center;
    for (let row = 0; row < 3; ++row)
      this.centres[i * 3 + row] = m[row] * c.x + m[4 + row] * c.y + m[8 + row] * c.z + m[12 + row];
    this.radii_m[i] = sphere.radius * nodeFromShape.getMaxScaleOnAxis();
  }

  private isVisible(rows: Float64Array, at: number, i: number, frustum: Frustum): boolean {
    const cx = this.centres[i * 3];
    const cy = this.centres[i * 3 + 1];
    const cz = this.centres[i * 3 + 2];
    const x = rows[at] * cx + rows[at + 1] * cy + rows[at + 2] * cz + rows[at + 3];
    const y = rows[at + 4] * cx + rows[at + 5] * cy + rows[at + 6] * cz + rows[at + 7];
    const z = rows[at + 8] * cx + rows[at + 9] * cy + rows[at + 10] * cz + rows[at + 11];
    for (let p = 0; p < 6; ++p) {
      const plane = frustum.planes[p];
      const n = plane.normal;
      if (n.x * x + n.y * y + n.z * z + plane.constant < -this.radii_m[i]) return false;
    }
    return true;
  }

  private publish(slots: number): void {
    this.mesh.count = slots;
    this.mesh.visible = slots > 0;
    const matrices = this.mesh.instanceMatrix;
    matrices.clearUpdateRanges();
    matrices.addUpdateRange(0, slots * 16);
    matrices.needsUpdate = true;
    const colours = this.mesh.instanceColor;
    if (colours === null) return;
    colours.clearUpdateRanges();
    colours.addUpdateRange(0, slots * 3);
    colours.needsUpdate = true;
  }
}

// The rigid frame (row by row) times an affine matrix (column by column), column by column.
function multiply(a: Float64Array, at: number, b: Float64Array, bt: number, out: Float32Array, ot: number): void {
  for (let column = 0; column < 4; ++column) {
    const x = b[bt + column * 4];
    const y = b[bt + column * 4 + 1];
    const z = b[bt + column * 4 + 2];
    const t = column === 3 ? 1 : 0;
    out[ot + column * 4] = a[at] * x + a[at + 1] * y + a[at + 2] * z + a[at + 3] * t;
    out[ot + column * 4 + 1] = a[at + 4] * x + a[at + 5] * y + a[at + 6] * z + a[at + 7] * t;
    out[ot + column * 4 + 2] = a[at + 8] * x + a[at + 9] * y + a[at + 10] * z + a[at + 11] * t;
    out[ot + column * 4 + 3] = t;
  }
}

// An affine matrix times another one, both column by column.
function compose(a: Float64Array, at: number, b: Float64Array, bt: number, out: Float64Array): void {
  for (let column = 0; column < 4; ++column) {
    const t = column === 3 ? 1 : 0;
    for (let row = 0; row < 3; ++row)
      out[column * 4 + row] = a[at + row] * b[bt + column * 4] + a[at + 4 + row] * b[bt + column * 4 + 1] + a[at + 8 + row] * b[bt + column * 4 + 2] + a[at + 12 + row] * t;
    out[column * 4 + 3] = t;
  }
}
