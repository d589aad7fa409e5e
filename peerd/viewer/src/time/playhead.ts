import { PlaybackClock } from '../live/playback_clock';
import type { PoseFrame } from '../live/pose_frame';
import type { SceneFile } from '../scene/scene_file';
import { NodeIds } from './node_ids';
import { PoseBook } from './pose_book';
import { PoseHistory } from './pose_history';

// Which instant the page shows: now, or one of the last minute, standing or playing on.
export type PlayState = 'live' | 'paused' | 'playing';

export class Playhead {
  readonly history = new PoseHistory();
  book = new PoseBook(0);
  private readonly ids = new NodeIds();
  private readonly clock: PlaybackClock;
  private file: SceneFile | null = null;
  private state_: PlayState = 'live';
  private at_s = NaN;
  private applied_s = NaN; // the instant that the book holds while the page is not live
  private early: { frame: PoseFrame; time_s: number }[] = []; // of a scene that is still on its way

  constructor(hz: number) {
    this.clock = new PlaybackClock(hz);
  }

  get state(): PlayState {
    return this.state_;
  }

  // The instant that is shown [s, session time], at now_s of the page's own clock.
  shownAt(now_s: number): number {
    return this.state_ === 'live' ? this.clock.shownAt(now_s) : this.at_s;
  }

  show(file: SceneFile): void {
    this.file = file;
    this.ids.add(file);
    this.book = new PoseBook(file.nodeCount);
    this.placeAll(file.revision);
    const waiting = this.early.filter(({ frame }) => frame.revision >= file.revision);
    this.early = [];
    for (const { frame, time_s } of waiting) this.take(frame, time_s, time_s);
    this.applied_s = NaN;
  }

  // A frame that came at now_s. Its time is the session's; before there is a session, the page's own clock serves.
  onFrame(frame: PoseFrame, now_s: number): void {
    const time_s = Number.isNaN(frame.sessionTime_s) ? now_s : frame.sessionTime_s;
    this.clock.onFrame(time_s, now_s);
    this.take(frame, time_s, this.clock.shownAt(now_s));
  }

  pauseAt(time_s: number): void {
    this.state_ = 'paused';
    this.at_s = Math.min(Math.max(time_s, this.history.begin_s), this.history.end_s);
    this.advance(0);
  }

  play(): void {
    if (this.state_ === 'paused') this.state_ = 'playing';
  }

  goLive(): void {
    if (this.state_ === 'live') return;
    this.state_ = 'live';
    this.restore(this.history.end_s);
    this.applied_s = NaN;
  }

  // Once a picture: what is not live is taken from the history.
  advance(elapsed_s: number): void {
    if (this.state_ === 'live' || this.history.empty) return;
    if (this.state_ === 'playing') this.at_s += elapsed_s;
    if (this.at_s >= this.history.end_s && this.state_ === 'playing') {
      this.goLive();
      return;
    }
    this.at_s = Math.max(this.at_s, this.history.begin_s);
    if (this.applied_s !== this.at_s) this.restore(this.at_s);
  }

  private take(frame: PoseFrame, time_s: number, drawn_s: number): void {
    if (this.file === null || !this.ids.knows(frame.revision)) {
      this.early.push({ frame, time_s });
      if (this.early.length > 300) this.early.shift();
      return;
    }
    this.history.add(frame, time_s);
    if (this.state_ === 'live') this.book.take(frame, time_s, drawn_s, this.ids.nodeOf(frame.revision));
  }

  private restore(time_s: number): void {
    const frames = this.history.framesFor(time_s);
    this.book.forgetAll();
    if (frames.length > 0) this.placeAll(frames[0].frame.revision);
    let before_s = -Infinity;
    for (const { frame, time_s: at_s } of frames) {
      this.book.take(frame, at_s, before_s === -Infinity ? at_s : before_s, this.ids.nodeOf(frame.revision));
      before_s = at_s;
    }
    this.applied_s = time_s;
  }

  // What has not moved since the page was opened stands where the file has it, if that scene had it.
  private placeAll(revision: number): void {
    const then = this.ids.nodeOf(revision);
    const present = then === undefined ? null : new Set(then);
    for (const node of this.file?.nodes ?? []) {
      if (present === null || present.has(node.index)) this.book.shown.place(node.index, node.pose, node.owner);
    }
  }
}
