import { type PoseFrame, PoseRow, readPoseFrame } from 'peerd';

import { LookBook } from './look_book';

// The newest row of each node and kind, as bytes, and the newest looks: from it comes a frame with all of them, from which a
// replay can begin.
const kHeadBytes = 40;
const kKinds = 3;

export class FullState {
  private words = new Uint32Array(0);
  private known = new Uint8Array(0);
  private wordsOfRow = 14;
  private count = 0;
  private readonly looks = new LookBook();

  take(frame: PoseFrame): void {
    this.wordsOfRow = frame.rowBytes >> 2;
    this.looks.take(frame.looks);
    this.looks.drain();
    const row = new PoseRow(frame);
    for (let i = 0; i < frame.rowCount; ++i) {
      row.moveTo(i);
      if (row.kind < kKinds) this.copy(frame, i, row.node * kKinds + row.kind);
    }
  }

  clear(): void {
    this.known.fill(0);
    this.count = 0;
    this.looks.clear();
  }

  // A frame with the head of `frame` and all rows that are known.
  asFrame(frame: PoseFrame): PoseFrame {
    const buffer = new ArrayBuffer(kHeadBytes + this.count * this.wordsOfRow * 4);
    const out = new Uint32Array(buffer);
    out.set(new Uint32Array(frame.buffer, 0, kHeadBytes >> 2));
    out[1] = this.count;
    let at = kHeadBytes >> 2;
    for (let slot = 0; slot < this.known.length; ++slot) {
      if (this.known[slot] === 0) continue;
      out.set(this.words.subarray(slot * this.wordsOfRow, (slot + 1) * this.wordsOfRow), at);
      at += this.wordsOfRow;
    }
    const made = readPoseFrame(buffer);
    if (typeof made === 'string') throw new Error(made);
    // Copies: the values are views of messages, which the history would keep whole.
    return { ...made, looks: this.looks.all().map((look) => ({ ...look, values: look.values.slice() })) };
  }

  private copy(frame: PoseFrame, row: number, slot: number): void {
    if (slot >= this.known.length) this.grow(slot + 1);
    if (this.known[slot] === 0) {
      this.known[slot] = 1;
      this.count += 1;
    }
    const from = (kHeadBytes >> 2) + row * this.wordsOfRow;
    const to = slot * this.wordsOfRow;
    for (let word = 0; word < this.wordsOfRow; ++word) this.words[to + word] = frame.u32[from + word];
  }

  private grow(slots: number): void {
    const room = Math.max(slots, 2 * this.known.length, 96);
    const words = new Uint32Array(room * this.wordsOfRow);
    words.set(this.words);
    this.words = words;
    const known = new Uint8Array(room);
    known.set(this.known);
    this.known = known;
  }
}
