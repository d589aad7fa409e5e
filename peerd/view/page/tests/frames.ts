import { type PoseFrame, readPoseFrame } from 'peerd';

// Pose frames as the gateway writes them, made here byte by byte from the contract.
export interface Row {
  node: number;
  owner?: number;
  kind?: number;
  flags?: number;
  threshold_m?: number;
  position: readonly [number, number, number];
  orientation?: readonly [number, number, number, number];
}

export function frameBytes(time_s: number, revision: number, rows: readonly Row[], rowBytes = 56): ArrayBuffer {
  const buffer = new ArrayBuffer(40 + rows.length * rowBytes);
  const view = new DataView(buffer);
  view.setUint32(0, 0x31464450, true);
  view.setUint32(4, rows.length, true);
  view.setFloat64(8, time_s, true);
  view.setFloat64(16, time_s - 100, true);
  view.setFloat64(24, time_s - 101, true);
  view.setUint32(32, revision, true);
  view.setUint32(36, rowBytes, true);
  rows.forEach((row, i) => writeRow(view, 40 + i * rowBytes, row));
  return buffer;
}

export function frame(time_s: number, revision: number, rows: readonly Row[]): PoseFrame {
  const read = readPoseFrame(frameBytes(time_s, revision, rows));
  if (typeof read === 'string') throw new Error(read);
  return read;
}

function writeRow(view: DataView, at: number, row: Row): void {
  view.setUint32(at, row.node, true);
  view.setUint32(at + 4, row.owner ?? 0, true);
  view.setUint16(at + 8, row.kind ?? 0, true);
  view.setUint16(at + 10, row.flags ?? 0, true);
  view.setFloat32(at + 12, row.threshold_m ?? NaN, true);
  row.position.forEach((value, axis) => view.setFloat64(at + 16 + 8 * axis, value, true));
  (row.orientation ?? [0, 0, 0, 1]).forEach((value, i) => view.setFloat32(at + 40 + 4 * i, value, true));
}
