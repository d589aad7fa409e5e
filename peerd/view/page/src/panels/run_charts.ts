import { make } from '../page/make';
import { Chart } from './chart';
import { metresText } from './numbers';
import { Series } from './series';

// How wrong the ghosts of a recorded view are, over the whole recording. The line in it is the instant that is shown.
const kMostPoints = 1000;

export class RunCharts {
  readonly element: HTMLElement;
  private readonly mean = new Series('mean', '--accent');
  private readonly most = new Series('largest', '--own');
  private readonly selected = new Series('selected', '--warn');
  private readonly chart: Chart;

  constructor(private readonly end_s: number, private readonly hz: number, ofOthers: boolean) {
    this.chart = new Chart('Ghost error', [this.mean, this.most, this.selected], metresText);
    const sentence = ofOthers
      ? 'The error is the distance from where this view has an object of another peer to where that really is at the same instant. Of an own object that is selected it is the error of what all others predict.'
      : 'The error is the distance from where this peer has its object to where all others predict it. Where objects of other peers really were, a capture does not know.';
    this.element = make('div', {}, this.chart.element, make('p', { class: 'note' }, sentence));
  }

  // The mean and the largest error of each instant by turns.
  show(errors: Float32Array): void {
    take(this.mean, errors, 2, 0, this.hz);
    take(this.most, errors, 2, 1, this.hz);
  }
  showSelected(errors: Float32Array): void {
    take(this.selected, errors, 1, 0, this.hz);
  }

  draw(time_s: number): void {
    this.chart.draw(this.end_s, { span_s: Math.max(this.end_s, 1e-3), begin: '0 s', end: `${this.end_s.toFixed(1)} s`, cursor_s: time_s });
  }
}

// Of more instants than a series has points, the largest of several.
function take(series: Series, numbers: Float32Array, stride: number, offset: number, hz: number): void {
  series.clear();
  const count = Math.floor((numbers.length - offset + stride - 1) / stride);
  const step = Math.max(1, Math.ceil(count / kMostPoints));
  for (let i = 0; i < count; i += step) {
    let most = NaN;
    for (let k = i; k < Math.min(count, i + step); ++k) {
      const value = numbers[k * stride + offset];
      if (!(most >= value)) most = Number.isNaN(value) ? most : value;
    }
    series.add(i / hz, most);
  }
}
