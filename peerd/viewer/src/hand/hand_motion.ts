// The velocity of a hand, from where it was in the last tenth of a second: the slope of the line that fits best. A hand that
// has rested has none, however fast it came.
const kWindow_s = 0.1;
const kLeastSpan_s = 0.015;
export type Place = readonly [number, number, number];

export class HandMotion {
  private samples: { at_s: number; place: Place }[] = [];

  add(at_s: number, place: Place): void {
    this.samples.push({ at_s, place });
    this.forget(at_s);
  }

  velocityAt(now_s: number): Place {
    this.forget(now_s);
    const count = this.samples.length;
    if (count < 2 || this.samples[count - 1].at_s - this.samples[0].at_s < kLeastSpan_s) return [0, 0, 0];
    const mean_s = this.samples.reduce((sum, sample) => sum + sample.at_s, 0) / count;
    const spread = this.samples.reduce((sum, sample) => sum + (sample.at_s - mean_s) ** 2, 0);
    const slope = (axis: 0 | 1 | 2): number =>
      this.samples.reduce((sum, sample) => sum + (sample.at_s - mean_s) * sample.place[axis], 0) / spread;
    return [slope(0), slope(1), slope(2)];
  }

  private forget(now_s: number): void {
    this.samples = this.samples.filter((sample) => sample.at_s >= now_s - kWindow_s);
  }
}
