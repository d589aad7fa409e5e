import { NodeTree } from '../scene/node_tree';

// Which nodes are open, and which of the rows to be seen is the one that keys act on. Both outlast an edit of the scene.
export class OpenTree {
  tree = new NodeTree();
  rows: readonly number[] = []; // to be seen, from above
  private readonly open = new Set<number>();
  private active_ = -1;

  // -1: there is none.
  get active(): number {
    return this.active_;
  }
  isOpen(row: number): boolean {
    return this.open.has(row);
  }

  show(tree: NodeTree): void {
    const paths = [...this.open].map((row) => this.tree.pathOf(row));
    const active = this.active_ < 0 ? -1 : tree.rowOf(this.tree.pathOf(this.active_));
    this.tree = tree;
    this.open.clear();
    for (const row of paths.map((path) => tree.rowOf(path))) if (row >= 0) this.open.add(row);
    this.active_ = active;
    this.arrange();
  }

  activate(row: number): void {
    this.active_ = row;
  }

  toggle(row: number): void {
    if (!this.tree.hasChildren(row)) return;
    if (!this.open.delete(row)) this.open.add(row);
    else if (this.active_ > row && this.active_ < this.tree.endOf(row)) this.active_ = row;
    this.arrange();
  }

  // Opens all that is around a node, and makes it the active one. False: the tree has no such node.
  reveal(path: string): boolean {
    const row = this.tree.rowOf(path);
    if (row < 0) return false;
    for (let at = this.tree.parentOf(row); at >= 0; at = this.tree.parentOf(at)) this.open.add(at);
    this.active_ = row;
    this.arrange();
    return true;
  }

  // Moves as the keys of a tree do (WAI-ARIA): false, where the key means nothing here. `page`: rows that are seen at once.
  onKey(key: string, page: number): boolean {
    const at = this.rows.indexOf(this.active_);
    const row = this.active_;
    if (this.rows.length === 0) return false;
    const go = (to: number): void => {
      this.active_ = this.rows[Math.min(this.rows.length - 1, Math.max(0, to))];
    };
    if (key === 'ArrowDown') go(at + 1);
    else if (key === 'ArrowUp') go(at - 1);
    else if (key === 'PageDown') go(at + page);
    else if (key === 'PageUp') go(at - page);
    else if (key === 'Home') go(0);
    else if (key === 'End') go(this.rows.length - 1);
    else if (key === 'ArrowRight' && at >= 0) {
      if (this.isOpen(row)) go(at + 1);
      else this.toggle(row);
    } else if (key === 'ArrowLeft' && at >= 0) {
      if (this.isOpen(row)) this.toggle(row);
      else if (this.tree.parentOf(row) >= 0) this.active_ = this.tree.parentOf(row);
    } else return false;
    return true;
  }

  private arrange(): void {
    const rows: number[] = [];
    for (let row = 0; row < this.tree.count; row = this.isOpen(row) ? row + 1 : this.tree.endOf(row)) rows.push(row);
    this.rows = rows;
  }
}
