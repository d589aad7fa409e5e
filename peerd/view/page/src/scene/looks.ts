import { BufferAttribute, Color, Light, Matrix4, Mesh, MeshStandardMaterial, SRGBColorSpace, type BufferGeometry, type Material, type Object3D } from 'three';
import { LookKind, type LookRecord } from 'peerd';

import { extrasOf, kFullLight } from './lights';
import type { MovingScene } from './moving_scene';
import type { SceneFile } from './scene_file';

// What a world's ROUTEs change beside poses, brought into the picture: points of a Coordinate, the places of Shapes below a
// driven scale, colours, lights.
interface DrivenMaterial {
  readonly color?: number;
  readonly emissive?: number;
  readonly transparency?: number;
}

type Change = (values: Float32Array) => void;

export class Looks {
  private readonly changes = new Map<number, Change[]>(); // by look
  private readonly geometries = new Map<number, BufferGeometry[]>(); // by form
  private readonly matrix = new Matrix4();

  constructor(file: SceneFile, private readonly drawn: readonly MovingScene[]) {
    const roots: Object3D[] = [file.standing, ...file.carried.map(({ object }) => object)];
    const geometries = new Set<BufferGeometry>(file.shapes.map((shape) => shape.geometry));
    const materials = new Set<Material>(file.shapes.map((shape) => shape.material));
    for (const root of roots) {
      root.traverse((part) => {
        if (part instanceof Light) this.addLight(part);
        if (!(part instanceof Mesh)) return;
        const mesh = part as Mesh<BufferGeometry, Material>;
        geometries.add(mesh.geometry);
        materials.add(mesh.material);
      });
    }
    for (const geometry of geometries) this.addGeometry(geometry);
    for (const material of materials) this.addMaterial(material);
  }

  take(records: readonly LookRecord[]): void {
    for (const { kind, number, values } of records) {
      if (kind === LookKind.points) for (const geometry of this.geometries.get(number) ?? []) this.bend(geometry, values);
      else if (kind === LookKind.place && values.length === 12) this.place(number, values);
      else if (kind === LookKind.value) for (const change of this.changes.get(number) ?? []) change(values);
    }
  }

  private place(form: number, m: Float32Array): void {
    this.matrix.set(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], 0, 0, 0, 1);
    for (const scene of this.drawn) scene.place(form, this.matrix);
  }

  // Which vertices are one is as it was when the scene file was made, and so is where an edge is sharp.
  private bend(geometry: BufferGeometry, points: Float32Array): void {
    const position = geometry.getAttribute('position') as BufferAttribute;
    const point = geometry.getAttribute('_point') as BufferAttribute;
    for (let i = 0; i < position.count; ++i) {
      const at = 3 * point.getX(i);
      if (at + 2 < points.length) position.setXYZ(i, points[at], points[at + 1], points[at + 2]);
    }
    position.needsUpdate = true;
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
    geometry.boundingBox = null;
    for (const scene of this.drawn) scene.remeasure(geometry);
  }

  private addGeometry(geometry: BufferGeometry): void {
    const form = (geometry.userData as { form?: number }).form;
    if (form === undefined || geometry.getAttribute('_point') === undefined) return;
    // The file's arrays may be views that several geometries share.
    const own = (name: string): void => {
      const shared = geometry.getAttribute(name);
      if (shared === undefined) return;
      const copy = new BufferAttribute(new Float32Array(shared.count * 3), 3);
      for (let i = 0; i < shared.count; ++i) copy.setXYZ(i, shared.getX(i), shared.getY(i), shared.getZ(i));
      geometry.setAttribute(name, copy);
    };
    own('position');
    own('normal');
    this.geometries.set(form, [...(this.geometries.get(form) ?? []), geometry]);
  }

  private add(look: number | undefined, change: Change): void {
    if (look !== undefined) this.changes.set(look, [...(this.changes.get(look) ?? []), change]);
  }

  private addMaterial(material: Material): void {
    const { driven } = material.userData as { driven?: DrivenMaterial };
    if (driven === undefined) return;
    const { color } = material as Material & { color?: Color };
    if (color !== undefined) this.add(driven.color, ([r, g, b]) => color.setRGB(r, g, b, SRGBColorSpace));
    if (material instanceof MeshStandardMaterial) this.add(driven.emissive, ([r, g, b]) => material.emissive.setRGB(r, g, b, SRGBColorSpace));
    this.add(driven.transparency, ([transparency]) => {
      material.opacity = Math.min(1, Math.max(0, 1 - transparency));
      material.depthWrite = material.opacity >= 1;
    });
  }

  private addLight(light: Light): void {
    const extras = extrasOf(light);
    this.add(extras.driven_on, ([on]) => (light.visible = on !== 0));
    this.add(extras.driven_color, ([r, g, b]) => light.color.setRGB(r, g, b, SRGBColorSpace));
    this.add(extras.driven_intensity, ([intensity]) => (light.intensity = (kFullLight * Math.min(1, Math.max(0, intensity))) / (extras.fades ?? 1)));
  }
}
