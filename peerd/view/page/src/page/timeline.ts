import { clockText } from '../panels/numbers';
import type { Playhead } from '../time/playhead';
import { icon } from './icons';
import { fill, make, setText } from './make';

// The last minute: pause, go back, play on, go live. Marks show contacts.
const kSpan_s = 60;

export class Timeline {
  readonly element: HTMLElement;
  private readonly button = make('button', { type: 'button', class: 'tool play' });
  private readonly slider = make('input', { type: 'range', min: -kSpan_s, max: 0, step: 0.05, value: 0, 'aria-label': 'Time, seconds before now' });
  private readonly marks = make('div', { class: 'marks', 'aria-hidden': 'true' });
  private readonly readout = make('output', { class: 'readout' });
  private readonly live = make('button', { type: 'button', class: 'button live' }, make('i', { 'aria-hidden': 'true' }), 'Live');
  private shownState = '';

  constructor(private readonly head: Playhead, private readonly now_s: () => number) {
    this.button.addEventListener('click', () => this.toggle());
    this.slider.addEventListener('input', () => head.pauseAt(head.history.end_s + Number(this.slider.value)));
    this.live.addEventListener('click', () => head.goLive());
    this.element = make('footer', { class: 'timeline', 'aria-label': 'Time line' }, this.button, this.readout, make('div', { class: 'track' }, this.marks, this.slider), this.live);
  }

  toggle(): void {
    if (this.head.state === 'paused') this.head.play();
    else this.head.pauseAt(this.head.shownAt(this.now_s()));
  }

  update(): void {
    const { history, state } = this.head;
    const behind_s = state === 'live' ? 0 : Math.min(0, this.head.shownAt(this.now_s()) - history.end_s);
    if (document.activeElement !== this.slider || state !== 'paused') this.slider.value = String(behind_s);
    const kept_s = history.empty ? 0 : history.end_s - history.begin_s;
    this.slider.style.setProperty('--kept', `${Math.max(0, 100 * (1 - kept_s / kSpan_s)).toFixed(1)}%`);
    setText(this.readout, state === 'live' ? 'now' : `${clockText(behind_s)}`);
    if (state === this.shownState) return;
    this.shownState = state;
    this.element.dataset['state'] = state;
    fill(this.button, icon(state === 'paused' ? 'play' : 'pause'));
    this.button.setAttribute('aria-label', state === 'paused' ? 'Play' : 'Pause');
    this.live.setAttribute('aria-pressed', String(state === 'live'));
  }

  showMarks(times_s: readonly number[]): void {
    const end_s = this.head.history.end_s;
    const places = times_s.map((at_s) => 100 * (1 + (at_s - end_s) / kSpan_s)).filter((percent) => percent >= 0 && percent <= 100);
    fill(this.marks, ...places.map((percent) => make('i', { style: `left: ${percent.toFixed(2)}%` })));
  }
}
