import type { Inspected, Outcome } from 'peerd';

import { fill, make, setText } from '../page/make';
import { icon } from '../page/icons';
import type { Panel } from '../page/tabs';
import { metresText } from './numbers';

// The selected object: its owner, where it is, its fields and data, and what can be done with it.
export interface InspectorActions {
  edit(request: Record<string, unknown>): Promise<Outcome>;
  lookAt(): void;
  nameOf(peer: number | null): string;
}

export interface LiveNumbers {
  readonly place: ArrayLike<number> | null; // x y z [m]
  readonly speed_m_s: number;
  readonly error_m: number;
  readonly threshold_m: number;
}

const kLongField = 60;
const kRecordedNote = 'A recording does not keep fields and data, and nothing in it can be changed.';

export class InspectorPanel implements Panel {
  readonly name = 'object';
  readonly title = 'Object';
  readonly element = make('div', { class: 'panel inspector' });
  private readonly head = make('div', {});
  private readonly place = make('dd', {});
  private readonly speed = make('dd', {});
  private readonly error = make('dd', {});
  private readonly threshold = make('dd', {});
  private readonly body = make('div', {});
  private mayEdit = false;
  private recorded = false;
  private shown: Inspected | null = null;
  private shownText = '';

  constructor(private readonly actions: InspectorActions) {
    this.clear();
  }

  setMayEdit(mayEdit: boolean): void {
    this.mayEdit = mayEdit;
    this.shownText = '';
    if (this.shown !== null) this.show(this.shown);
  }

  clear(): void {
    this.shown = null;
    this.shownText = '';
    fill(this.element, make('div', { class: 'empty' }, make('p', {}, 'Nothing is selected.'), make('p', { class: 'muted' }, 'Click an object in the picture, or choose one in the list.')));
  }

  fault(path: string, sentence: string): void {
    this.shown = null;
    fill(this.element, make('h2', {}, path), make('p', { class: 'note warn' }, sentence));
  }

  // Of what stands in a recording the page knows the path alone.
  showStanding(path: string): void {
    this.show({ id: '', path, def: null, type: 'stands', owner: null, own: false, driven: false, threshold_m: null, fields: {}, data: {} });
  }

  show(inspected: Inspected): void {
    const text = JSON.stringify([inspected, this.mayEdit]);
    const typing = this.element.contains(document.activeElement) && document.activeElement?.matches('input, textarea') === true;
    if (text === this.shownText || (typing && this.shown?.path === inspected.path)) return;
    if (this.shown === null) fill(this.element, this.head, this.numbers(), this.body);
    this.shown = inspected;
    this.shownText = text;
    fill(this.head, ...this.headOf(inspected));
    if (this.recorded) fill(this.body, make('p', { class: 'note' }, kRecordedNote));
    else fill(this.body, ...this.fieldsOf(inspected), ...this.dataOf(inspected));
  }

  // Of a recording: what its frames say. There is no peer that could say more.
  showRecorded(path: string, owner: number, own: boolean, driven: boolean): void {
    this.recorded = true;
    this.show({ id: '', path, def: null, type: 'recorded', owner: owner === 0 ? null : owner, own, driven, threshold_m: null, fields: {}, data: {} });
  }

  update(numbers: LiveNumbers): void {
    const { place } = numbers;
    setText(this.place, place === null ? '–' : [place[0], place[1], place[2]].map((value) => value.toFixed(2)).join('  '));
    setText(this.speed, Number.isNaN(numbers.speed_m_s) ? '–' : `${numbers.speed_m_s.toFixed(2)} m/s`);
    setText(this.error, Number.isNaN(numbers.error_m) ? 'not known here' : metresText(numbers.error_m));
    setText(this.threshold, metresText(numbers.threshold_m));
  }

  private numbers(): HTMLElement {
    const row = (term: string, value: HTMLElement): Node[] => [make('dt', {}, term), value];
    return make('dl', { class: 'facts place' }, ...row('Position [m]', this.place), ...row('Speed', this.speed), ...row('Ghost error', this.error), ...row('Threshold', this.threshold));
  }

