import { describe, expect, it } from 'vitest';
import { LookKind, type PoseFrame, readPoseFrame } from 'peerd';

import { LookBook } from '../src/time/look_book';
import { PoseHistory } from '../src/time/pose_history';
import { frameBytes } from './frames';

interface Record_ {
  kind: number;
  number: number;
  values: number[];
}

function withLooks(time_s: number, records: readonly Record_[]): ArrayBuffer {
  const rows = new Uint8Array(frameBytes(time_s, 1, [{ node: 0, position: [time_s, 0, 0] }]));
  const size = 8 + records.reduce((sum, { values }) => sum + 16 + 4 * values.length, 0);
  const out = new Uint8Array(rows.length + size);
  out.set(rows);
  const view = new DataView(out.buffer);
  view.setUint32(rows.length, 0x314b4c50, true);
  view.setUint32(rows.length + 4, records.length, true);
  let at = rows.length + 8;
  for (const { kind, number, values } of records) {
    view.setUint32(at, kind, true);
    view.setUint32(at + 4, number, true);
    view.setUint32(at + 8, values.length, true);
    values.forEach((value, i) => view.setFloat32(at + 16 + 4 * i, value, true));
    at += 16 + 4 * values.length;
  }
  return out.buffer;
}

function frameOf(buffer: ArrayBuffer): PoseFrame {
  const read = readPoseFrame(buffer);
  if (typeof read === 'string') throw new Error(read);
  return read;
}

describe('looks behind the rows', () => {
  const records = [{ kind: LookKind.points, number: 3, values: [1, 2, 3, 4, 5, 6] }, { kind: LookKind.value, number: 0, values: [1] }];
  it('are read', () => {
    const { looks, rowCount } = frameOf(withLooks(1, records));
    expect(rowCount).toBe(1);
    expect(looks.map(({ kind, number, values }) => ({ kind, number, values: [...values] }))).toEqual(records);
  });
  it('are none in a frame without them', () => expect(frameOf(frameBytes(1, 1, [])).looks).toEqual([]));
  it('are refused at every cut', () => {
    const whole = withLooks(1, records);
    for (let cut = whole.byteLength - 1; cut > 96; --cut) expect(typeof readPoseFrame(whole.slice(0, cut)), `${cut} bytes`).toBe('string');
    expect(typeof readPoseFrame(new Uint8Array([...new Uint8Array(whole), 0, 0, 0, 0]).buffer)).toBe('string');
  });
});

it('a book has the newest of each, and gives each once', () => {
  const book = new LookBook();
  book.take(frameOf(withLooks(1, [{ kind: 2, number: 0, values: [1] }, { kind: 2, number: 1, values: [5] }])).looks);
  book.take(frameOf(withLooks(2, [{ kind: 2, number: 0, values: [2] }])).looks);
  expect(book.drain().map(({ number, values }) => [number, values[0]]).sort()).toEqual([[0, 2], [1, 5]]);
  expect(book.drain()).toEqual([]);
  book.renew();
  expect(book.drain().length).toBe(2);
});

// What has changed in an earlier stretch alone is in the first frame of each later one, too.
it('the history keeps the looks of the past', () => {
  const history = new PoseHistory();
  history.add(frameOf(withLooks(0, [{ kind: 2, number: 0, values: [1] }])), 0);
  for (let t = 1; t < 12; ++t) history.add(frameOf(withLooks(t, [{ kind: 2, number: 1, values: [t] }])), t);
  const book = new LookBook();
  for (const { frame, time_s } of history.framesFor(9.5)) if (time_s <= 9.5) book.take(frame.looks);
  expect(book.all().map(({ number, values }) => [number, values[0]]).sort()).toEqual([[0, 1], [1, 9]]);
});
