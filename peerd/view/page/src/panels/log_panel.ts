import { make } from '../page/make';
import type { Panel } from '../page/tabs';

// What has happened, newest first: events of the daemon, what it refused, and what the page did.
const kMostLines = 400;
export type LogKind = 'event' | 'contact' | 'refused' | 'done' | 'fault';

export class LogPanel implements Panel {
  readonly name = 'log';
  readonly title = 'Log';
  readonly element = make('div', { class: 'panel list-panel' });
  private readonly list = make('ol', { class: 'log', reversed: true });
  private readonly filter = make('select', { 'aria-label': 'What the log shows' });

  constructor() {
    for (const [value, title] of [['', 'All'], ['contact', 'Contacts'], ['refused', 'Refused and faults'], ['event', 'Other events'], ['done', 'Edits of this page']]) {
      this.filter.append(make('option', { value }, title));
    }
    this.filter.addEventListener('change', () => (this.list.dataset['only'] = this.filter.value));
    this.element.append(make('div', { class: 'search' }, this.filter), this.list);
  }

  clear(): void {
    this.list.replaceChildren();
  }

  // `when`: as it is shown, by default the time of day.
  add(kind: LogKind, sentence: string, when: string = new Date().toLocaleTimeString('en-GB')): void {
    const line = make('li', { class: 'log-line', 'data-kind': kind === 'fault' ? 'refused' : kind }, make('time', {}, when), make('span', {}, sentence));
    this.list.prepend(line);
    while (this.list.childElementCount > kMostLines) this.list.lastElementChild?.remove();
  }
}
