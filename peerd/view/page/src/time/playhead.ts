import { PlaybackClock, PoseBook, type PoseFrame } from 'peerd';

import type { SceneFile } from '../scene/scene_file';
import type { Frames } from './frames';
import { LookBook } from './look_book';
import { NodeIds } from './node_ids';
import { PoseHistory } from './pose_history';

// Which instant the page shows: now, or one of the last minute or of a recording, standing or playing on.
export type PlayState = 'live' | 'paused' | 'playing';

export class Playhead {
  history: Frames;
  rate = 1; // at which a recording plays
  private readonly minute = new PoseHistory();
  book = new PoseBook(0);
  readonly looks = new LookBook();
  private readonly ids = new NodeIds();
  private readonly clock: PlaybackClock;
  private file: SceneFile | null = null;
  private state_: PlayState = 'live';
  private at_s = NaN;
  private applied_s = NaN; // the instant that the book holds while the page is not live
  private appliedFrames: readonly unknown[] = []; // of these frames the first `appliedCount` are in the book
  private appliedCount = 0;
  private early: { frame: PoseFrame; time_s: number }[] = []; // of a scene that is still on its way

  constructor(hz: number) {
    this.clock = new PlaybackClock(hz);
    this.history = this.minute;
  }

  // From now on the page shows what is recorded, at the instant that it shows, or else from the begin on.
  showRecorded(frames: Frames): void {
    const at_s = this.history.grows ? frames.begin_s : this.at_s;
    if (this.history.grows) this.state_ = 'paused';
    this.history = frames;
    this.ids.forgetAll();
    this.at_s = Math.min(Math.max(at_s, frames.begin_s), frames.end_s);
    this.applied_s = NaN;
    this.appliedFrames = [];
  }

  // Whether the book has what is to be shown, and nothing is on its way.
  get settled(): boolean {
    return this.state_ === 'live' || this.applied_s === this.at_s;
  }

  // Frames or a scene have come that were not there when the instant was shown.
  refresh(): void {
    this.applied_s = NaN;
  }

  get state(): PlayState {
    return this.state_;
  }

  // The instant that is shown [s, session time], at now_s of the page's own clock.
  shownAt(now_s: number): number {
    return this.state_ === 'live' ? this.clock.shownAt(now_s) : this.at_s;
  }

  show(file: SceneFile): void {
    const same = this.file?.revision === file.revision;
    this.file = file;
    this.ids.add(file);
    this.book = new PoseBook(file.nodeCount);
    if (same) this.looks.renew();
    else this.looks.clear();
    this.placeAll(file.revision);
    const waiting = this.early.filter(({ frame }) => frame.revision >= file.revision);
    this.early = [];
    for (const { frame, time_s } of waiting) this.take(frame, time_s, time_s);
    this.applied_s = NaN;
    this.appliedFrames = [];
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
    if (this.state_ !== 'paused') return;
    if (!this.history.grows && this.at_s >= this.history.end_s) this.at_s = this.history.begin_s;
    this.state_ = 'playing';
  }

  goLive(): void {
    if (this.state_ === 'live' || !this.history.grows) return;
    this.state_ = 'live';
    this.restore(this.history.end_s);
    this.applied_s = NaN;
    this.appliedFrames = [];
  }

  // Once a picture: what is not live is taken from the history.
  advance(elapsed_s: number): void {
    if (this.state_ === 'live' || this.history.empty) return;
    this.history.want(this.at_s, this.state_ === 'playing');
    if (!this.history.ready(this.at_s)) return; // time stands while its frames are on their way
    if (this.state_ === 'playing') this.at_s += elapsed_s * this.rate;
    if (this.at_s >= this.history.end_s && this.state_ === 'playing') {
      if (this.history.grows) {
        this.goLive();
        return;
      }
      this.state_ = 'paused';
      this.at_s = this.history.end_s;
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
    this.minute.add(frame, time_s);
    if (this.state_ !== 'live') return;
    this.book.take(frame, time_s, drawn_s, this.ids.nodeOf(frame.revision));
    this.takeLooks(frame);
  }

  // Within one stretch only the frames that are new are taken, where time goes on.
  private restore(time_s: number): void {
    const frames = this.history.framesFor(time_s);
    if (!this.history.ready(time_s) || (frames.length > 0 && !this.ids.knows(frames[0].frame.revision))) return;
    const after = frames.findIndex((kept) => kept.time_s > time_s);
    const count = after < 0 ? frames.length : after + 1;
    const goesOn = frames === this.appliedFrames && count >= this.appliedCount;
    if (!goesOn) {
      this.book.forgetAll();
      if (frames.length > 0) this.placeAll(frames[0].frame.revision);
      else if (this.file !== null) this.placeAll(this.file.revision);
    }
    for (let i = goesOn ? this.appliedCount : 0; i < count; ++i) {
      const { frame, time_s: at_s } = frames[i];
      this.book.take(frame, at_s, i === 0 ? at_s : frames[i - 1].time_s, this.ids.nodeOf(frame.revision));
      this.takeLooks(frame);
    }
    this.appliedFrames = frames;
    this.appliedCount = count;
    this.applied_s = time_s;
  }

  // Forms and looks are counted anew in each revision: those of another one are not shown.
  private takeLooks(frame: PoseFrame): void {
    if (frame.revision === this.file?.revision) this.looks.take(frame.looks);
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
