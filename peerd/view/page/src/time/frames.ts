import type { PoseFrame } from 'peerd';

// Where the frames of the instants come from that the page shows while it is not live: the last minute, or a recording.
export interface KeptFrame {
  readonly time_s: number;
  readonly frame: PoseFrame;
}

export interface Frames {
  readonly begin_s: number;
  readonly end_s: number;
  readonly empty: boolean;
  readonly grows: boolean; // its end is now
  // Whether framesFor(time_s) has what there is. Where it has not, want() brings it.
  ready(time_s: number): boolean;
  want(time_s: number, plays: boolean): void;
  // The frames from which the poses at time_s follow, the first one with all rows: those of its stretch, at least up to
  // the first one after it. The same ones, in the same order, for each instant of a stretch.
  framesFor(time_s: number): readonly KeptFrame[];
}
