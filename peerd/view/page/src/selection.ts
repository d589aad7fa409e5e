import type { Inspected } from 'peerd';

import type { PeerLink } from './live/peer_link';
import type { InspectorPanel } from './panels/inspector_panel';
import { hasNode, nodeAround, type SceneFile } from './scene/scene_file';

// What is selected, by its path, which outlasts edits of the scene; the inspector asks the daemon for it again and again.
export class Selection {
  private path_: string | null = null;
  private node_: number | null = null;
  private moves = false;
  private asking = false;
  // Of a recording, where there is nobody to ask: what its frames say of a node.
  recordedOf: ((node: number) => { readonly owner: number; readonly own: boolean; readonly driven: boolean }) | null = null;
  onChange: ((node: number | null) => void) | null = null;

  constructor(private readonly link: PeerLink, private readonly inspector: InspectorPanel) {}

  get node(): number | null {
    return this.node_;
  }
  // Where it is one of the nodes that can move: by that number its poses come.
  get movingNode(): number | null {
    return this.moves ? this.node_ : null;
  }
  get path(): string | null {
    return this.path_;
  }

  // `moves`: it is one of the nodes that can move, by whose number `node` its poses come. Else that is the node that it goes with.
  choose(node: number, path: string, moves: boolean): void {
    this.moves = moves;
    this.node_ = node;
    this.path_ = path;
    this.onChange?.(node);
    void this.refresh();
  }

  clear(): void {
    this.node_ = this.path_ = null;
    this.inspector.clear();
    this.onChange?.(null);
  }

  // A new scene file counts its nodes otherwise; what is not in it any more is not selected.
  follow(file: SceneFile): void {
    if (this.path_ === null) return;
    this.moves = file.byPath.has(this.path_);
    if (this.moves) this.node_ = file.byPath.get(this.path_)?.index ?? null;
    else if (hasNode(file, this.path_)) this.node_ = nodeAround(file, this.path_);
    else this.clear();
    void this.refresh();
  }

  async refresh(): Promise<void> {
    if (this.node_ === null || this.path_ === null || this.asking) return;
    if (this.recordedOf !== null) {
      if (!this.moves) {
        this.inspector.showStanding(this.path_);
        return;
      }
      const { owner, own, driven } = this.recordedOf(this.node_);
      this.inspector.showRecorded(this.path_, owner, own, driven);
      return;
    }
    this.asking = true;
    const path = this.path_;
    const reply = await this.link.ask(this.moves ? { do: 'inspect', node: this.node_ } : { do: 'inspect', path });
    this.asking = false;
    if (path !== this.path_) void this.refresh();
    else if (reply.ok) this.inspector.show(reply as unknown as Inspected);
    else this.inspector.fault(path, reply.error ?? 'the daemon does not say what it is');
  }
}