  private headOf(inspected: Inspected): Node[] {
    const whose = inspected.own ? 'own' : inspected.owner === null ? 'nobodys' : 'remote';
    const owner = inspected.own ? `${this.actions.nameOf(inspected.owner)} (this peer)` : this.actions.nameOf(inspected.owner);
    return [
      make('h2', { class: 'path' }, inspected.path),
      make('p', { class: 'chips' }, make('span', { class: 'chip' }, inspected.type), make('span', { class: 'chip', 'data-owner': '' }, make('span', { class: 'dot', 'data-whose': whose }), owner), inspected.driven && make('span', { class: 'chip' }, 'driven')),
      make('div', { class: 'buttons', role: 'group', 'aria-label': 'Actions on the object' }, ...this.buttonsOf(inspected)),
    ];
  }

  private buttonsOf({ id, path }: Inspected): Node[] {
    const act = (title: string, request: Record<string, unknown>, hint: string, style = 'button'): Node =>
      make('button', { type: 'button', class: style, title: hint, disabled: !this.mayEdit, click: () => void this.actions.edit(request) }, title);
    const remove = act('Remove', { do: 'remove', path }, 'Take it out of the world, for all peers', 'button danger');
    if (id === null) return [remove]; // such as a Material, which is nowhere by itself
    return [
      make('button', { type: 'button', class: 'button', title: 'Look at it', click: () => this.actions.lookAt() }, icon('focus'), 'Look'),
      act('Own', { do: 'own', path }, 'Ask its owner to give it to this peer'),
      act('Grab', { do: 'grab', path }, 'Own it, and keep it until it is released'),
      act('Release', { do: 'release', path }, 'Let it go'),
      remove,
    ];
  }

  private fieldsOf(inspected: Inspected): Node[] {
    const fields = Object.entries(inspected.fields);
    if (fields.length === 0) return [];
    // Poses and physics move it without an edit of its fields.
    const begins = Object.hasOwn(inspected.fields, 'translation') && (inspected.owner !== null || inspected.driven);
    const note = begins && make('p', { class: 'note muted' }, 'translation and rotation are where it began; it is at Position, above. Setting them lets it begin anew there.');
    return [make('h3', {}, 'Fields'), ...(note ? [note] : []), make('div', { class: 'fields' }, ...fields.map(([name, value]) => this.fieldOf(inspected.path, name, value)))];
  }

  private fieldOf(path: string, name: string, value: string): Node {
    const set = (text: string): void => void (text !== value && this.actions.edit({ do: 'set', path, field: name, value: text }));
    if (value.length > kLongField || value.includes('\n')) return make('details', { class: 'long-field' }, make('summary', {}, name, make('span', { class: 'muted' }, ` ${value.length} characters`)), make('pre', {}, value));
    return this.input(name, value, set, value.includes('{')); // nodes are changed by adding and removing them
  }

  private dataOf(inspected: Inspected): Node[] {
    const set = (key: string, value: string): void => void this.actions.edit({ do: 'data', path: inspected.path, key, value });
    const rows = Object.entries(inspected.data).map(([key, value]) => this.input(key, value, (text) => text !== value && set(key, text)));
    const key = make('input', { placeholder: 'key', 'aria-label': 'Key of new data', disabled: !this.mayEdit });
    const value = make('input', { placeholder: 'value', 'aria-label': 'Value of new data', disabled: !this.mayEdit });
    const submit = (event: Event): void => {
      event.preventDefault();
      if (key.value !== '') set(key.value, value.value);
      key.value = value.value = '';
      value.blur();
    };
    const form = make('form', { class: 'new-data', submit }, key, value, make('button', { class: 'button', disabled: !this.mayEdit }, 'Set'));
    return [make('h3', {}, 'Data'), make('div', { class: 'fields' }, ...rows), form];
  }

  private input(name: string, value: string, set: (text: string) => void, fixed = false): Node {
    const input = make('input', { value, 'aria-label': name, spellcheck: 'false', readonly: fixed || !this.mayEdit, 'data-field': name });
    input.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') input.blur();
      if (event.key === 'Escape') input.value = value;
    });
    input.addEventListener('change', () => set(input.value));
    return make('label', { class: 'field', title: name }, make('span', {}, name), input);
  }
}
