import type { Numbers3, Numbers4, PoseKindName } from './messages.js';
import { PlaybackClock } from './playback_clock.js';
import { PoseBook } from './pose_book.js';
import { PoseFlag, PoseRow, type PoseFrame } from './pose_frame.js';
import type { SceneNodes } from './scene_nodes.js';

/** Where an object is. */
export interface ObjectPose {
  readonly path: string;
  /** In the world's frame [m]. */
  readonly position_m: Numbers3;
  /** Body to world. */
  readonly orientation_xyzw: Numbers4;
  /** The peer that owns it; null: nobody. */
  readonly owner: number | null;
  /** The owner is the peer that this program is connected to. */
  readonly own: boolean;
  /** Something else than physics moves it. */
  readonly driven: boolean;
  /** The peer that owned it has gone. */
  readonly orphaned: boolean;
  /** False: the peer does not listen to the regions in which it is, and the pose is old. */
  readonly received: boolean;
  /** How far what others predict may be from the truth before its owner sends it anew [m]; null: not known. */
  readonly threshold_m: number | null;
}

/** One frame: its times [s], and what has changed since the one that was read before. */
export interface Instant {
  readonly sessionTime_s: number;
  readonly worldTime_s: number;
  readonly sinceStart_s: number;
  /** Paths of objects whose pose of some kind is another one. */
  readonly changed: ReadonlySet<string>;
}

const kNumbers = 7;

/**
 * The poses of all that can move, by path, as they come from a peer. `for await` gives the instants of its frames; a loop that is
 * slower than they are gets the newest one, with all that has changed meanwhile.
 */
export class Watch implements AsyncIterable<Instant> {
  private book = new PoseBook(0);
  private nodes: SceneNodes | null = null;
  private pathOf: (string | undefined)[] = [];
  private readonly clock: PlaybackClock;
  private readonly early: PoseFrame[] = []; // of a scene that is still on its way
  private loading = false;
  private over = false;
  private error: Error | null = null;
  private changed = new Set<string>();
  private newest: PoseFrame | null = null; // that nobody has read yet
  private wake: (() => void)[] = [];
  private readonly numbers = new Float64Array(kNumbers);

  /** @internal `loadNodes` fetches the nodes of the scene as it is now; `onClose` is called once. */
  constructor(
    hz: number,
    private readonly loadNodes: () => Promise<SceneNodes>,
    private readonly onClose: () => void,
  ) {
    this.clock = new PlaybackClock(hz);
  }

  /** The objects whose pose of that kind is known. */
  paths(kind: PoseKindName = 'shown'): string[] {
    return (this.nodes?.nodes ?? []).filter((node) => this.book[kind].knows(node.index)).map((node) => node.path);
  }

  /** The pose to draw now: a little behind the newest frame, between two of them, so that motion is even. Null: it is not known. */
  pose(path: string, kind: PoseKindName = 'shown'): ObjectPose | null {
    return this.read(path, kind, this.clock.shownAt(now_s()));
  }

  /** The pose of the newest frame. Null: it is not known. */
  newestPose(path: string, kind: PoseKindName = 'shown'): ObjectPose | null {
    return this.read(path, kind, Infinity);
  }

  /** No more frames; loops over them end. */
  close(): void {
    this.end(null);
  }

  async *[Symbol.asyncIterator](): AsyncGenerator<Instant, void, undefined> {
    while (await this.hasFrame()) {
      const { sessionTime_s, worldTime_s, sinceStart_s } = this.newest as PoseFrame;
      const { changed } = this;
      this.newest = null;
      this.changed = new Set();
      yield { sessionTime_s, worldTime_s, sinceStart_s, changed };
    }
  }

  /** @internal Waits for a frame that can be read; false: there will be none. Throws what has ended the watch. */
  async hasFrame(): Promise<boolean> {
    while (this.newest === null && !this.over) await new Promise<void>((woken) => this.wake.push(woken));
    if (this.error !== null) throw this.error;
    return !this.over;
  }

  /** @internal */
  take(frame: PoseFrame): void {
    if (this.over) return;
    if (this.nodes?.revision === frame.revision) {
      this.apply(frame);
    } else if (this.nodes === null || frame.revision > this.nodes.revision) {
      this.early.push(frame);
      void this.load();
    } // else the scene is newer already, and a frame with all of it comes
  }

  /** @internal null: nothing has gone wrong. */
  end(error: Error | null): void {
    if (this.over) return;
    this.over = true;
    this.error = error;
    this.wakeAll();
    this.onClose();
  }

  private async load(): Promise<void> {
    if (this.loading) return;
    this.loading = true;
    try {
      while (!this.over && this.early.length > 0) this.show(await this.loadNodes());
    } catch (error) {
      this.end(error as Error);
    } finally {
      this.loading = false;
    }
  }

  private show(nodes: SceneNodes): void {
    this.nodes = nodes;
    this.book = new PoseBook(nodes.nodeCount);
    this.pathOf = [];
    for (const node of nodes.nodes) this.pathOf[node.index] = node.path;
    const waiting = this.early.splice(0);
    for (const frame of waiting) {
      if (frame.revision === nodes.revision) this.apply(frame);
      else if (frame.revision > nodes.revision) this.early.push(frame);
    }
  }

  private apply(frame: PoseFrame): void {
    const arrival_s = now_s();
    const time_s = Number.isNaN(frame.sessionTime_s) ? arrival_s : frame.sessionTime_s; // before there is a session
    this.clock.onFrame(time_s, arrival_s);
    this.book.take(frame, time_s, this.clock.shownAt(arrival_s));
    const row = new PoseRow(frame);
    for (let i = 0; i < frame.rowCount; ++i) {
      row.moveTo(i);
      const path = this.pathOf[row.node];
      if (path !== undefined) this.changed.add(path);
    }
    this.newest = frame;
    this.wakeAll();
  }

  private read(path: string, kind: PoseKindName, time_s: number): ObjectPose | null {
    const node = this.nodes?.byPath.get(path)?.index;
    const table = this.book[kind];
    const n = this.numbers;
    if (node === undefined || !table.sample(node, time_s, n)) return null;
    const flags = table.flags[node] as number;
    const threshold_m = table.threshold_m[node] as number;
    return {
      path,
      position_m: [n[0] as number, n[1] as number, n[2] as number],
      orientation_xyzw: [n[3] as number, n[4] as number, n[5] as number, n[6] as number],
      owner: table.owner[node] === 0 ? null : (table.owner[node] as number),
      own: (flags & PoseFlag.own) !== 0,
      driven: (flags & PoseFlag.driven) !== 0,
      orphaned: (flags & PoseFlag.orphaned) !== 0,
      received: (flags & PoseFlag.notReceived) === 0,
      threshold_m: Number.isNaN(threshold_m) ? null : threshold_m,
    };
  }

  private wakeAll(): void {
    for (const woken of this.wake.splice(0)) woken();
  }
}

function now_s(): number {
  return performance.now() / 1000;
}
