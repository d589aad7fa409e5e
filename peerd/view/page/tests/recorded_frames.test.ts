import { describe, expect, it } from 'vitest';

import { splitFrames, type RecordedView } from '../src/live/recording';
import { RecordedFrames } from '../src/time/recorded_frames';
import type { KeptFrame } from '../src/time/frames';
import { frame } from './frames';

const kView: RecordedView = { peer: 1, name: 'a', scenes: [{ revision: 1, from_s: 0 }], stretches: [[1, 3, 1], [3, 5, 1], [8, 9, 2]] };

function stretchOf(index: number): KeptFrame[] {
  const [from_s, , revision] = kView.stretches[index];
  return Array.from({ length: 10 }, (_, i) => ({ time_s: from_s + i / 10, frame: frame(from_s + i / 10, revision, [{ node: 0, position: [i, 0, 0] }]) }));
}

interface Made {
  frames: RecordedFrames;
  asked: number[];
  faults: string[];
}

function made(mostBytes?: number, fails = false): Made {
  const asked: number[] = [];
  const faults: string[] = [];
  const fetch = (stretch: number): Promise<KeptFrame[]> => {
    asked.push(stretch);
    return fails ? Promise.reject(new Error('gone')) : Promise.resolve(stretchOf(stretch));
  };
  return { frames: new RecordedFrames(kView, 10, fetch, () => undefined, (sentence) => faults.push(sentence), mostBytes), asked, faults };
}

const arrival = (): Promise<void> => new Promise((done) => setTimeout(done, 0));

describe('recorded frames', () => {
  it('are fetched once, where they are shown and a little ahead', async () => {
    const { frames, asked } = made();
    expect(frames.ready(2)).toBe(false);
    frames.want(2, true);
    frames.want(2, true);
    await arrival();
    expect(asked).toEqual([0, 1]);
    expect(frames.ready(2)).toBe(true);
    expect(frames.framesFor(2).length).toBe(10);
    expect(frames.framesFor(2)).toBe(frames.framesFor(2.5));
    expect(frames.framesFor(4.9)[0].time_s).toBe(3);
  });

  it('are none before the first stretch, and the last ones where the peer is away', async () => {
    const { frames, asked } = made();
    frames.want(0.5, false);
    expect(asked).toEqual([]);
    expect(frames.ready(0.5)).toBe(true);
    expect(frames.framesFor(0.5)).toEqual([]);
    expect(frames.isThere(0.5)).toBe(false);
    expect(frames.isThere(4)).toBe(true);
    expect(frames.isThere(6)).toBe(false);
    frames.want(6, false);
    await arrival();
    expect(asked).toEqual([1]);
    expect(frames.framesFor(6)[0].time_s).toBe(3);
    expect(frames.first_s).toBe(1);
  });

  it('know the revision of each instant', () => {
    const { frames } = made();
    expect([0, 2, 7, 8.5].map((time_s) => frames.revisionAt(time_s))).toEqual([1, 1, 1, 2]);
  });

  it('forget what has not been shown for long', async () => {
    const { frames } = made(1);
    for (const time_s of [2, 4, 8.5]) {
      frames.want(time_s, false);
      await arrival();
    }
    expect(frames.ready(2)).toBe(false);
    expect(frames.ready(8.5)).toBe(true);
  });

  it('say where they cannot be had', async () => {
    const { frames, faults } = made(undefined, true);
    frames.want(2, false);
    await arrival();
    expect(faults).toEqual(['what is recorded cannot be fetched: gone']);
  });
});

describe('frames in one file', () => {
  it('are taken apart', () => {
    const parts = stretchOf(0).map((kept) => new Uint8Array(kept.frame.buffer));
    const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
    let at = 0;
    for (const part of parts) {
      all.set(part, at);
      at += part.length;
    }
    const frames = splitFrames(all.buffer);
    expect(frames.map((kept) => kept.time_s)).toEqual(stretchOf(0).map((kept) => kept.time_s));
    expect(frames[3].frame.rowCount).toBe(1);
  });
});
