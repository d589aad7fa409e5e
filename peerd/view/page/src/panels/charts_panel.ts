import { type PoseBook, PoseFlag, type Status } from 'peerd';

import { make } from '../page/make';
import type { Panel } from '../page/tabs';
import type { SceneNode } from '../scene/scene_file';
import { Chart } from './chart';
import { bytesText, metresText } from './numbers';
import type { RunCharts } from './run_charts';
import { Rate, Series } from './series';

// How wrong the ghosts of this peer's objects are, and what the network carries for it.
export class ChartsPanel implements Panel {
  readonly name = 'charts';
  readonly title = 'Charts';
  readonly element = make('div', { class: 'panel' });
  private readonly mean = new Series('mean', '--accent');
  private readonly most = new Series('largest', '--own');
  private readonly selected = new Series('selected', '--warn');
  private readonly bytesIn = new Series('in', '--remote');
  private readonly bytesOut = new Series('out', '--own');
  private readonly updatesIn = new Series('in', '--remote');
  private readonly updatesOut = new Series('out', '--own');
  private readonly rates = { bytesIn: new Rate(), bytesOut: new Rate(), updatesIn: new Rate(), updatesOut: new Rate() };
  private readonly charts = [
    new Chart('Ghost error of own objects', [this.mean, this.most, this.selected], metresText),
    new Chart('Bytes a second', [this.bytesIn, this.bytesOut], (value) => `${bytesText(value)}`),
    new Chart('Updates a second', [this.updatesIn, this.updatesOut], (value) => String(Number(value.toPrecision(3)))),
  ];

  private recorded: RunCharts | null = null;

  constructor() {
    this.element.append(
      ...this.charts.map((chart) => chart.element),
      make('p', { class: 'note' }, 'The error is the distance from where this peer has an object to where all others predict it. Of objects of other peers the truth is not known here.'),
    );
  }

  sampleErrors(now_s: number, book: PoseBook, nodes: readonly SceneNode[], selected: number | null): void {
    let sum = 0;
    let count = 0;
    let most = NaN;
    for (const { index } of nodes) {
      if ((book.shown.flags[index] & PoseFlag.own) === 0) continue;
      const error_m = book.errorOf(index);
      if (Number.isNaN(error_m)) continue;
      sum += error_m;
      count += 1;
      if (!(most >= error_m)) most = error_m;
    }
    this.mean.add(now_s, count > 0 ? sum / count : NaN);
    this.most.add(now_s, most);
    this.selected.add(now_s, selected === null ? NaN : book.errorOf(selected));
  }

  sampleCounters(now_s: number, status: Status): void {
    const { counters } = status;
    this.bytesIn.add(now_s, this.rates.bytesIn.at(now_s, counters['bytes_in']));
    this.bytesOut.add(now_s, this.rates.bytesOut.at(now_s, counters['bytes_out']));
    this.updatesIn.add(now_s, this.rates.updatesIn.at(now_s, counters['updates_in']));
    this.updatesOut.add(now_s, this.rates.updatesOut.at(now_s, counters['updates_out']));
  }

  // The page shows a recording: these charts are in place of the own ones.
  showRecorded(charts: RunCharts): void {
    this.recorded = charts;
    this.element.replaceChildren(charts.element);
  }

  // now_s: of the page's own clock, or of the recording.
  draw(now_s: number): void {
    if (this.recorded !== null) {
      this.recorded.draw(now_s);
      return;
    }
    for (const chart of this.charts) chart.draw(now_s);
  }
}
