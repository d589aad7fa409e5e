import type { Ask } from './edits';

// What the peer says of its interest and its adaptive thresholds, and of the hierarchy of what is selected
// (docs/reference/gateway.md). It is asked for only while something shows it.
export interface Regions {
  readonly cell_m: number; // 0: the scene is not cut
  readonly counts: readonly [number, number, number];
  readonly margin_m: number;
  readonly joined: readonly number[];
  readonly published: readonly number[]; // in which own objects are
}

export interface ProximitySphere {
  readonly node: number;
  readonly center_m: readonly [number, number, number]; // in the node's frame
  readonly radius_m: number;
  readonly range_m: number; // how far it goes within the time that counts as close
  readonly tight: boolean;
}

export interface SurroundingsReply {
  readonly regions: Regions;
  readonly proximity: { readonly tracks: boolean; readonly close_s: number; readonly tight_m: number; readonly objects: readonly ProximitySphere[] };
}

export interface HierarchyReply {
  readonly path: string;
  readonly level: number;
  readonly is_last: boolean;
  readonly left_out: number;
  readonly triangles: number;
  readonly node: number | null; // of the scene file; null: it stands
  readonly position_m: readonly [number, number, number];
  readonly orientation_xyzw: readonly [number, number, number, number];
  readonly volumes: readonly (readonly (readonly number[])[])[]; // of each volume the faces: x y z of each corner
}

const kPeriod_ms = 250;

// Asks again and again while it is wanted, one request at a time.
export class SurroundingsWatch {
  newest: SurroundingsReply | null = null;
  private asking = false;

  constructor(private readonly ask: Ask, private readonly wanted: () => boolean, private readonly onReply: () => void, private readonly onFault: (sentence: string) => void) {
    setInterval(() => void this.poll(), kPeriod_ms);
  }

  async poll(): Promise<void> {
    if (this.asking || !this.wanted() || document.hidden) return;
    this.asking = true;
    const reply = await this.ask({ do: 'surroundings' });
    this.asking = false;
    if (!reply.ok) {
      if (this.newest !== null) this.onFault(`surroundings: ${reply.error ?? ''}`);
      this.newest = null;
    } else {
      this.newest = reply as unknown as SurroundingsReply;
    }
    this.onReply();
  }
}
