import { PoseFlag, type PoseTable } from 'peerd';

import { make, setText } from '../page/make';
import type { Panel } from '../page/tabs';
import type { SceneFile, SceneNode } from '../scene/scene_file';

// All that can move, with its owner; a search narrows the list.
const kMostRows = 200;

export class ObjectsPanel implements Panel {
  readonly name = 'objects';
  readonly title = 'Objects';
  readonly element = make('div', { class: 'panel list-panel' });
  private readonly search = make('input', { type: 'search', placeholder: 'Search by name or owner', 'aria-label': 'Search objects' });
  private readonly list = make('ul', { class: 'rows', role: 'listbox', 'aria-label': 'Objects', tabindex: 0 });
  private readonly note = make('p', { class: 'note' });
  private rows: { node: SceneNode; element: HTMLElement; owner: HTMLElement; dot: HTMLElement }[] = [];
  private file: SceneFile | null = null;
  private found = '';

  constructor(
    private readonly nameOf: (peer: number) => string,
    private readonly onChoose: (node: SceneNode) => void,
  ) {
    this.element.append(make('div', { class: 'search' }, this.search), this.list, this.note);
    this.search.addEventListener('input', () => this.found !== this.search.value && this.rebuild());
    this.list.addEventListener('keydown', (event) => this.onKey(event));
  }

  show(file: SceneFile): void {
    this.file = file;
    this.rebuild();
  }

  update(poses: PoseTable, selected: number | null): void {
    for (const row of this.rows) {
      const { index } = row.node;
      setText(row.owner, this.nameOf(poses.owner[index]));
      const own = (poses.flags[index] & PoseFlag.own) !== 0;
      const differs = (poses.flags[index] & PoseFlag.differs) !== 0;
      row.element.title = differs ? 'Peers show it at different places' : '';
      row.dot.dataset['whose'] = differs ? 'differs' : own ? 'own' : poses.owner[index] === 0 ? 'nobodys' : 'remote';
      row.element.setAttribute('aria-selected', String(index === selected));
    }
  }

  private rebuild(): void {
    this.found = this.search.value;
    const words = this.found.trim().toLowerCase();
    const fits = (node: SceneNode): boolean => words === '' || node.path.toLowerCase().includes(words) || this.nameOf(node.owner).toLowerCase() === words;
    const nodes = (this.file?.nodes ?? []).filter(fits);
    this.rows = nodes.slice(0, kMostRows).map((node) => this.rowOf(node));
    this.list.replaceChildren(...this.rows.map((row) => row.element));
    const left = nodes.length - this.rows.length;
    setText(this.note, nodes.length === 0 ? 'No object has that name.' : left > 0 ? `${left} more; search to find them.` : '');
  }

  private rowOf(node: SceneNode): ObjectsPanel['rows'][number] {
    const dot = make('span', { class: 'dot' });
    const owner = make('span', { class: 'row-owner' });
    const title = make('span', { class: 'row-name', title: node.path }, node.path);
    const element = make('li', { class: 'row', role: 'option', 'data-path': node.path, click: () => this.onChoose(node) }, dot, title, owner);
    return { node, element, owner, dot };
  }

  private onKey(event: KeyboardEvent): void {
    const step = event.key === 'ArrowDown' ? 1 : event.key === 'ArrowUp' ? -1 : 0;
    if (step === 0 || this.rows.length === 0) return;
    const at = this.rows.findIndex((row) => row.element.getAttribute('aria-selected') === 'true');
    const next = this.rows[Math.min(this.rows.length - 1, Math.max(0, at + step))];
    next.element.scrollIntoView({ block: 'nearest' });
    for (const row of this.rows) row.element.setAttribute('aria-selected', String(row === next));
    this.onChoose(next.node);
    event.preventDefault();
  }
}
