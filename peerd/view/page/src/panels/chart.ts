import { make, setText } from '../page/make';
import { cssColour } from '../page/theme';
import { roundedUp, type Series } from './series';

// A chart of the last minute, or of another stretch of time: lines, a scale of round numbers, and the values under the pointer.
const kSpan_s = 60;
const kHeight_px = 96;
const kLeft_px = 52;
const kBottom_px = 16;
const kTop_px = 8;

// What a chart shows up to an instant; `cursor_s`: an instant that it marks.
export interface ChartWindow {
  readonly span_s: number;
  readonly begin: string;
  readonly end: string;
  readonly cursor_s?: number;
}
const kLastMinute: ChartWindow = { span_s: kSpan_s, begin: '−60 s', end: 'now' };

export class Chart {
  readonly element: HTMLElement;
  private readonly canvas: HTMLCanvasElement;
  private readonly values: HTMLElement[];
  private pointer_x: number | null = null;

  constructor(
    title: string,
    private readonly series: readonly Series[],
    private readonly text: (value: number) => string,
  ) {
    this.canvas = make('canvas', { class: 'chart', role: 'img', 'aria-label': `${title}, the last minute` });
    this.values = series.map(() => make('span', { class: 'legend-value' }));
    const legend = series.map((line, i) =>
      make('span', { class: 'legend' }, make('i', { style: `background: var(${line.colour})` }), line.name, this.values[i]),
    );
    this.element = make('figure', { class: 'chart-figure' }, make('figcaption', {}, make('strong', {}, title), ...legend), this.canvas);
    this.canvas.addEventListener('pointermove', (event) => (this.pointer_x = event.offsetX));
    this.canvas.addEventListener('pointerleave', () => (this.pointer_x = null));
  }

  draw(now_s: number, window: ChartWindow = kLastMinute): void {
    const { span_s } = window;
    const width = this.canvas.clientWidth;
    if (width === 0) return;
    const context = this.prepared(width);
    if (context === null) return;
    const top = roundedUp(Math.max(...this.series.map((line) => line.greatest(now_s - span_s))));
    const x = (time_s: number): number => kLeft_px + (1 - (now_s - time_s) / span_s) * (width - kLeft_px - 1);
    const y = (value: number): number => kTop_px + (1 - value / top) * (kHeight_px - kTop_px - kBottom_px);
    this.drawScale(context, width, top, y, window);
    for (const line of this.series) drawLine(context, line, x, y);
    if (window.cursor_s !== undefined) this.drawCursor(context, x(window.cursor_s));
    this.showValues(context, now_s, width, window);
  }

  private drawCursor(context: CanvasRenderingContext2D, x: number): void {
    context.fillStyle = cssColour('--accent');
    context.fillRect(Math.round(x), kTop_px, 1, kHeight_px - kTop_px - kBottom_px);
  }

  private prepared(width: number): CanvasRenderingContext2D | null {
    const scale = window.devicePixelRatio;
    if (this.canvas.width !== Math.round(width * scale)) this.canvas.width = Math.round(width * scale);
    if (this.canvas.height !== Math.round(kHeight_px * scale)) this.canvas.height = Math.round(kHeight_px * scale);
    const context = this.canvas.getContext('2d');
    context?.setTransform(scale, 0, 0, scale, 0, 0);
    context?.clearRect(0, 0, width, kHeight_px);
    return context;
  }

  private drawScale(context: CanvasRenderingContext2D, width: number, top: number, y: (value: number) => number, window: ChartWindow): void {
    context.strokeStyle = cssColour('--line');
    context.fillStyle = cssColour('--muted');
    context.lineWidth = 1;
    context.font = '10.5px system-ui, sans-serif';
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const value of [0, top / 2, top]) {
      const at = Math.round(y(value)) + 0.5;
      context.beginPath();
      context.moveTo(kLeft_px, at);
      context.lineTo(width, at);
      context.stroke();
      context.fillText(this.text(value), kLeft_px - 6, at);
    }
    context.textBaseline = 'alphabetic';
    context.fillText(window.end, width, kHeight_px - 3);
    context.textAlign = 'left';
    context.fillText(window.begin, kLeft_px, kHeight_px - 3);
  }

  private showValues(context: CanvasRenderingContext2D, now_s: number, width: number, window: ChartWindow): void {
    const share = this.pointer_x === null ? 1 : (this.pointer_x - kLeft_px) / (width - kLeft_px);
    const pointed_s = now_s - (1 - Math.min(1, Math.max(0, share))) * window.span_s;
    const time_s = this.pointer_x === null ? window.cursor_s : pointed_s; // undefined: the last value of each line
    this.series.forEach((line, i) => {
      const value = time_s === undefined ? line.valueAt(line.length - 1) : line.nearest(time_s);
      setText(this.values[i], line.length === 0 || Number.isNaN(value) ? '–' : this.text(value));
    });
    if (this.pointer_x === null || this.pointer_x < kLeft_px) return;
    context.fillStyle = cssColour('--muted');
    context.fillRect(Math.round(this.pointer_x), kTop_px, 1, kHeight_px - kTop_px - kBottom_px);
  }
}

function drawLine(context: CanvasRenderingContext2D, line: Series, x: (t: number) => number, y: (v: number) => number): void {
  context.strokeStyle = cssColour(line.colour);
  context.lineWidth = 1.5;
  context.lineJoin = 'round';
  context.beginPath();
  let open = false;
  for (let i = 0; i < line.length; ++i) {
    const value = line.valueAt(i);
    const at = x(line.timeAt(i));
    if (Number.isNaN(value) || at < kLeft_px) {
      open = false;
      continue;
    }
    if (open) context.lineTo(at, y(value));
    else context.moveTo(at, y(value));
    open = true;
  }
  context.stroke();
}
