// Which nodes the rows of pose frames count: those of the scene's glTF binary, of which the JSON chunk alone is read.
//
//   0 u32 magic "glTF"   4 u32 version 2   8 u32 length   12 u32 length of the chunk   16 u32 type "JSON"   20 the JSON
const kMagic = 0x46546c67;
const kJson = 0x4e4f534a;
const kBegin = 20;

/** A node of the world that can move by itself. */
export interface SceneNode {
  /** In the scene's "nodes", as rows of pose frames have it. */
  readonly index: number;
  readonly path: string;
}

export interface SceneNodes {
  /** Of the scene; pose frames of another one count other nodes. */
  readonly revision: number;
  readonly nodeCount: number;
  readonly nodes: readonly SceneNode[];
  readonly byPath: ReadonlyMap<string, SceneNode>;
}

interface Gltf {
  readonly asset?: { readonly extras?: { readonly revision?: number } };
  readonly nodes?: readonly { readonly extras?: { readonly id?: string; readonly path?: string } }[];
}

/** The nodes of `scene.glb`. Throws an Error that says what is wrong with the file. */
export function sceneNodes(file: ArrayBuffer): SceneNodes {
  const view = new DataView(file);
  if (file.byteLength < kBegin || view.getUint32(0, true) !== kMagic || view.getUint32(16, true) !== kJson) throw new Error('the scene is no glTF binary');
  const length = view.getUint32(12, true);
  if (kBegin + length > file.byteLength) throw new Error('the scene is cut off');
  const gltf = JSON.parse(new TextDecoder().decode(new Uint8Array(file, kBegin, length))) as Gltf;
  const all = gltf.nodes ?? [];
  const nodes = all.flatMap(({ extras }, index) => (extras?.id === undefined || extras.path === undefined ? [] : [{ index, path: extras.path }]));
  return { revision: gltf.asset?.extras?.revision ?? 0, nodeCount: all.length, nodes, byPath: new Map(nodes.map((node) => [node.path, node])) };
}
