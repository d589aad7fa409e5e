import { icon } from './icons';
import { make } from './make';

// Sentences that come and go: what the daemon refused, as it says it. Each stands in the log, too.
const kShown_ms = 8000;
const kMost = 4;

export class Notices {
  readonly element = make('div', { class: 'notices', role: 'status', 'aria-live': 'polite' });

  show(sentence: string, bad: boolean): void {
    const notice = make('div', { class: bad ? 'notice bad' : 'notice' }, make('span', {}, sentence));
    const close = make('button', { type: 'button', class: 'quiet', 'aria-label': 'Dismiss', click: () => notice.remove() }, icon('close'));
    notice.append(close);
    this.element.append(notice);
    while (this.element.childElementCount > kMost) this.element.firstElementChild?.remove();
    setTimeout(() => notice.remove(), kShown_ms);
  }
}
