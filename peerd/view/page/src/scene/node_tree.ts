// The tree of all nodes of the world, as the scene file has it, in depth-first order.
export interface TreeExtras {
  readonly words: readonly string[];
  readonly rows: readonly number[]; // four a row: its depth, and the words that are its type, its name in the path and its DEF name
  readonly left_out?: number;
}

const kPerRow = 4;
const kNone: TreeExtras = { words: [], rows: [] };

export class NodeTree {
  readonly count: number;
  private readonly end: Int32Array; // by row, one past the last row below it
  private readonly above: Int32Array; // by row, the row of its parent; -1: the top level
  private readonly place: Int32Array; // by row, its place among its siblings
  private readonly held: Int32Array; // by row + 1, how many nodes it holds; at 0 those of the top level

  constructor(private readonly extras: TreeExtras = kNone) {
    this.count = extras.rows.length / kPerRow;
    this.end = new Int32Array(this.count).fill(this.count);
    this.above = new Int32Array(this.count).fill(-1);
    this.place = new Int32Array(this.count);
    this.held = new Int32Array(this.count + 1);
    const around: number[] = [];
    for (let row = 0; row < this.count; ++row) {
      while (around.length > this.depthOf(row)) this.end[around.pop()!] = row;
      this.above[row] = around.at(-1) ?? -1;
      this.place[row] = this.held[this.above[row] + 1]++;
      around.push(row);
    }
  }

  get leftOut(): number {
    return this.extras.left_out ?? 0;
  }
  depthOf(row: number): number {
    return this.extras.rows[kPerRow * row];
  }
  typeOf(row: number): string {
    return this.wordOf(row, 1);
  }
  // Its name in the path: a DEF name, the place among its siblings, or the field that holds it.
  nameOf(row: number): string {
    return this.wordOf(row, 2);
  }
  defOf(row: number): string {
    return this.wordOf(row, 3);
  }
  parentOf(row: number): number {
    return this.above[row];
  }
  endOf(row: number): number {
    return this.end[row];
  }
  hasChildren(row: number): boolean {
    return this.end[row] > row + 1;
  }
  // Its place among its siblings, and how many these are with it.
  amongSiblings(row: number): { readonly place: number; readonly count: number } {
    return { place: this.place[row], count: this.held[this.above[row] + 1] };
  }

  pathOf(row: number): string {
    const names: string[] = [];
    for (let at = row; at >= 0; at = this.above[at]) names.push(this.nameOf(at));
    return names.reverse().join('/');
  }
  // -1: no node is there.
  rowOf(path: string): number {
    let [row, end] = [0, this.count];
    let found = -1;
    for (const name of path.split('/')) {
      while (row < end && this.nameOf(row) !== name) row = this.end[row];
      if (row >= end) return -1;
      found = row;
      end = this.end[row];
      row += 1;
    }
    return found;
  }

  private wordOf(row: number, which: number): string {
    return this.extras.words[this.extras.rows[kPerRow * row + which]] ?? '';
  }
}
