import { Matrix4, Mesh, TextureLoader, type BufferGeometry, type Material, type Object3D } from 'three';
import { GLTFLoader, type GLTF, type GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

import type { SensorExtras } from '../hand/sensor_rules';
import { setLights } from './lights';
import { NodeTree, type TreeExtras } from './node_tree';
import type { TextExtras } from './text_layout';
import { textShape } from './text_shape';
import type { GroupExtras } from './view_groups';

// scene.glb as the page needs it: what stands, and for each node that can move its shapes in the node's own frame.
export interface SceneNode {
  readonly index: number; // in the file's "nodes": what pose frames count
  readonly id: string;
  readonly path: string;
  readonly def: string;
  readonly owner: number; // 0: nobody
  readonly pose: Float64Array; // x y z, qx qy qz qw: where the file has it
}

export interface MovingShape {
  readonly node: number;
  readonly geometry: BufferGeometry;
  readonly material: Material;
  readonly nodeFromShape: Matrix4;
  readonly path?: string | undefined;
  readonly group?: number | undefined; // the innermost group that it is in
  readonly form?: number | undefined; // its place changes: which of the forms it is
}

// The lights of a moving node, below an object whose matrix is the node's frame.
export interface CarriedLights {
  readonly node: number;
  readonly object: Object3D;
}

export interface Viewpoint {
  readonly def?: string;
  readonly description: string;
  readonly position_m: readonly [number, number, number]; // in the frame of `node`, or of the world without one
  readonly orientation_xyzw: readonly [number, number, number, number];
  readonly field_of_view_rad: number;
  readonly node?: number;
}

export interface SceneExtras {
  readonly revision?: number;
  readonly world?: string;
  readonly viewpoints?: readonly Viewpoint[];
  readonly background?: Record<string, unknown>;
  readonly fog?: Record<string, unknown>;
  readonly navigation?: { readonly type?: string | readonly string[]; readonly speed?: number; readonly headlight?: boolean; readonly avatar_size?: readonly number[] };
  readonly groups?: readonly GroupExtras[];
  readonly sensors?: readonly SensorExtras[];
  readonly tree?: TreeExtras;
  readonly undrawn?: readonly { readonly path: string; readonly what: string; readonly why: string; readonly count?: number }[];
}

export interface SceneFile {
  readonly revision: number;
  readonly extras: SceneExtras;
  readonly nodeCount: number;
  readonly nodes: readonly SceneNode[];
  readonly byPath: ReadonlyMap<string, SceneNode>;
  readonly tree: NodeTree; // of all nodes, drawn or not
  readonly standingNode: number; // all that stands
  readonly shapes: readonly MovingShape[];
  readonly carried: readonly CarriedLights[];
  readonly hasLights: boolean; // of its own, beside the headlight
  readonly standing: Object3D;
}

export async function loadSceneFile(address: string): Promise<SceneFile> {
  const reply = await fetch(address, { cache: 'no-cache' });
  if (!reply.ok) throw new Error(`${address} is ${reply.status}: ${await reply.text()}`);
  return parseSceneFile(await reply.arrayBuffer());
}

export async function parseSceneFile(bytes: ArrayBuffer): Promise<SceneFile> {
  const loader = new GLTFLoader();
  loader.register((parser) => new ImagesByElement(parser));
  return taken(await loader.parseAsync(bytes, ''));
}

// Images inside the file are decoded by image elements: the page's policy allows them blob: addresses, but no fetch of one.
class ImagesByElement {
  readonly name = 'images_by_element';
  constructor(parser: GLTFParser) {
    parser.textureLoader = new TextureLoader(parser.options.manager);
  }
}

interface NodeExtras {
  id?: string;
  path?: string;
  def?: string;
  owner?: number;
  static?: boolean;
  group?: number;
  form?: number;
  text?: TextExtras;
  node_from_shape?: readonly number[];
}

function taken(gltf: GLTF): SceneFile {
  const root = gltf.scene;
  root.updateMatrixWorld(true);
  const extras = ((gltf.asset as { extras?: SceneExtras }).extras ?? {}) as SceneExtras;
  const nodes: SceneNode[] = [];
  const shapes: MovingShape[] = [];
  const carried: CarriedLights[] = [];
  let standingNode = -1;
  for (const object of [...root.children]) {
    const data = object.userData as NodeExtras;
    const index = gltf.parser.associations.get(object)?.nodes;
    if (data.static === true && index !== undefined) {
      standingNode = index;
      collectShapes(object, index, shapes, true);
      continue;
    }
    if (data.id === undefined || index === undefined) continue;
    nodes.push(nodeOf(object, index, data));
    collectShapes(object, index, shapes, false);
    root.remove(object);
    if (keepsLightsAlone(object)) carried.push({ node: index, object });
  }
  const lightCount = carried.length + setLights(root);
  root.traverse((object) => {
    object.matrixAutoUpdate = false;
  });
  const json = gltf.parser.json as { nodes?: unknown[] };
  const byPath = new Map(nodes.map((node) => [node.path, node]));
  return { revision: extras.revision ?? 0, extras, nodeCount: json.nodes?.length ?? 0, nodes, byPath, tree: new NodeTree(extras.tree), standingNode, shapes, carried, hasLights: lightCount > 0, standing: root };
}

function nodeOf(object: Object3D, index: number, data: NodeExtras): SceneNode {
  const { position: p, quaternion: q } = object;
  return {
    index,
    id: data.id ?? '',
    path: data.path ?? '',
    def: data.def ?? '',
    owner: data.owner ?? 0,
    pose: new Float64Array([p.x, p.y, p.z, q.x, q.y, q.z, q.w]),
  };
}

// Of what stands only those Shapes that the viewer has something to do for, and these are taken out of it.
function collectShapes(object: Object3D, node: number, shapes: MovingShape[], standing: boolean): void {
  const nodeFromWorld = object.matrixWorld.clone().invert();
  const taken: Object3D[] = [];
  object.traverse((part) => {
    const of = shapeExtras(part);
    const viewed = { path: of.path, group: of.group, form: of.form };
    const { text, node_from_shape: m } = part.userData as NodeExtras;
    if (text !== undefined && m !== undefined) {
      const drawn = textShape(text);
      const nodeFromShape = new Matrix4().set(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], 0, 0, 0, 1);
      if (drawn !== null) shapes.push({ node, ...drawn, nodeFromShape, ...viewed });
    }
    if (!(part instanceof Mesh) || (standing && of.group === undefined && of.form === undefined)) return;
    const mesh = part as Mesh<BufferGeometry, Material>;
    const nodeFromShape = new Matrix4().multiplyMatrices(nodeFromWorld, mesh.matrixWorld);
    shapes.push({ node, geometry: mesh.geometry, material: mesh.material, nodeFromShape, ...viewed });
    taken.push(part);
  });
  if (standing) for (const part of taken) part.removeFromParent();
}

