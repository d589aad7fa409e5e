import { describe, expect, it } from 'vitest';
import { PoseFlag, PoseRow, readPoseFrame } from 'peerd';

import { frame, frameBytes } from './frames';

describe('a pose frame', () => {
  it('has the members at the offsets of the contract', () => {
    const read = frame(12.5, 7, [
      { node: 3, owner: 2, kind: 2, flags: PoseFlag.driven, threshold_m: 0.25, position: [1.5, -2, 1e7], orientation: [0, 0.6, 0, 0.8] },
      { node: 70000, position: [0, 0, 0] },
    ]);
    expect([read.sessionTime_s, read.worldTime_s, read.sinceStart_s, read.revision, read.rowCount]).toEqual([12.5, -87.5, -88.5, 7, 2]);
    const row = new PoseRow(read);
    row.moveTo(0);
    expect([row.node, row.owner, row.kind, row.flags, row.threshold_m]).toEqual([3, 2, 2, 2, 0.25]);
    expect([0, 1, 2].map((axis) => row.position(axis))).toEqual([1.5, -2, 1e7]);
    expect(row.orientation(1)).toBeCloseTo(0.6, 6);
    row.moveTo(1);
    expect(row.node).toBe(70000);
    expect(row.threshold_m).toBeNaN();
  });

  it('may have longer rows, whose rest is skipped', () => {
    const read = readPoseFrame(frameBytes(1, 1, [{ node: 1, position: [1, 2, 3] }, { node: 2, position: [4, 5, 6] }], 64));
    if (typeof read === 'string') throw new Error(read);
    const row = new PoseRow(read);
    row.moveTo(1);
    expect([row.node, row.position(2)]).toEqual([2, 6]);
  });

  const whole = frameBytes(1, 1, [{ node: 1, position: [1, 2, 3] }]);
  const longer = new ArrayBuffer(whole.byteLength + 8);
  new Uint8Array(longer).set(new Uint8Array(whole));
  const otherMagic = whole.slice(0);
  new Uint8Array(otherMagic)[0] = 0;
  it.each([
    ['shorter than its head', whole.slice(0, 39)],
    ['cut', whole.slice(0, whole.byteLength - 1)],
    ['empty', new ArrayBuffer(0)],
    ['longer than its rows', longer],
    ['of another kind', otherMagic],
    ['with short rows', frameBytes(1, 1, [], 40)],
  ])('that is %s is refused with a sentence', (_name, bytes) => {
    expect(typeof readPoseFrame(bytes)).toBe('string');
  });
});
