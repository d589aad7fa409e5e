import type { PoseFrame } from 'peerd';

import type { Frames, KeptFrame } from './frames';
import { FullState } from './full_state';

// The pose frames of the last minute, in stretches that begin with a frame of all rows. What is older, or more than the
// bytes that are allowed, is forgotten by whole stretches.
const kStretch_s = 2;

interface Stretch {
  readonly frames: KeptFrame[];
  bytes: number;
}

export class PoseHistory implements Frames {
  readonly grows = true;
  private readonly stretches: Stretch[] = [];
  private readonly state = new FullState();
  private bytes_ = 0;
  private revision = -1;

  constructor(private readonly span_s = 60, private readonly mostBytes = 96 * 1024 * 1024) {}

  get bytes(): number {
    return this.bytes_;
  }
  get empty(): boolean {
    return this.stretches.length === 0;
  }
  get begin_s(): number {
    return this.stretches[0]?.frames[0].time_s ?? NaN;
  }
  get end_s(): number {
    return this.stretches.at(-1)?.frames.at(-1)?.time_s ?? NaN;
  }

  ready(): boolean {
    return true;
  }
  want(): void {}

  add(frame: PoseFrame, time_s: number): void {
    if (time_s < this.end_s || time_s > this.end_s + this.span_s) this.clear(); // session time has been stepped
    const anew = frame.revision !== this.revision;
    if (anew) this.state.clear();
    this.revision = frame.revision;
    this.state.take(frame);
    const last = this.stretches.at(-1);
    if (anew || last === undefined || time_s - last.frames[0].time_s >= kStretch_s) this.begin(frame, time_s);
    else this.keep(last, frame, time_s);
    this.forgetOld();
  }

  clear(): void {
    this.stretches.length = 0;
    this.bytes_ = 0;
    this.revision = -1;
    this.state.clear();
  }

  // The frames from which the poses at time_s follow: those of its stretch up to the first one after it.
  framesFor(time_s: number): readonly KeptFrame[] {
    const at = this.stretches.findLastIndex((stretch) => stretch.frames[0].time_s <= time_s);
    const index = Math.max(at, 0);
    const stretch = this.stretches[index];
    if (stretch === undefined) return [];
    const after = stretch.frames.findIndex((kept) => kept.time_s > time_s);
    if (after >= 0) return stretch.frames.slice(0, after + 1);
    const next = this.stretches[index + 1]?.frames[0];
    return next === undefined ? stretch.frames : [...stretch.frames, next];
  }

  private begin(frame: PoseFrame, time_s: number): void {
    const stretch = { frames: [], bytes: 0 };
    this.stretches.push(stretch);
    this.keep(stretch, this.state.asFrame(frame), time_s);
  }

  private keep(stretch: Stretch, frame: PoseFrame, time_s: number): void {
    stretch.frames.push({ time_s, frame });
    stretch.bytes += frame.buffer.byteLength;
    this.bytes_ += frame.buffer.byteLength;
  }

  private forgetOld(): void {
    while (this.stretches.length > 1 && (this.stretches[1].frames[0].time_s < this.end_s - this.span_s || this.bytes_ > this.mostBytes)) {
      this.bytes_ -= this.stretches.shift()?.bytes ?? 0;
    }
  }
}
