import type { SceneFile } from '../scene/scene_file';

// Scene files of different revisions number their nodes otherwise; ids stay. This says which node of the present file the
// nodes of an earlier one are.
const kMostRevisions = 64;

export class NodeIds {
  private readonly idsOf = new Map<number, ReadonlyMap<number, string>>();
  private present = -1;
  private readonly kept = new Map<number, Int32Array>();

  add(file: Pick<SceneFile, 'revision' | 'nodes'>): void {
    this.idsOf.set(file.revision, new Map(file.nodes.map((node) => [node.index, node.id])));
    this.present = file.revision;
    this.kept.clear();
    while (this.idsOf.size > kMostRevisions) this.idsOf.delete([...this.idsOf.keys()][0]);
  }

  // What comes next are the scenes of another view, which counts its revisions itself.
  forgetAll(): void {
    this.idsOf.clear();
    this.kept.clear();
    this.present = -1;
  }

  knows(revision: number): boolean {
    return this.idsOf.has(revision);
  }

  // By node of that revision the present node, -1 where there is none; undefined: they are the same.
  nodeOf(revision: number): Int32Array | undefined {
    if (revision === this.present) return undefined;
    const known = this.kept.get(revision);
    if (known !== undefined) return known;
    const made = this.compare(revision);
    this.kept.set(revision, made);
    return made;
  }

  private compare(revision: number): Int32Array {
    const now = new Map([...(this.idsOf.get(this.present) ?? [])].map(([node, id]) => [id, node]));
    const then = this.idsOf.get(revision) ?? new Map<number, string>();
    const last = Math.max(-1, ...then.keys());
    const nodes = new Int32Array(last + 1).fill(-1);
    for (const [node, id] of then) nodes[node] = now.get(id) ?? -1;
    return nodes;
  }
}
