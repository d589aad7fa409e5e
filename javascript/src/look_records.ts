// What stands behind the rows of a pose frame where it was asked for (docs/reference/gateway.md): what is seen to change
// beside poses.
//
//   0 u32 magic "PLK1"   4 u32 number of records   8 records:
//         0 u32 kind   4 u32 number   8 u32 count of values   12 u32 0   16 f32 values
const kMagic = 0x314b4c50;
const kHeadBytes = 8;
const kRecordBytes = 16;

export const LookKind = { points: 0, place: 1, value: 2 } as const;

export interface LookRecord {
  readonly kind: number;
  readonly number: number; // of the form or look, which the scene file says
  readonly values: Float32Array; // over the message itself
}

// The records from `begin` to the end of a message, or a sentence that says what is wrong with them.
export function readLookRecords(buffer: ArrayBuffer, begin: number): readonly LookRecord[] | string {
  const view = new DataView(buffer);
  if (begin + kHeadBytes > buffer.byteLength || view.getUint32(begin, true) !== kMagic) return 'what stands behind the rows is unknown';
  const count = view.getUint32(begin + 4, true);
  const records: LookRecord[] = [];
  let at = begin + kHeadBytes;
  for (let i = 0; i < count; ++i) {
    if (at + kRecordBytes > buffer.byteLength) return `record ${i} of ${count} is cut off`;
    const values = view.getUint32(at + 8, true);
    if (at + kRecordBytes + 4 * values > buffer.byteLength) return `record ${i} of ${count} is cut off`;
    records.push({ kind: view.getUint32(at, true), number: view.getUint32(at + 4, true), values: new Float32Array(buffer, at + kRecordBytes, values) });
    at += kRecordBytes + 4 * values;
  }
  return at === buffer.byteLength ? records : `${buffer.byteLength - at} bytes stand behind the records`;
}
