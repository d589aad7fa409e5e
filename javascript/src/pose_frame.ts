import { readLookRecords, type LookRecord } from './look_records.js';

// A pose frame of the gateway (docs/reference/gateway.md): 40 bytes of head, then rows, all little endian. Every member of
// a row lies at a multiple of its own size, so that the rows are read through typed arrays over the message itself.
//
//   0 u32 node   4 u32 owner   8 u16 kind  10 u16 flags  12 f32 threshold  16 f64 x y z  40 f32 qx qy qz qw

const kMagic = 0x31464450; // "PDF1"
const kHeadBytes = 40;
const kLeastRowBytes = 56;

export const PoseKind = { shown: 0, truth: 1, ghost: 2 } as const;
export const PoseFlag = { own: 1, driven: 2, notReceived: 4, orphaned: 8, differs: 16 } as const;

export interface PoseFrame {
  readonly sessionTime_s: number; // NaN: the peer has no session yet
  readonly worldTime_s: number;
  readonly sinceStart_s: number;
  readonly revision: number; // of the scene whose nodes the rows count
  readonly rowCount: number;
  readonly buffer: ArrayBuffer;
  readonly u16: Uint16Array;
  readonly u32: Uint32Array;
  readonly f32: Float32Array;
  readonly f64: Float64Array;
  readonly rowBytes: number;
  readonly looks: readonly LookRecord[]; // none where they were not asked for
}

// The frame in a message, or a sentence that says why it is none.
export function readPoseFrame(buffer: ArrayBuffer): PoseFrame | string {
  if (buffer.byteLength < kHeadBytes) return `a pose frame of ${buffer.byteLength} bytes is shorter than its head`;
  const head = new DataView(buffer);
  if (head.getUint32(0, true) !== kMagic) return 'a binary message is not a pose frame';
  const rowCount = head.getUint32(4, true);
  const rowBytes = head.getUint32(36, true);
  if (rowBytes < kLeastRowBytes || rowBytes % 8 !== 0) return `a pose frame has rows of ${rowBytes} bytes`;
  const rowsEnd = kHeadBytes + rowCount * rowBytes;
  if (buffer.byteLength < rowsEnd)
    return `a pose frame of ${buffer.byteLength} bytes cannot have ${rowCount} rows of ${rowBytes}`;
  const looks = buffer.byteLength === rowsEnd ? [] : readLookRecords(buffer, rowsEnd);
  if (typeof looks === 'string') return `a pose frame of ${buffer.byteLength} bytes with ${rowCount} rows of ${rowBytes}: ${looks}`;
  return {
    sessionTime_s: head.getFloat64(8, true),
    worldTime_s: head.getFloat64(16, true),
    sinceStart_s: head.getFloat64(24, true),
    revision: head.getUint32(32, true),
    rowCount,
    rowBytes,
    looks,
    buffer,
    u16: new Uint16Array(buffer),
    u32: new Uint32Array(buffer),
    f32: new Float32Array(buffer),
    f64: new Float64Array(buffer, 0, rowsEnd >> 3),
  };
}

// Where the members of a row begin. One is made for each loop and moved from row to row, so that a loop makes no garbage.
export class PoseRow {
  private at = kHeadBytes;
  constructor(private readonly frame: PoseFrame) {}
  moveTo(row: number): void {
    this.at = kHeadBytes + row * this.frame.rowBytes;
  }
  get node(): number {
    return this.frame.u32[this.at >> 2];
  }
  get owner(): number {
    return this.frame.u32[(this.at >> 2) + 1];
  }
  get kind(): number {
    return this.frame.u16[(this.at >> 1) + 4];
  }
  get flags(): number {
    return this.frame.u16[(this.at >> 1) + 5];
  }
  get threshold_m(): number {
    return this.frame.f32[(this.at >> 2) + 3];
  }
  position(axis: number): number {
    return this.frame.f64[(this.at >> 3) + 2 + axis];
  }
  orientation(component: number): number {
    return this.frame.f32[(this.at >> 2) + 10 + component];
  }
}
