import type { Recording } from '../live/recording';
import type { Playhead } from '../time/playhead';
import { icon } from './icons';
import { fill, make, setText } from './make';

// The time line of a recording: pause, go anywhere, play at a rate, and whose view is shown. Marks show contacts.
const kRates = [0.1, 0.25, 0.5, 1, 2, 4];
const kLeastSpan_s = 1e-3; // of a recording of one instant

export class RunTimeline {
  readonly element: HTMLElement;
  private readonly button = make('button', { type: 'button', class: 'tool play' });
  private readonly slider: HTMLInputElement;
  private readonly marks = make('div', { class: 'marks', 'aria-hidden': 'true' });
  private readonly readout = make('output', { class: 'readout run-readout' });
  private readonly views = make('select', { class: 'run-view', 'aria-label': 'Whose view is shown' });
  private shownState = '';
  private markCount = -1;

  constructor(private readonly head: Playhead, private readonly recording: Recording, onView: (view: number) => void) {
    this.slider = make('input', { type: 'range', min: 0, max: Math.max(recording.end_s, kLeastSpan_s), step: 0.01, value: 0, 'aria-label': 'Time, seconds from the begin' });
    this.button.addEventListener('click', () => this.toggle());
    this.slider.addEventListener('input', () => head.pauseAt(Number(this.slider.value)));
    this.views.append(...recording.views.map((view, i) => make('option', { value: String(i) }, view.name)));
    this.views.addEventListener('change', () => onView(Number(this.views.value)));
    const rates = make('select', { class: 'run-rate', 'aria-label': 'Rate' }, ...kRates.map((rate) => make('option', { value: String(rate) }, `${rate}×`)));
    rates.value = '1';
    rates.addEventListener('change', () => (head.rate = Number(rates.value)));
    const view = make('label', { class: 'run-view-label' }, make('span', { class: 'wide-only muted' }, 'View of'), this.views);
    this.element = make('footer', { class: 'timeline', 'aria-label': 'Time line' }, this.button, this.readout, make('div', { class: 'track' }, this.marks, this.slider), rates, view);
    this.views.disabled = recording.views.length < 2;
  }

  toggle(): void {
    if (this.head.state === 'playing') this.head.pauseAt(this.head.shownAt(0));
    else this.head.play();
  }

  showView(view: number): void {
    this.views.value = String(view);
  }

  update(): void {
    const { state } = this.head;
    const time_s = this.head.shownAt(0);
    if (document.activeElement !== this.slider || state === 'playing') this.slider.value = String(time_s);
    setText(this.readout, `${time_s.toFixed(2)} / ${this.recording.end_s.toFixed(2)} s`);
    if (state === this.shownState) return;
    this.shownState = state;
    this.element.dataset['state'] = state;
    fill(this.button, icon(state === 'playing' ? 'pause' : 'play'));
    this.button.setAttribute('aria-label', state === 'playing' ? 'Pause' : 'Play');
  }

  showMarks(times_s: readonly number[]): void {
    if (times_s.length === this.markCount) return; // of a view they do not change
    this.markCount = times_s.length;
    const span_s = Math.max(this.recording.end_s, kLeastSpan_s);
    const places = new Set(times_s.map((at_s) => ((100 * at_s) / span_s).toFixed(1)));
    fill(this.marks, ...[...places].map((percent) => make('i', { style: `left: ${percent}%` })));
  }
}
