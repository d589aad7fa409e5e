import { Vector3 } from 'three';
import { type ContactEvent, PoseFlag, type PoseTable, type Reply } from 'peerd';

import type { SensorExtras } from '../hand/sensor_rules';
import type { OcclusionFigures } from '../scene/occlusion';
import { hasNode } from '../scene/scene_file';
import type { PlayState } from '../time/playhead';
import type { Viewer } from '../viewer';

// What a script on the page, or a page that embeds this one from its own origin, can do with it: window.peerd.
export interface ShownObject {
  readonly path: string;
  readonly owner: number;
  readonly own: boolean;
  readonly position_m: readonly number[]; // as the page has it at the instant that it shows
  readonly truth_m: readonly number[] | null; // where it really is, where that is known
  readonly ghost_m: readonly number[] | null; // where others, or of an object of another peer this one, predict it
  readonly error_m: number | null; // the distance of the two
  readonly window_px: { readonly x: number; readonly y: number } | null; // null: behind the camera
}

export class Driver {
  constructor(private readonly viewer: Viewer) {}

  get state(): PlayState {
    return this.viewer.head.state;
  }
  get time_s(): number {
    return this.viewer.head.shownAt(this.viewer.now_s());
  }
  get range_s(): readonly [number, number] {
    const { history } = this.viewer.head;
    return [history.begin_s, history.end_s];
  }
  get revision(): number {
    return this.viewer.view.file?.revision ?? -1;
  }
  // The path of this page's avatar; null: nobody walks here.
  get avatar(): string | null {
    return this.viewer.avatar.path;
  }
  // The path of what the hand holds.
  get held(): string | null {
    return this.viewer.hand.path;
  }
  get pictures(): number {
    return this.viewer.pictures;
  }
  get drawn(): { readonly instances: number; readonly calls: number; readonly triangles: number; readonly work_ms: number; readonly occlusion: OcclusionFigures | null } {
    const { view, pictureWork_ms } = this.viewer;
    return { instances: view.instancesDrawn, calls: view.drawCalls, triangles: view.triangles, work_ms: pictureWork_ms, occlusion: view.occlusion };
  }

  // What has come from the daemon since the page was loaded.
  get received(): { readonly bytes: number; readonly frames: number } {
    const { bytesIn, framesIn } = this.viewer.link.connection;
    return { bytes: bytesIn, frames: framesIn };
  }

  // Calls the listener with each path that is selected (null: nothing), each revision of the scene, each event of the daemon.
  on(name: 'select' | 'scene' | 'event', listener: (detail: unknown) => void): void {
    this.viewer.happenings.addEventListener(name, (happening) => listener((happening as CustomEvent<unknown>).detail));
  }

  // Whether that instant is what objects() has: what is recorded may be on its way.
  get settled(): boolean {
    return this.viewer.head.settled && this.viewer.recorded?.sceneIsShown !== false;
  }
  // Of a recording: whose views there are, and which is shown. Of a running peer there are none.
  get views(): readonly string[] {
    return this.viewer.recorded?.recording.views.map((view) => view.name) ?? [];
  }
  get view(): string | null {
    const { recorded } = this.viewer;
    return recorded?.recording.views[recorded.view]?.name ?? null;
  }
  show_view(name: string): boolean {
    const view = this.views.indexOf(name);
    if (view >= 0) void this.viewer.recorded?.show(view);
    return view >= 0;
  }
  // What of the world the picture leaves out.
  get sensors(): readonly SensorExtras[] {
    return this.viewer.view.file?.extras.sensors ?? [];
  }
  get undrawn(): readonly { readonly path: string; readonly what: string; readonly why: string }[] {
    return this.viewer.view.file?.extras.undrawn ?? [];
  }
  // What the switches of the menu show of the daemon's own knowledge.
  get insight(): { readonly joined: readonly number[]; readonly proximity: number; readonly volumes: number } {
    const { watch, proximity, hierarchy } = this.viewer.insight;
    return { joined: watch.newest?.regions.joined ?? [], proximity: proximity.count, volumes: hierarchy?.volumes.length ?? 0 };
  }
  // Asks the daemon, as the page itself does (docs/reference/control-protocol.md).
  ask(request: Record<string, unknown>): Promise<Reply> {
    return this.viewer.link.ask(request);
  }

  set_time(time_s: number): void {
    this.viewer.head.pauseAt(time_s);
  }
  pause(): void {
    this.viewer.head.pauseAt(this.time_s);
  }
  play(): void {
    this.viewer.head.play();
  }
  live(): void {
    this.viewer.head.goLive();
  }
  select(path: string): boolean {
    return this.viewer.select(path);
  }
  get selected(): string | null {
    return this.viewer.selection.path;
  }

  // Whether the scene has that node: one that can move, or one that stands.
  has(path: string): boolean {
    return this.viewer.view.file !== null && hasNode(this.viewer.view.file, path);
  }
  // Where a place of the world is on the window [px]; null behind the camera.
  on_window(place_m: readonly [number, number, number]): { x: number; y: number } | null {
    return this.viewer.view.onWindow(new Vector3(...place_m));
  }

  objects(): ShownObject[] {
    const { view, head } = this.viewer;
    const pose = new Float64Array(7);
    const shown = [];
    for (const { index, path } of view.file?.nodes ?? []) {
      if (!head.book.shown.sample(index, this.time_s, pose)) continue;
      const place = new Vector3(pose[0], pose[1], pose[2]);
      const own = (head.book.shown.flags[index] & PoseFlag.own) !== 0;
      const error_m = head.book.errorOf(index, this.time_s);
      shown.push({
        path,
        owner: head.book.shown.owner[index],
        own,
        position_m: place.toArray(),
        truth_m: placeIn(head.book.truth, index, this.time_s),
        ghost_m: placeIn(head.book.ghost, index, this.time_s),
        error_m: Number.isNaN(error_m) ? null : error_m,
        window_px: view.onWindow(place),
      });
    }
    return shown;
  }

  contacts(): (ContactEvent & { retracted: boolean; decider_name: string })[] {
    return this.viewer.contacts.all().map(({ event, retracted, decider }) => ({ ...event, retracted, decider_name: decider }));
  }
}

function placeIn(table: PoseTable, node: number, time_s: number): number[] | null {
  const pose = new Float64Array(7);
  return table.sample(node, time_s, pose) ? [pose[0], pose[1], pose[2]] : null;
}
