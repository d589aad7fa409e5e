import type { Outcome } from 'peerd';

import { fill, make } from '../page/make';
import { icon } from '../page/icons';
import type { Panel } from '../page/tabs';
import type { SceneFile } from '../scene/scene_file';

// Changes to the world: add VRML under a node, undo and redo; and what the picture leaves out.
export interface WorldActions {
  edit(request: Record<string, unknown>): Promise<Outcome>;
}

const kExample = `DEF BOX Transform {
  translation 0 1 0
  children Shape {
    appearance Appearance { material Material { diffuseColor 0.9 0.6 0.1 } }
    geometry Box { size 1 1 1 }
  }
}`;

export class WorldPanel implements Panel {
  readonly name = 'world';
  readonly title = 'World';
  readonly element = make('div', { class: 'panel' });
  private readonly text = make('textarea', { rows: 9, spellcheck: 'false', 'aria-label': 'VRML to add' });
  private readonly under = make('input', { placeholder: 'top level', 'aria-label': 'Node to add it under', spellcheck: 'false' });
  private readonly file = make('input', { type: 'file', accept: '.wrl,.vrml,.txt', 'aria-label': 'File to add' });
  private readonly controls: (HTMLInputElement | HTMLTextAreaElement | HTMLButtonElement)[];
  private readonly undrawn = make('div', {});
  private readonly world = make('p', { class: 'muted' });

  constructor(private readonly actions: WorldActions) {
    this.text.value = kExample;
    const add = make('button', { type: 'submit', class: 'button primary' }, 'Add');
    const undo = make('button', { type: 'button', class: 'button', click: () => void actions.edit({ do: 'undo' }) }, icon('undo'), 'Undo');
    const redo = make('button', { type: 'button', class: 'button', click: () => void actions.edit({ do: 'redo' }) }, icon('redo'), 'Redo');
    this.controls = [this.text, this.under, this.file, add, undo, redo];
    this.file.addEventListener('change', () => void this.read());
    const submit = (event: Event): void => {
      event.preventDefault();
      void this.add();
    };
    this.element.append(
      make('h2', {}, 'Edits'),
      make('div', { class: 'buttons', role: 'group', 'aria-label': 'Undo and redo' }, undo, redo),
      make('h2', {}, 'Add VRML'),
      make('form', { class: 'stacked', submit }, this.text, make('label', { class: 'field' }, make('span', {}, 'Under'), this.under), make('div', { class: 'file-row' }, this.file, add)),
      make('h2', {}, 'The picture'),
      this.world,
      this.undrawn,
    );
  }

  setMayEdit(mayEdit: boolean): void {
    for (const control of this.controls) control.disabled = !mayEdit;
  }

  showRecorded(): void {
    this.setMayEdit(false);
    this.element.prepend(make('p', { class: 'note' }, 'Nothing can be changed: this is a recording.'));
  }

  showUnder(path: string): void {
    this.under.placeholder = 'top level';
    this.under.setAttribute('title', `selected: ${path}`);
  }

  show(file: SceneFile): void {
    const rows = file.extras.undrawn ?? [];
    this.world.textContent = `${file.extras.world ?? 'The world'}, revision ${file.revision}: ${file.nodes.length} can move.`;
    fill(
      this.undrawn,
      rows.length === 0 ? make('p', { class: 'muted' }, 'Everything in the world is drawn.') : make('p', { class: 'muted' }, `Not drawn: ${rows.length}`),
      rows.length > 0 && make('ul', { class: 'undrawn' }, ...rows.slice(0, 100).map((row) => make('li', {}, make('code', {}, row.path), ` ${row.what}${row.count === undefined ? '' : `, ${row.count} times`}: ${row.why}`))),
    );
  }

  private async read(): Promise<void> {
    const file = this.file.files?.[0];
    if (file !== undefined) this.text.value = await file.text();
  }

  private async add(): Promise<void> {
    const under = this.under.value.trim();
    await this.actions.edit({ do: 'add', text: this.text.value, ...(under === '' ? {} : { under }) });
  }
}
