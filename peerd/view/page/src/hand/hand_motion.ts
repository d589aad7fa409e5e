// The velocity of a hand, from the places through which it has gone: the slope of the line that fits its last tenth of a
// second best. A hand that rests has none, however fast it came. Where places come seldom, because the page is drawn
// slowly, the window is as wide as a few of them.
const kWindow_s = 0.1;
const kIntervals = 2.5; // the window's least width, in intervals between places
const kKept_s = 1;
const kLeastSpan_s = 0.004;
export type Place = readonly [number, number, number];

export class HandMotion {
  private samples: { at_s: number; place: Place }[] = [];

  add(at_s: number, place: Place): void {
    this.samples = this.samples.filter((sample) => sample.at_s >= at_s - kKept_s && sample.at_s < at_s);
    this.samples.push({ at_s, place });
  }

  velocityAt(now_s: number): Place {
    const last = this.samples.at(-1);
    const window_s = Math.max(kWindow_s, kIntervals * this.interval_s());
    if (last === undefined || now_s - last.at_s > window_s) return [0, 0, 0];
    const recent = this.samples.filter((sample) => sample.at_s >= last.at_s - window_s);
    if (last.at_s - recent[0].at_s < kLeastSpan_s) return [0, 0, 0];
    const mean_s = recent.reduce((sum, sample) => sum + sample.at_s, 0) / recent.length;
    const spread = recent.reduce((sum, sample) => sum + (sample.at_s - mean_s) ** 2, 0);
    const slope = (axis: 0 | 1 | 2): number =>
      recent.reduce((sum, sample) => sum + (sample.at_s - mean_s) * sample.place[axis], 0) / spread;
    return [slope(0), slope(1), slope(2)];
  }

  // The median of the last five, so that one rest among them does not count.
  private interval_s(): number {
    const last = this.samples.slice(-6);
    const intervals = last.slice(1).map((sample, i) => sample.at_s - last[i].at_s);
    return intervals.sort((a, b) => a - b)[Math.floor(intervals.length / 2)] ?? 0;
  }
}
