// A value over time, the last minute of it, without garbage: a ring of fixed size.
export class Series {
  private readonly times: Float64Array;
  private readonly values: Float64Array;
  private begin = 0;
  private count = 0;

  constructor(readonly name: string, readonly colour: string, capacity = 1024) {
    this.times = new Float64Array(capacity);
    this.values = new Float64Array(capacity);
  }

  get length(): number {
    return this.count;
  }

  add(time_s: number, value: number): void {
    const at = (this.begin + this.count) % this.times.length;
    this.times[at] = time_s;
    this.values[at] = value;
    if (this.count < this.times.length) this.count += 1;
    else this.begin = (this.begin + 1) % this.times.length;
  }

  timeAt(i: number): number {
    return this.times[(this.begin + i) % this.times.length];
  }

  valueAt(i: number): number {
    return this.values[(this.begin + i) % this.values.length];
  }

  clear(): void {
    this.count = 0;
  }

  // The value that is nearest to an instant; NaN where there is none.
  nearest(time_s: number): number {
    let best = NaN;
    let distance = Infinity;
    for (let i = 0; i < this.count; ++i) {
      const off = Math.abs(this.timeAt(i) - time_s);
      if (off < distance) [best, distance] = [this.valueAt(i), off];
    }
    return best;
  }

  greatest(since_s: number): number {
    let most = 0;
    for (let i = 0; i < this.count; ++i) if (this.timeAt(i) >= since_s && this.valueAt(i) > most) most = this.valueAt(i);
    return most;
  }
}

// Counters only grow: the rate between two readings; NaN for the first, and where the peer has started anew.
export class Rate {
  private last: { time_s: number; count: number } | null = null;

  at(time_s: number, count: number | undefined): number {
    if (count === undefined) return NaN;
    const before = this.last;
    this.last = { time_s, count };
    if (before === null || time_s <= before.time_s || count < before.count) return NaN;
    return (count - before.count) / (time_s - before.time_s);
  }
}

// A round number at or above `value`: 1, 2 or 5 times a power of ten.
export function roundedUp(value: number): number {
  if (!(value > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(value));
  for (const step of [1, 2, 5]) if (value <= step * power * (1 + 1e-9)) return step * power;
  return 10 * power;
}