// A sheared Shape is two objects, of which the upper one has the extras.
function shapeExtras(part: Object3D): NodeExtras {
  const own = part.userData as NodeExtras;
  return own.id === undefined && part.parent !== null ? (part.parent.userData as NodeExtras) : own;
}

// Takes all meshes out of a node, and says whether it has lights.
function keepsLightsAlone(object: Object3D): boolean {
  const meshes: Object3D[] = [];
  object.traverse((part) => {
    if (part instanceof Mesh) meshes.push(part);
  });
  for (const mesh of meshes) mesh.removeFromParent();
  object.matrixAutoUpdate = false;
  return setLights(object) > 0;
}

// Whether a path names a node of the world.
export function hasNode(file: Pick<SceneFile, 'byPath' | 'tree'>, path: string): boolean {
  return file.byPath.has(path) || file.tree.rowOf(path) >= 0;
}

// The node of the file that what is at a path moves with: itself, the nearest one above it that can move, or that of all that stands.
export function nodeAround(file: Pick<SceneFile, 'byPath' | 'standingNode'>, path: string): number {
  for (let above = path; above !== ''; above = above.slice(0, Math.max(0, above.lastIndexOf('/')))) {
    const node = file.byPath.get(above);
    if (node !== undefined) return node.index;
  }
  return file.standingNode;
}
