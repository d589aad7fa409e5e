import { make, setText } from '../page/make';
import type { Panel } from '../page/tabs';
import type { SceneFile } from '../scene/scene_file';
import { OpenTree } from './open_tree';

// All nodes of the world, as a tree. Only those rows are in the page that its window shows, however many are open.
const kRow_px = 26;
const kIndent_px = 14;
const kBeyond = 4; // rows above and below the window

export class TreePanel implements Panel {
  readonly name = 'nodes';
  readonly title = 'Nodes';
  readonly element = make('div', { class: 'panel list-panel' });
  private readonly canvas = make('div', { class: 'tree-canvas', role: 'presentation' });
  private readonly list = make('div', { class: 'rows tree', role: 'tree', tabindex: 0, 'aria-label': 'Nodes of the world' }, this.canvas);
  private readonly note = make('p', { class: 'note' });
  private readonly nodes = new OpenTree();
  private selected: string | null = null;

  constructor(private readonly onChoose: (path: string) => void) {
    this.element.append(this.list, this.note);
    this.list.addEventListener('keydown', (event) => this.onKey(event));
    this.list.addEventListener('click', (event) => this.onClick(event));
    this.list.addEventListener('scroll', () => this.draw(), { passive: true });
    new ResizeObserver(() => {
      this.bringIntoView();
      this.draw();
    }).observe(this.list);
  }

  show(file: SceneFile): void {
    this.nodes.show(file.tree);
    const left = file.tree.leftOut;
    setText(this.note, file.tree.count === 0 ? 'The world has no nodes.' : left > 0 ? `${left} more nodes are not in the list.` : '');
    this.draw();
  }

  // What is selected anywhere on the page is opened and shown here.
  select(path: string | null): void {
    this.selected = path;
    if (path !== null && this.nodes.reveal(path)) this.bringIntoView();
    this.draw();
  }

  private onKey(event: KeyboardEvent): void {
    if (event.altKey || event.ctrlKey || event.metaKey) return;
    const { active } = this.nodes;
    if ((event.key === 'Enter' || event.key === ' ') && active >= 0) this.onChoose(this.nodes.tree.pathOf(active));
    else if (!this.nodes.onKey(event.key, Math.max(1, this.seen() - 1))) return;
    event.preventDefault();
    this.bringIntoView();
    this.draw();
  }

  private onClick(event: MouseEvent): void {
    const target = event.target as HTMLElement;
    const row = Number(target.closest<HTMLElement>('[data-row]')?.dataset['row'] ?? NaN);
    if (Number.isNaN(row)) return;
    this.nodes.activate(row);
    if (target.closest('.twisty') !== null && this.nodes.tree.hasChildren(row)) this.nodes.toggle(row);
    else this.onChoose(this.nodes.tree.pathOf(row));
    this.draw();
  }

  private seen(): number {
    return Math.ceil(this.list.clientHeight / kRow_px);
  }

  private bringIntoView(): void {
    const at = this.nodes.rows.indexOf(this.nodes.active);
    if (at < 0) return;
    this.canvas.style.height = `${this.nodes.rows.length * kRow_px}px`; // it may have grown since it was drawn
    const [above, below] = [at * kRow_px, (at + 1) * kRow_px - this.list.clientHeight];
    if (this.list.scrollTop > above) this.list.scrollTop = above;
    else if (this.list.scrollTop < below) this.list.scrollTop = below;
  }

  private draw(): void {
    const { rows, active } = this.nodes;
    this.canvas.style.height = `${rows.length * kRow_px}px`;
    if (this.list.clientHeight === 0) return; // another tab is shown; the observer says when this one is
    const first = Math.max(0, Math.floor(this.list.scrollTop / kRow_px) - kBeyond);
    const elements = rows.slice(first, first + this.seen() + 2 * kBeyond).map((row, k) => this.rowOf(row, first + k));
    this.canvas.replaceChildren(...elements);
    const isDrawn = elements.some((element) => element.dataset['row'] === String(active));
    if (isDrawn) this.list.setAttribute('aria-activedescendant', idOf(active));
    else this.list.removeAttribute('aria-activedescendant');
  }

  private rowOf(row: number, at: number): HTMLElement {
    const { tree } = this.nodes;
    const [path, def] = [tree.pathOf(row), tree.defOf(row)];
    const parent = tree.hasChildren(row);
    const open = this.nodes.isOpen(row);
    const { place, count } = tree.amongSiblings(row); // of rows that are not in the page, too
    const label = def !== '' ? make('span', { class: 'row-name' }, def) : make('span', { class: 'row-name unnamed' }, tree.nameOf(row));
    const element = make(
      'div',
      {
        id: idOf(row),
        class: row === this.nodes.active ? 'row active' : 'row',
        role: 'treeitem',
        title: path,
        'data-row': row,
        'data-path': path,
        'aria-level': tree.depthOf(row) + 1,
        'aria-posinset': place + 1,
        'aria-setsize': count,
        'aria-expanded': parent ? String(open) : undefined,
        'aria-selected': String(path === this.selected),
      },
      make('span', { class: 'twisty', 'aria-hidden': 'true' }, parent ? (open ? '▾' : '▸') : ''),
      label,
      make('span', { class: 'row-owner' }, tree.typeOf(row)),
    );
    element.style.top = `${at * kRow_px}px`;
    element.style.paddingLeft = `${4 + kIndent_px * tree.depthOf(row)}px`;
    return element;
  }
}

function idOf(row: number): string {
  return `node-row-${row}`;
}
