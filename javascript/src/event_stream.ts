import { PeerdError } from './errors.js';

const kMostWaiting = 65536;

interface Reader<Item> {
  readonly resolve: (result: IteratorResult<Item, undefined>) => void;
  readonly reject: (error: Error) => void;
}

/**
 * Events as they come, for `for await`. It ends where it is closed (leaving the loop does that) or its peer is, and throws where the
 * connection ends, or where 65,536 events wait that nobody has read. It is read in one place at a time.
 */
export class EventStream<Item> implements AsyncIterableIterator<Item> {
  private readonly items: Item[] = [];
  private readonly readers: Reader<Item>[] = [];
  private over = false;
  private error: Error | null = null; // what the next reader gets after the items before it

  /** @param onClose is called once, when nobody reads any more. */
  constructor(private readonly onClose: () => void) {}

  [Symbol.asyncIterator](): this {
    return this;
  }

  next(): Promise<IteratorResult<Item, undefined>> {
    if (this.items.length > 0) return Promise.resolve({ done: false, value: this.items.shift() as Item });
    const { error } = this;
    if (error !== null) {
      this.error = null; // thrown once: an iterator that has thrown is at its end
      return Promise.reject(error);
    }
    if (this.over) return Promise.resolve({ done: true, value: undefined });
    return new Promise((resolve, reject) => this.readers.push({ resolve, reject }));
  }

  return(): Promise<IteratorResult<Item, undefined>> {
    this.close();
    return Promise.resolve({ done: true, value: undefined });
  }

  /** Ends it; what waits is not read any more. */
  close(): void {
    this.items.length = 0;
    this.end(null);
  }

  /** @internal */
  give(item: Item): void {
    if (this.over) return;
    const reader = this.readers.shift();
    if (reader !== undefined) reader.resolve({ done: false, value: item });
    else if (this.items.push(item) >= kMostWaiting) this.end(new PeerdError(`${kMostWaiting} events wait that this program has not read`));
  }

  /** @internal null: nothing has gone wrong. */
  end(error: Error | null): void {
    if (this.over) return;
    this.over = true;
    const readers = this.readers.splice(0);
    if (error !== null && readers.length === 0) this.error = error;
    for (const reader of readers) {
      if (error === null) reader.resolve({ done: true, value: undefined });
      else reader.reject(error);
    }
    this.onClose();
  }
}
