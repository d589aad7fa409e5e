import type { PeerLink } from './live/peer_link';
import type { Inspected } from './live/replies';
import type { InspectorPanel } from './panels/inspector_panel';
import type { SceneFile } from './scene/scene_file';

// What is selected, by its path, which outlasts edits of the scene; the inspector asks the daemon for it again and again.
export class Selection {
  private path_: string | null = null;
  private node_: number | null = null;
  private asking = false;
  onChange: ((node: number | null) => void) | null = null;

  constructor(private readonly link: PeerLink, private readonly inspector: InspectorPanel) {}

  get node(): number | null {
    return this.node_;
  }
  get path(): string | null {
    return this.path_;
  }

  choose(node: number, path: string): void {
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
    const node = file.byPath.get(this.path_);
    if (node === undefined) this.clear();
    else this.node_ = node.index;
    void this.refresh();
  }

  async refresh(): Promise<void> {
    if (this.node_ === null || this.path_ === null || this.asking) return;
    this.asking = true;
    const path = this.path_;
    const reply = await this.link.ask({ do: 'inspect', node: this.node_ });
    this.asking = false;
    if (path !== this.path_) void this.refresh();
    else if (reply.ok) this.inspector.show(reply as unknown as Inspected);
    else this.inspector.fault(path, reply.error ?? 'the daemon does not say what it is');
  }
}
