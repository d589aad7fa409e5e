import type { RecordedView } from '../live/recording';
import type { Frames, KeptFrame } from './frames';

// The frames of a recorded view. Stretches are fetched when their time is shown, and the next one a little before; the
// least recently shown ones are forgotten beyond the bytes that are allowed.
const kAhead_s = 1.5;

export class RecordedFrames implements Frames {
  readonly begin_s = 0;
  readonly first_s: number; // the first instant at which there is something
  readonly empty = false;
  readonly grows = false;
  private readonly kept = new Map<number, { frames: KeptFrame[]; bytes: number }>(); // by order of use
  private readonly underway = new Set<number>();
  private bytes_ = 0;

  // onArrival is called with each stretch that has come, onFault where one cannot be had.
  constructor(
    private readonly view: RecordedView,
    readonly end_s: number,
    private readonly fetchStretch: (stretch: number) => Promise<KeptFrame[]>,
    private readonly onArrival: () => void,
    private readonly onFault: (sentence: string) => void,
    private readonly mostBytes = 96 * 1024 * 1024,
  ) {
    this.first_s = view.stretches[0]?.[0] ?? 0;
  }

  get bytes(): number {
    return this.bytes_;
  }

  // Whether the peer was there.
  isThere(time_s: number): boolean {
    const stretch = this.view.stretches[this.stretchAt(time_s)];
    return stretch !== undefined && time_s >= stretch[0] - 1e-6 && time_s <= stretch[1] + 0.05;
  }

  // The revision of the scene at an instant; undefined: there is none yet.
  revisionAt(time_s: number): number | undefined {
    return this.view.stretches[Math.max(0, this.stretchAt(time_s))]?.[2];
  }

  ready(time_s: number): boolean {
    const at = this.stretchAt(time_s);
    return at < 0 || this.kept.has(at);
  }

  // Fetches what is shown at an instant and, where time goes on, soon after it.
  want(time_s: number, plays: boolean): void {
    void this.fetchOnce(this.stretchAt(time_s));
    if (plays) void this.fetchOnce(this.stretchAt(time_s + kAhead_s));
  }

  framesFor(time_s: number): readonly KeptFrame[] {
    const at = this.stretchAt(time_s);
    const stretch = this.kept.get(at);
    if (stretch === undefined) return [];
    this.kept.delete(at);
    this.kept.set(at, stretch);
    return stretch.frames;
  }

  private stretchAt(time_s: number): number {
    return this.view.stretches.findLastIndex(([from_s]) => from_s <= time_s + 1e-9);
  }

  private async fetchOnce(stretch: number): Promise<void> {
    if (stretch < 0 || this.kept.has(stretch) || this.underway.has(stretch)) return;
    this.underway.add(stretch);
    try {
      const frames = await this.fetchStretch(stretch);
      const bytes = frames.reduce((sum, { frame }) => sum + frame.buffer.byteLength, 0);
      this.kept.set(stretch, { frames, bytes });
      this.bytes_ += bytes;
      this.forgetOld();
      this.onArrival();
    } catch (fault) {
      this.onFault(`what is recorded cannot be fetched: ${fault instanceof Error ? fault.message : String(fault)}`);
    } finally {
      this.underway.delete(stretch);
    }
  }

  private forgetOld(): void {
    for (const [stretch, { bytes }] of this.kept) {
      if (this.bytes_ <= this.mostBytes || this.kept.size <= 2) return;
      this.kept.delete(stretch);
      this.bytes_ -= bytes;
    }
  }
}
