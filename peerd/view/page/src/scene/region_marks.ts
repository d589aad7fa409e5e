import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial } from 'three';
import type { SurroundingsReply } from 'peerd';

import { cellsIn, type Cell } from './region_cells';
import type { Overlay, SceneView } from './scene_view';

// The grid of regions on the world's floor: the regions that this peer has joined are blue, those that its own objects are in
// have a red edge, and all others are lines alone.
const kMost = 2500;
const kJoined = new Color('#3b82f6');
const kOwn = new Color('#e5484d');
const kOther = new Color('#8a94a0');
const kInset = 0.015; // of a cell, so that neighbours' edges are told apart

export class RegionMarks implements Overlay {
  visible = false;
  private readonly group = new Group();
  private shown: { reply: SurroundingsReply; revision: number } | null = null;
  private readonly fill = new MeshBasicMaterial({ color: kJoined, transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false, fog: false });
  private readonly line = new LineBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.85, depthTest: false, fog: false });

  constructor(private readonly newest: () => SurroundingsReply | null) {
    this.group.matrixAutoUpdate = false;
  }

  update(view: SceneView): void {
    const reply = this.newest();
    this.group.visible = this.visible && reply !== null;
    if (!this.group.visible || reply === null) return;
    const revision = view.file?.revision ?? -1;
    if (this.group.parent === null) view.scene.add(this.group);
    if (this.shown?.reply.regions === reply.regions && this.shown.revision === revision) return;
    const same = this.shown !== null && this.shown.revision === revision && JSON.stringify(this.shown.reply.regions) === JSON.stringify(reply.regions);
    this.shown = { reply, revision };
    if (!same) this.rebuild(view, reply);
  }

  private rebuild(view: SceneView, { regions }: SurroundingsReply): void {
    for (const part of [...this.group.children]) {
      part.removeFromParent();
      (part as Mesh).geometry.dispose();
    }
    const box = view.bounds();
    if (box.isEmpty()) return;
    const cells = cellsIn(regions, [box.min.x, box.min.y, box.min.z], [box.max.x, box.max.y, box.max.z], kMost);
    const joined = new Set(regions.joined);
    const own = new Set(regions.published);
    const height = 0.002 * box.max.distanceTo(box.min);
    const corners: number[] = [];
    const edges: number[] = [];
    const colours: number[] = [];
    for (const cell of cells) {
      if (joined.has(cell.region)) corners.push(...floorOf(cell, height));
      const colour = own.has(cell.region) ? kOwn : joined.has(cell.region) ? kJoined : kOther;
      const outline = outlineOf(cell, height);
      edges.push(...outline);
      for (let i = 0; i < outline.length / 3; ++i) colours.push(colour.r, colour.g, colour.b);
    }
    const faces = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(corners), 3));
    const lines = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(edges), 3));
    lines.setAttribute('color', new BufferAttribute(new Float32Array(colours), 3));
    const floor = new Mesh(faces, this.fill);
    const grid = new LineSegments(lines, this.line);
    floor.renderOrder = 1;
    grid.renderOrder = 3;
    floor.frustumCulled = grid.frustumCulled = false;
    this.group.add(floor, grid);
  }
}

function floorOf({ lo, hi }: Cell, height: number): number[] {
  const y = lo[1] + height;
  return [lo[0], y, lo[2], lo[0], y, hi[2], hi[0], y, hi[2], lo[0], y, lo[2], hi[0], y, hi[2], hi[0], y, lo[2]];
}

function outlineOf({ lo, hi }: Cell, height: number): number[] {
  const y = lo[1] + height;
  const inset = kInset * Math.min(hi[0] - lo[0], hi[2] - lo[2]);
  const [x0, x1, z0, z1] = [lo[0] + inset, hi[0] - inset, lo[2] + inset, hi[2] - inset];
  return [x0, y, z0, x1, y, z0, x1, y, z0, x1, y, z1, x1, y, z1, x0, y, z1, x0, y, z1, x0, y, z0];
}
