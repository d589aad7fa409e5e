import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, Quaternion, Vector3 } from 'three';
import type { HierarchyReply } from 'peerd';

import type { Overlay, SceneView } from './scene_view';

// One level of the hierarchy of 18-DOPs of an object, as in the thesis's figure B.9: each volume in a colour of its own.
export class HierarchyMarks implements Overlay {
  private readonly group = new Group();
  private reply: HierarchyReply | null = null;
  private readonly fill = new MeshBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.3, side: DoubleSide, depthWrite: false, fog: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 });
  private readonly line = new LineBasicMaterial({ vertexColors: true, fog: false });

  constructor() {
    this.group.matrixAutoUpdate = false;
    this.group.visible = false;
  }

  // Null: none.
  show(reply: HierarchyReply | null): void {
    this.reply = reply;
    for (const part of [...this.group.children]) {
      part.removeFromParent();
      (part as Mesh).geometry.dispose();
    }
    if (reply === null || reply.volumes.length === 0) return;
    const { corners, cornerColours, edges, edgeColours } = triangles(reply.volumes);
    const faces = new Mesh(geometryOf(corners, cornerColours), this.fill);
    const lines = new LineSegments(geometryOf(edges, edgeColours), this.line);
    faces.frustumCulled = lines.frustumCulled = false;
    faces.renderOrder = 2;
    lines.renderOrder = 3;
    this.group.add(faces, lines);
  }

  update(view: SceneView): void {
    const { reply, group } = this;
    group.visible = reply !== null && group.children.length > 0;
    if (!group.visible || reply === null) return;
    if (group.parent === null) view.scene.add(group);
    if (reply.node !== null && view.frames?.known[reply.node] === 1) view.frames.matrix(reply.node, group.matrix);
    else group.matrix.copy(new Matrix4().compose(new Vector3(...reply.position_m), new Quaternion(...reply.orientation_xyzw), new Vector3(1, 1, 1)));
    group.matrixWorldNeedsUpdate = true;
  }
}

function geometryOf(positions: readonly number[], colours: readonly number[]): BufferGeometry {
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(positions), 3));
  return geometry.setAttribute('color', new BufferAttribute(new Float32Array(colours), 3));
}

// The faces as fans of triangles, and their edges.
export function triangles(volumes: HierarchyReply['volumes']): { corners: number[]; cornerColours: number[]; edges: number[]; edgeColours: number[] } {
  const out = { corners: [] as number[], cornerColours: [] as number[], edges: [] as number[], edgeColours: [] as number[] };
  volumes.forEach((faces, i) => {
    const { r, g, b } = new Color().setHSL((i * 0.618034) % 1, 0.75, 0.5);
    const add = (positions: number[], colours: number[], face: readonly number[], corner: number): void => {
      positions.push(face[3 * corner], face[3 * corner + 1], face[3 * corner + 2]);
      colours.push(r, g, b);
    };
    for (const face of faces) {
      const count = Math.floor(face.length / 3);
      for (let k = 1; k + 1 < count; ++k) for (const corner of [0, k, k + 1]) add(out.corners, out.cornerColours, face, corner);
      for (let k = 0; k < count; ++k) for (const corner of [k, (k + 1) % count]) add(out.edges, out.edgeColours, face, corner);
    }
  });
  return out;
}
