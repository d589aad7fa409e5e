// The instant that the picture shows: a little behind the newest frame, so that there is always a frame to go towards.
// Frames come late by varying amounts and never early; so the clock follows the earliest ones at once and falls back slowly.
const kFallBack = 0.02; // the share of a frame's lateness by which the clock falls back: 50 frames to accept a slower path
const kLargestJump_s = 1.0; // beyond it session time has been stepped, or the page slept: the clock starts anew

export class PlaybackClock {
  private lead_s = NaN; // frame time minus arrival of the earliest frames
  private lastArrival_s = NaN;
  private interval_s: number;

  constructor(hz: number) {
    this.interval_s = 1 / hz;
  }

  // A frame of time_s came at arrival_s of the page's own clock.
  onFrame(time_s: number, arrival_s: number): void {
    const lead_s = time_s - arrival_s;
    const anew = Number.isNaN(this.lead_s) || Math.abs(lead_s - this.lead_s) > kLargestJump_s;
    this.lead_s = anew || lead_s > this.lead_s ? lead_s : this.lead_s + (lead_s - this.lead_s) * kFallBack;
    const since_s = arrival_s - this.lastArrival_s;
    if (since_s > 0 && since_s < 0.5) this.interval_s += (since_s - this.interval_s) * 0.05;
    this.lastArrival_s = arrival_s;
  }

  // The frame time to show at that instant of the page's clock; NaN before the first frame.
  shownAt(now_s: number): number {
    return now_s + this.lead_s - 1.2 * this.interval_s;
  }

  reset(): void {
    this.lead_s = NaN;
  }
}
