import { describe, expect, it } from 'vitest';
import { PoseBook } from 'peerd';

import { PoseHistory } from '../src/time/pose_history';
import { frame, type Row } from './frames';

// Two nodes: 0 moves in each frame, 1 in every tenth only, so that most frames do not have it.
function rowsAt(i: number): Row[] {
  const rows: Row[] = [{ node: 0, position: [i, 0, 0] }];
  if (i % 10 === 0) rows.push({ node: 1, position: [0, i, 0] }, { node: 1, kind: 2, position: [0, i - 1, 0] });
  return rows;
}

function filled(frames: number, span_s = 60, mostBytes = 1e9): PoseHistory {
  const history = new PoseHistory(span_s, mostBytes);
  for (let i = 0; i < frames; ++i) history.add(frame(i * 0.1, 1, rowsAt(i)), i * 0.1);
  return history;
}

function placesAt(history: PoseHistory, time_s: number): number[] {
  const book = new PoseBook(2);
  let before_s = NaN;
  for (const kept of history.framesFor(time_s)) {
    book.take(kept.frame, kept.time_s, Number.isNaN(before_s) ? kept.time_s : before_s);
    before_s = kept.time_s;
  }
  const pose = new Float64Array(7);
  book.shown.sample(0, time_s, pose);
  const x = pose[0];
  book.shown.sample(1, time_s, pose);
  return [x, pose[1]];
}

describe('the history of poses', () => {
  it('has what was shown at each instant, also of what did not move then', () => {
    const history = filled(300);
    for (const i of [0, 7, 20, 21, 153, 298]) {
      const [x, y] = placesAt(history, i * 0.1 + 0.05);
      expect(x).toBeCloseTo(i + 0.5, 6);
      expect(y).toBeGreaterThanOrEqual(i - (i % 10));
      expect(y).toBeLessThanOrEqual(i + 10);
    }
  });

  it('forgets what is older than its span, by whole stretches', () => {
    const history = filled(900, 20);
    expect(history.end_s).toBeCloseTo(89.9, 6);
    expect(history.begin_s).toBeGreaterThan(89.9 - 20 - 2.2);
    expect(history.begin_s).toBeLessThanOrEqual(89.9 - 20);
    expect(placesAt(history, history.begin_s)[0]).toBeCloseTo(history.begin_s * 10, 6);
  });

  it('is bounded in bytes, and knows how many it has', () => {
    const history = filled(3000, 1e9, 40000);
    const one = frame(0, 1, rowsAt(0)).buffer.byteLength;
    expect(history.bytes).toBeLessThanOrEqual(40000 + 25 * one);
    let counted = 0;
    for (let t = history.begin_s; t <= history.end_s; t += 0.1) counted += 1;
    expect(history.bytes).toBeGreaterThan(counted * 90);
  });

  it('begins anew where session time steps back', () => {
    const history = filled(50);
    history.add(frame(1, 1, rowsAt(0)), 1);
    expect([history.begin_s, history.end_s]).toEqual([1, 1]);
  });

  it('begins a stretch where the scene is another one', () => {
    const history = filled(5);
    history.add(frame(0.5, 2, [{ node: 4, position: [9, 9, 9] }]), 0.5);
    const [first, ...rest] = history.framesFor(0.5);
    expect([first.frame.revision, first.frame.rowCount, rest.length]).toEqual([2, 1, 0]);
  });
});
