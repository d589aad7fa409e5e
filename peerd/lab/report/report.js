// Draws the figures of report.html and compare.html. The page has data as JSON in <script> elements: of class "run" what
// happened in a run, of class "figure" a figure, in the <figure> that gets an SVG picture in its place. A figure has a
// title, a legend, and cells in rows and columns; a cell has panels one below the other. Numbers are in the units of the
// axes' labels; lengths are in pixels.
//
// figure  {title, subtitle, columns = 1, width = 710 (of a panel), cells: [cell or null, ..], notes: [text, ..]}
//         {kind, ..} is made into a figure by figures.js first
// cell    {heading, lines: [{text, colour, dash}, ..], panels: [panel, ..]}
// panel   {title, height, x: axis, y: axis, square, near, series: [series, ..]}; `square`: one scale for both axes;
//         `near`: the pointer finds the points near it in x (default), or in both directions ("xy")
//         {title, bars: [{label, value, text, colour, dash}, ..], log} has horizontal bars
// axis    {label, range: [low, high], zero, log, names: [text, ..]}; `zero`: starts at 0; names: one lane for each
// series  {name, legend, colour, opacity, ..}: series of one name are one entry of the legend, which switches them.
//         `colour`: the index of a peer's colour, or the name of one with a meaning
//         .. x, y: a line, interrupted where y is null; {width, dash, step, fill, mark, line: false, labels, written}
//         .. at: instants, by mark "upright" (over the height of the panel, with `labels`) or "comb" (short, at the foot)
//         .. polygons: [[x, y, x, y, ..], ..]
'use strict';
(() => {
  const SVG = 'http://www.w3.org/2000/svg';
  const FONT = "'DejaVu Sans', Verdana, Helvetica, Arial, sans-serif";
  // Light and dark. Peers have the colours of Okabe and Ito, which colour-blind readers can tell apart, without yellow,
  // which is lost on white.
  const COLOURS = {
    paper: ['#fff', '#16181b'], ink: ['#222', '#dcdfe3'], faint: ['#5b6168', '#aab1b9'], grid: ['#e4e4e4', '#2f3439'],
    frame: ['#777', '#8d949c'], truth: ['#b8b8b8', '#6a727b'], bar: ['#7d8ca3', '#7d8ca3'],
    event: ['#8a2b6b', '#d98bbf'], contact: ['#777', '#8d949c'],
    c0: ['#0072b2', '#3b9fd9'], c1: ['#d55e00', '#e5813a'], c2: ['#009e73', '#1fb58b'], c3: ['#cc79a7', '#cc79a7'],
    c4: ['#e69f00', '#e69f00'], c5: ['#56b4e9', '#56b4e9'],
  };
  const PEER_COLOURS = 6;
  const DASHES = ['', '6 4', '2 3', '9 3 2 3'];
  const GAP = 14;  // between panels of a cell

  const variables = which => Object.entries(COLOURS).map(([name, both]) => `--fig-${name}: ${both[which]};`).join(' ');
  const colour = of => `var(--fig-${typeof of === 'number' ? 'c' + of % PEER_COLOURS : of in COLOURS ? of : 'ink'})`;

  // --- Elements and texts

  function make(tag, attributes, parent) {
    const element = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) {
      if (value !== undefined && value !== '') element.setAttribute(name, value);
    }
    if (parent) parent.append(element);
    return element;
  }

  function write(parent, x, y, words, {size = 11, fill = 'ink', anchor = '', bold = false, turn = false} = {}) {
    const element = make('text', {
      x: round(x), y: round(y), 'font-size': size, fill: colour(fill), 'text-anchor': anchor,
      'font-weight': bold ? 'bold' : '', transform: turn ? `rotate(-90 ${round(x)} ${round(y)})` : '',
    }, parent);
    element.textContent = words;
    return element;
  }

  const round = pixels => Math.round(pixels * 10) / 10;
  const pen = document.createElement('canvas').getContext('2d');
  function widthOf(words, size = 11, bold = false) {
    pen.font = `${bold ? 'bold ' : ''}${size}px ${FONT}`;
    return pen.measureText(words).width;
  }

  // The end of a text that is too long, because the end of a path tells objects apart.
  function shortened(words, width, size = 11, bold = false) {
    const letters = [...words];
    while (letters.length > 0 && widthOf(words, size, bold) > width) {
      letters.shift();
      words = '…' + letters.join('');
    }
    return words;
  }

  function wrapped(words, width, size, bold) {
    const lines = [''];
    for (const word of words.split(' ')) {
      const longer = lines.at(-1) + (lines.at(-1) ? ' ' : '') + word;
      if (lines.at(-1) && widthOf(longer, size, bold) > width) lines.push(word);
      else lines[lines.length - 1] = longer;
    }
    return lines.map(line => shortened(line, width, size, bold));
  }

  // A number with four digits at most, but a count with all of its digits.
  function short(value) {
    if (Number.isInteger(value) && Math.abs(value) < 1e9) return String(value).replace('-', '−');
    const rounded = Number(value.toPrecision(4));
    const words = rounded !== 0 && (Math.abs(rounded) < 1e-4 || Math.abs(rounded) >= 1e7) ? rounded.toExponential() : String(rounded);
    return words.replaceAll('-', '−');
  }

  // --- Axes

  // Multiples of 1, 2 or 5 times a power of ten from low to high, as many as possible but at most `most`.
  function roundTicks(low, high, most) {
    for (let exponent = Math.floor(Math.log10((high - low) / most)); ; ++exponent) {
      for (const mantissa of [1, 2, 5]) {
        const step = mantissa * 10 ** exponent;
        const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
        if (last - first + 1 > most) continue;
        const decimals = Math.max(0, -exponent);
        const plain = decimals <= 6 && Math.max(Math.abs(low), Math.abs(high)) < 1e7;
        return Array.from({length: last - first + 1}, (_, i) => {
          const at = (first + i) * step;
          return {at, words: (plain ? (at + 0).toFixed(Math.min(decimals, 20)) : short(at)).replace(/^-(0(\.0*)?)$/, '$1').replaceAll('-', '−')};
        });
      }
    }
  }

  // The powers of ten times 1, 2 and 5, or as many of them as fit.
  function logTicks(low, high, most) {
    const all = [];
    for (let exponent = Math.floor(Math.log10(low)); 10 ** exponent <= high; ++exponent) {
      for (const mantissa of [1, 2, 5]) {
        const at = Number(`${mantissa}e${exponent}`);
        if (at >= low && at <= high) all.push({at, words: short(at), power: mantissa === 1});
      }
    }
    if (all.length <= most) return all;
    const powers = all.filter(tick => tick.power);
    const every = Math.ceil(powers.length / most);
    return powers.filter((_, i) => i % every === 0);
  }

  // The range of an axis: that of its data where it has none, with some room.
  function rangeOf(axis, values, room) {
    if (axis.names) return [axis.names.length - 0.5, -0.5];
    let [low, high] = axis.range || [Infinity, -Infinity];
    if (!axis.range) {
      for (const value of values) {
        if (value === null || (axis.log && value <= 0)) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    if (!(low <= high)) return axis.log ? [0.1, 1] : [0, 1];
    if (axis.log) return [low / 1.3, high * 1.3];
    if (axis.zero) return [0, high > 0 ? 1.06 * high : 1];
    if (high - low <= 1e-12 * Math.max(Math.abs(low), Math.abs(high))) return [low - Math.max(0.5, 1e-3 * Math.abs(low)), high + Math.max(0.5, 1e-3 * Math.abs(low))];
    return [low - room.below * (high - low), high + room.above * (high - low)];
  }

  // Maps the range to pixels from `from` to `to`.
  function scaleOf(axis, [low, high], from, to) {
    const value = axis.log ? Math.log10 : v => v;
    const map = v => from + (value(v) - value(low)) / (value(high) - value(low)) * (to - from);
    map.invert = pixel => {
      const v = value(low) + (pixel - from) / (to - from) * (value(high) - value(low));
      return axis.log ? 10 ** v : v;
    };
    map.ticks = most => axis.names ? axis.names.map((words, at) => ({at, words}))
      : axis.log ? logTicks(low, high, most) : roundTicks(low, high, most);
    return map;
  }

  // Ticks along x whose numbers do not touch.
  function ticksAcross(scale, length) {
    for (let most = 16; most > 2; --most) {
      const ticks = scale.ticks(most);
      const widest = Math.max(...ticks.map(tick => widthOf(tick.words)));
      const pitch = ticks.length > 1 ? Math.abs(scale(ticks[1].at) - scale(ticks[0].at)) : length;
      if (widest + 12 < pitch) return ticks;
    }
    return scale.ticks(2);
  }

  // --- Panels

  const marked = series => series.mark && series.x;
  const lined = series => series.x && series.line !== false;

  // All values of a panel's series along one axis.
  function* valuesOf(panel, which) {
    for (const series of panel.series) {
      if (series.x) yield* series[which];
      if (series.at && which === 'x') yield* series.at;
      for (const polygon of series.polygons || []) yield* polygon.filter((_, i) => i % 2 === (which === 'x' ? 0 : 1));
    }
  }

  // Finds the size of a panel and its scales, with its top left corner at (0, 0).
  function measure(panel, width) {
    if (panel.bars) {
      panel.size = {width, height: Math.max(1, panel.bars.length) * barPitch(panel)};
      panel.left = 0;
      return;
    }
    const comb = panel.series.some(series => series.mark === 'comb');
    const x = rangeOf(panel.x, valuesOf(panel, 'x'), panel.x.range ? {below: 0, above: 0} : {below: 0.04, above: 0.04});
    const y = rangeOf(panel.y, valuesOf(panel, 'y'), panel.square ? {below: 0, above: 0} : {below: comb ? 0.14 : 0.06, above: 0.06});
    let height = panel.height;
    if (panel.square) {
      const perUnit = Math.min(width / (x[1] - x[0]), 760 / (y[1] - y[0]));
      width = perUnit * (x[1] - x[0]);
      height = perUnit * (y[1] - y[0]);
    }
    panel.size = {width, height};
    panel.px = scaleOf(panel.x, x, 0, width);
    panel.py = scaleOf(panel.y, y, height, 0);
    panel.ticksX = ticksAcross(panel.px, width);
    panel.ticksY = panel.py.ticks(Math.max(2, Math.min(12, Math.floor(height / 22))));
    panel.left = Math.min(130, Math.max(...panel.ticksY.map(tick => widthOf(tick.words)))) + (panel.y.label ? 36 : 16);
  }

  function drawAxes(panel, group, withNumbers) {
    const {width, height} = panel.size, {px, py} = panel;
    const grid = make('g', {class: 'axes'}, group);
    const line = (x1, y1, x2, y2, of) => make('line', {x1: round(x1), y1: round(y1), x2: round(x2), y2: round(y2), stroke: colour(of)}, grid);
    for (const tick of panel.ticksX) {
      line(px(tick.at), 0, px(tick.at), height, 'grid');
      line(px(tick.at), height, px(tick.at), height + 4, 'frame');
      if (withNumbers) write(grid, px(tick.at), height + 17, tick.words, {anchor: 'middle'});
    }
    for (const tick of panel.ticksY) {
      const at = panel.y.names ? py(tick.at + 0.5) : py(tick.at);
      line(0, at, width, at, 'grid');
      if (!panel.y.names) line(-4, at, 0, at, 'frame');
      write(grid, -8, py(tick.at) + 4, shortened(tick.words, 122), {anchor: 'end'});
    }
    make('rect', {width: round(width), height: round(height), fill: 'none', stroke: colour('frame')}, grid);
    if (withNumbers && panel.x.label) write(grid, width / 2, height + 35, panel.x.label, {size: 12, anchor: 'middle'});
    if (panel.y.label) {
      const words = shortened(panel.y.label, height + GAP + 20, 12);
      write(grid, 16 - panel.left, height / 2, words, {size: 12, anchor: 'middle', turn: true});
    }
  }

  function pathOf(panel, series) {
    const {px, py} = panel;
    let path = '', before = null;
    series.x.forEach((x, i) => {
      const y = series.y[i];
      if (y === null || x === null) {
        before = null;
        return;
      }
      const at = `${round(px(x))},${round(py(y))}`;
      path += before === null ? `M${at}` : series.step ? `H${round(px(x))}V${round(py(y))}` : `L${at}`;
      before = y;
    });
    if (series.step && before !== null) path += `H${round(panel.size.width)}`;
    return path;
  }

  function drawMark(group, kind, x, y, of) {
    const stroke = colour(of);
    const circle = (r, fill) => make('circle', {cx: round(x), cy: round(y), r, fill, stroke, 'stroke-width': 1.6}, group);
    if (kind === 'ring') circle(4, 'none');
    else if (kind === 'disc') circle(3.5, stroke);
    else if (kind === 'dot') circle(2, stroke);
    else if (kind === 'cross') make('path', {d: `M${round(x - 4)},${round(y - 4)}l8,8m0,-8l-8,8`, stroke, 'stroke-width': 1.8, fill: 'none'}, group);
    else make('rect', {x: round(x - 3.5), y: round(y - 3.5), width: 7, height: 7, fill: stroke}, group);
  }

  // Instants as lines over the height of the panel, or as a comb at its foot. One path holds them all.
  function drawInstants(panel, series, group) {
    const {height} = panel.size;
    const comb = series.mark === 'comb';
    const foot = height - 7 * (series.row || 0);
    const path = series.at.map(t => comb ? `M${round(panel.px(t))},${foot}v-7` : `M${round(panel.px(t))},0V${height}`).join('');
    make('path', {d: path, stroke: colour(series.colour), fill: 'none', 'stroke-dasharray': !comb && !series.labels ? '2 3' : '', 'stroke-opacity': series.labels ? 0.7 : ''}, group);
  }

  // The names of events at the top of a panel, below each other where they would touch.
  function drawNames(panel, series, group) {
    const rows = [];
    series.labels.forEach((label, i) => {
      const words = shortened(label, panel.size.width / 4, 10), width = widthOf(words, 10), x = panel.px(series.at[i]);
      const begin = x + 3 + width <= panel.size.width ? x + 3 : x - 3 - width;
      let row = rows.findIndex(end => end <= begin);
      if (row < 0) row = rows.push(0) - 1;
      rows[row] = begin + width + 6;
      write(group, begin, 12 * (row + 1), words, {size: 10, fill: series.colour});
    });
  }

  // The numbers of points; one that would cover another is left out.
  function writeLabels(panel, series, group, taken) {
    series.x.forEach((x, i) => {
      const words = series.labels[i].replace('run ', ''), width = widthOf(words, 10);
      const at = {left: panel.px(x) + 6, top: panel.py(series.y[i]) - 14};
      const box = {left: at.left - 1, right: at.left + width + 1, top: at.top, bottom: at.top + 12};
      if (box.right > panel.size.width || box.top < 0) return;
      if (taken.some(b => b.left < box.right && box.left < b.right && b.top < box.bottom && box.top < b.bottom)) return;
      taken.push(box);
      const number = write(group, at.left, at.top + 10, words, {size: 10});
      for (const [name, value] of Object.entries({stroke: colour('paper'), 'stroke-width': 3, 'paint-order': 'stroke'})) number.setAttribute(name, value);
    });
  }

  let clips = 0;  // of the page, so that each has an id of its own

  function drawSeries(panel, group, isFirst) {
    const {width, height} = panel.size;
    const id = `clip-${++clips}`;
    make('rect', {width: round(width), height: round(height)}, make('clipPath', {id}, group));
    const inside = make('g', {'clip-path': `url(#${id})`}, group);
    const taken = [];
    for (const series of panel.series) {
      const own = make('g', {'data-series': series.name}, inside);
      series.groups = [own];
      const look = {stroke: colour(series.colour), 'stroke-width': series.width || 1.5, 'stroke-opacity': series.opacity, 'stroke-dasharray': DASHES[series.dash || 0]};
      for (const polygon of series.polygons || []) {
        const points = Array.from({length: polygon.length / 2}, (_, i) => `${round(panel.px(polygon[2 * i]))},${round(panel.py(polygon[2 * i + 1]))}`);
        make('polygon', {points: points.join(' '), fill: colour(series.colour), 'fill-opacity': series.opacity, stroke: colour(series.colour), 'stroke-width': 0.8, 'stroke-opacity': 0.7}, own);
      }
      if (series.at) drawInstants(panel, series, own);
      if (lined(series)) {
        const path = pathOf(panel, series);
        if (series.fill && path) make('path', {d: `${path}V${height}H${round(panel.px(series.x[0]))}Z`, fill: colour(series.colour), 'fill-opacity': 0.5}, own);
        make('path', {d: path, fill: 'none', 'stroke-linejoin': 'round', ...look}, own);
      }
      // Marks and words may stand over the edge.
      const over = make('g', {'data-series': series.name}, group);
      series.groups.push(over);
      if (marked(series)) {
        series.x.forEach((x, i) => {
          const at = [panel.px(x), panel.py(series.y[i])];
          if (at[0] > -1 && at[0] < width + 1 && at[1] > -1 && at[1] < height + 1) drawMark(over, series.mark, ...at, series.colour);
        });
      }
      if (series.written) writeLabels(panel, series, over, taken);
      if (series.at && series.labels && isFirst) drawNames(panel, series, over);
    }
  }

  const barPitch = panel => Math.max(9, Math.min(30, 330 / panel.bars.length));

  function drawBars(panel, group) {
    const pitch = barPitch(panel), size = Math.min(11, 0.95 * pitch), {width} = panel.size;
    const sample = panel.bars.some(bar => bar.dash !== undefined) ? 40 : 0;
    const words = panel.bars.map(bar => bar.text || short(bar.value));
    const labels = Math.min(0.5 * width, Math.max(0, ...panel.bars.map(bar => widthOf(bar.label, size))));
    const left = labels + sample + 10;
    const full = width - left - Math.max(0, ...words.map(text => widthOf(text, size))) - 10;
    const values = panel.bars.map(bar => bar.value);
    const logarithmic = panel.log && Math.min(...values) > 0;
    const high = Math.max(...values), low = Math.min(...values);
    // Of a logarithm, the least value has a bar too.
    const part = v => logarithmic ? (Math.log10(v / low) + 0.25) / (Math.log10(high / low) + 0.25) : high > 0 ? Math.max(0, v) / high : 0;
    panel.bars.forEach((bar, i) => {
      const y = pitch * (i + 0.5);
      const one = make('g', {class: 'bar'}, group);
      write(one, left - sample - 10, y + 0.36 * size, shortened(bar.label, labels + 1, size), {size, anchor: 'end'});
      if (sample) make('line', {x1: left - sample - 4, y1: y, x2: left - 8, y2: y, stroke: colour(bar.colour), 'stroke-width': 2, 'stroke-dasharray': DASHES[bar.dash || 0]}, one);
      const length = bar.value === null ? 0 : full * part(bar.value);
      make('rect', {x: round(left), y: round(y - 0.32 * pitch), width: round(length), height: round(0.64 * pitch), fill: colour(bar.colour)}, one);
      write(one, left + length + 6, y + 0.36 * size, words[i], {size});
      hover(one, () => [`${bar.label}: ${words[i]}`]);
    });
    make('line', {class: 'axes', x1: round(left), y1: 0, x2: round(left), y2: round(pitch * panel.bars.length), stroke: colour('frame')}, group);
  }

  // --- The pointer

  const tip = document.createElement('div');
  tip.className = 'tip';
  tip.hidden = true;

  // Shows the lines that `lines` gives for a pointer at the event, while it is over the element.
  function hover(element, lines, leave = () => {}) {
    element.addEventListener('pointermove', event => {
      const words = lines(event);
      tip.hidden = words.length === 0;
      tip.textContent = words.join('\n');
      const box = tip.getBoundingClientRect();
      tip.style.left = `${Math.max(0, Math.min(event.clientX + 14, window.innerWidth - box.width - 4))}px`;
      tip.style.top = `${Math.max(0, event.clientY + 14 + box.height > window.innerHeight ? event.clientY - box.height - 8 : event.clientY + 14)}px`;
    });
    element.addEventListener('pointerleave', () => {
      tip.hidden = true;
      leave();
    });
  }

  const shown = series => series.groups[0].getAttribute('display') !== 'none';

  // The index of the point that is nearest to x; of a step, the point that holds at x.
  function nearestInX(series, x) {
    let best = -1;
    series.x.forEach((at, i) => {
      if (series.y[i] === null || (series.step && at > x)) return;
      if (best < 0 || Math.abs(at - x) <= Math.abs(series.x[best] - x)) best = i;
    });
    return best;
  }

  function nearestInBoth(panel, px, py) {
    let best = null;
    for (const series of panel.series) {
      if (!series.x || !shown(series)) continue;
      series.x.forEach((x, i) => {
        if (series.y[i] === null) return;
        const distance = Math.hypot(panel.px(x) - px, panel.py(series.y[i]) - py);
        if (distance < 16 && (best === null || distance <= best.distance)) best = {series, i, distance};
      });
    }
    return best;
  }

  function addPointer(panel, group, stack) {
    const {width, height} = panel.size;
    const across = make('line', {y1: 0, y2: round(height), stroke: colour('faint'), 'stroke-dasharray': '3 3', visibility: 'hidden'}, group);
    panel.cross = x => {
      if (x !== null) for (const end of ['x1', 'x2']) across.setAttribute(end, round(panel.px(x)));
      across.setAttribute('visibility', x === null ? 'hidden' : 'visible');
    };
    const area = make('rect', {class: 'area', width: round(width), height: round(height), fill: 'none', 'pointer-events': 'all'}, group);
    const name = axis => axis.label ? axis.label.replace(/ \[.*/, '') : '';
    const unit = axis => (/\[(.*?)\]/.exec(axis.label || '') || ['', ''])[1];
    const value = (axis, v) => axis.names ? axis.names[Math.round(v)] : `${short(v)} ${unit(axis)}`.trim();
    hover(area, event => {
      const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(area.getScreenCTM().inverse());
      if (panel.near === 'xy') {
        const found = nearestInBoth(panel, at.x, at.y);
        if (!found) return [];
        const {series, i} = found;
        return [(series.labels ? `${series.labels[i]}, ` : '') + series.name,
          `${name(panel.x)} ${value(panel.x, series.x[i])}`, `${name(panel.y)} ${value(panel.y, series.y[i])}`.trim()];
      }
      const x = panel.px.invert(at.x);
      for (const other of stack) if (other.cross && other.near !== 'xy') other.cross(x);
      const lines = [`${name(panel.x)} ${value(panel.x, x)}`];
      for (const series of panel.series) {
        if (!shown(series)) continue;
        if (series.at && series.labels) {
          series.at.forEach((t, i) => {
            if (Math.abs(panel.px(t) - at.x) < 4) lines.push(series.labels[i]);
          });
        }
        const i = series.x && series.line !== false ? nearestInX(series, x) : -1;
        if (i >= 0) lines.push(`${series.name}: ${value(panel.y, series.y[i])}`);
      }
      return lines;
    }, () => stack.forEach(other => other.cross && other.cross(null)));
  }

  // --- Legend, cells, figure

  // One entry for each name, in the order of the panels.
  function entriesOf(figure) {
    const entries = new Map();
    for (const cell of figure.cells) {
      for (const panel of cell ? cell.panels : []) {
        for (const series of panel.series || []) {
          const entry = entries.get(series.name) || {series, words: series.name, all: []};
          if (series.legend && entry.words === series.name) Object.assign(entry, {words: series.legend, series});
          entry.all.push(series);
          entries.set(series.name, entry);
        }
      }
    }
    return [...entries.values()];
  }

  function drawSample(group, series, y) {
    const middle = y - 4, stroke = colour(series.colour);
    if (series.polygons) make('rect', {x: 3, y: middle - 4, width: 14, height: 8, fill: stroke, 'fill-opacity': series.opacity, stroke, 'stroke-width': 0.8}, group);
    else if (series.at) make('path', {d: `M10,${middle - 6}v12`, stroke, 'stroke-dasharray': series.mark === 'upright' && !series.labels ? '2 3' : ''}, group);
    else if (lined(series)) make('line', {x1: 0, y1: middle, x2: 22, y2: middle, stroke, 'stroke-width': series.width || 1.5, 'stroke-dasharray': DASHES[series.dash || 0], 'stroke-opacity': series.opacity}, group);
    if (marked(series)) drawMark(group, series.mark, 10, middle, series.colour);
  }

  // Draws the legend in rows and returns its height.
  function drawLegend(figure, svg, left, top, width) {
    let x = 0, y = 0;
    for (const {series, words, all} of entriesOf(figure)) {
      const text = shortened(words, width - 30), needs = 28 + widthOf(text);
      if (x > 0 && x + needs > width) [x, y] = [0, y + 18];
      const group = make('g', {role: 'button', tabindex: 0, 'aria-pressed': true, class: 'entry', transform: `translate(${round(left + x)} ${round(top + y)})`}, svg);
      make('rect', {y: -13, width: round(needs), height: 17, fill: 'none', 'pointer-events': 'all'}, group);
      drawSample(group, series, 0);
      write(group, 26, 0, text);
      const toggle = () => {
        const off = group.getAttribute('aria-pressed') === 'true';
        group.setAttribute('aria-pressed', !off);
        group.setAttribute('opacity', off ? 0.4 : 1);
        for (const one of all) {
          for (const part of one.groups) off ? part.setAttribute('display', 'none') : part.removeAttribute('display');
        }
      };
      group.addEventListener('click', toggle);
      group.addEventListener('keydown', event => {
        if (event.key !== 'Enter' && event.key !== ' ') return;
        event.preventDefault();
        toggle();
      });
      x += needs + 14;
    }
    return x > 0 ? y + 18 : 0;
  }

  const sameAxis = (a, b) => a && b && JSON.stringify(a) === JSON.stringify(b);

  // Finds the places of a cell's panels, from its top, and its height.
  function stack(cell) {
    let y = cell.heading ? 16 : 0;
    y += 14 * (cell.lines || []).length + (cell.lines ? 4 : 0);
    cell.panels.forEach((panel, i) => {
      if (panel.title) y += 18;
      panel.top = y;
      panel.numbered = !panel.bars && !sameAxis(panel.x, cell.panels[i + 1] && cell.panels[i + 1].x);
      y += panel.size.height + (panel.numbered ? (panel.x.label ? 42 : 22) : 0) + (i + 1 < cell.panels.length ? GAP : 0);
    });
    cell.height = y;
  }

  function drawCell(cell, svg, left, top) {
    const group = make('g', {transform: `translate(${round(left)} ${round(top)})`}, svg);
    const width = cell.panels.length > 0 ? cell.panels[0].size.width : 0;
    let y = 0;
    if (cell.heading) write(group, 0, y += 12, shortened(cell.heading, width, 12, true), {size: 12, bold: true});
    for (const line of cell.lines || []) {
      y += 14;
      make('line', {x1: 0, y1: y - 4, x2: 18, y2: y - 4, stroke: colour(line.colour), 'stroke-width': 1.5, 'stroke-dasharray': DASHES[line.dash || 0]}, group);
      write(group, 24, y, shortened(line.text, width - 24));
    }
    cell.panels.forEach((panel, i) => {
      const own = make('g', {class: 'panel', transform: `translate(0 ${round(panel.top)})`}, group);
      if (panel.title) write(own, 0, -8, shortened(panel.title, width, 12), {size: 12});
      if (panel.bars) {
        drawBars(panel, own);
        return;
      }
      drawAxes(panel, own, panel.numbered);
      drawSeries(panel, own, i === 0);
      addPointer(panel, own, cell.panels);
    });
  }

  function draw(figure) {
    const columns = figure.columns || 1;
    const cells = figure.cells.filter(cell => cell);
    for (const cell of cells) {
      for (const panel of cell.panels) measure(panel, figure.width || 710);
      stack(cell);
    }
    // All cells of a column have one left edge, and all of a row one top.
    const panels = cells.flatMap(cell => cell.panels);
    const left = Math.max(20, ...panels.map(panel => panel.left));
    const cellWidth = Math.max(figure.columns > 1 ? figure.width : 0, ...panels.map(panel => panel.size.width));
    const pitch = cellWidth + left + 24;
    const width = Math.max(760, columns * pitch);
    const textWidth = width - left - 24;
    const svg = make('svg', {xmlns: SVG, 'font-family': FONT, role: 'group', 'aria-label': `${figure.title}: ${figure.subtitle}`});
    const back = make('rect', {fill: colour('paper')}, svg);
    let y = 8;
    for (const line of wrapped(figure.title, textWidth, 16, true)) write(svg, left, y += 20, line, {size: 16, bold: true});
    for (const line of wrapped(figure.subtitle, textWidth, 12)) write(svg, left, y += 18, line, {size: 12, fill: 'faint'});
    y += 24;
    y += drawLegend(figure, svg, left, y, textWidth) - 4;
    for (let first = 0; first < figure.cells.length; first += columns) {
      const row = figure.cells.slice(first, first + columns);
      row.forEach((cell, i) => cell && drawCell(cell, svg, left + i * pitch, y));
      y += Math.max(0, ...row.map(cell => cell ? cell.height : 0)) + 16;
    }
    for (const line of figure.notes && figure.notes.length > 0 ? wrapped(figure.notes.join('; '), textWidth, 11) : []) write(svg, left, y += 14, line, {fill: 'faint'});
    const size = {width: round(width), height: round(y + 8)};
    for (const element of [svg, back]) for (const [name, value] of Object.entries(size)) element.setAttribute(name, value);
    svg.setAttribute('viewBox', `0 0 ${size.width} ${size.height}`);
    return svg;
  }

  // --- The page

  // The picture as a file, with the colours of the light scheme as plain attributes, which every program knows.
  function save(svg, name) {
    const copy = svg.cloneNode(true);
    for (const area of copy.querySelectorAll('.area, [visibility="hidden"]')) area.remove();
    for (const entry of copy.querySelectorAll('.entry')) for (const name of ['role', 'tabindex', 'aria-pressed']) entry.removeAttribute(name);
    const text = new XMLSerializer().serializeToString(copy).replace(/var\(--fig-(\w+)\)/g, (_, of) => COLOURS[of][0]);
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([text], {type: 'image/svg+xml'}));
    link.download = `${name}.svg`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  function drawIn(element) {
    const data = element.querySelector('script.figure');
    if (!data) return;
    data.remove();
    const figure = JSON.parse(data.textContent);
    const svg = draw(figure.kind ? made[figure.kind](figure) : figure);
    const scroll = document.createElement('div');  // wide content scrolls by itself instead of the page
    scroll.className = 'scroll';
    scroll.tabIndex = 0;
    scroll.append(svg);
    element.prepend(scroll);
    const button = document.createElement('button');
    button.textContent = 'save as SVG';
    const page = document.querySelector('h1').textContent.replace(/[^\w.-]+/g, '-');
    button.addEventListener('click', () => save(svg, `${page}-${element.dataset.name}`));
    element.querySelector('figcaption').append(' ', button);
  }

  const runs = new Map();  // by number
  for (const element of document.querySelectorAll('script.run')) {
    const run = JSON.parse(element.textContent);
    runs.set(run.number, run);
  }
  const sweep = document.querySelector('script.sweep');
  const made = figuresOf(runs, sweep && JSON.parse(sweep.textContent));
  const style = document.createElement('style');
  style.textContent = `figure { ${variables(0)} } @media (prefers-color-scheme: dark) { figure { ${variables(1)} } } @media print { figure { ${variables(0)} } }`;
  document.head.append(style);
  document.body.append(tip);
  // A folded run is drawn when it is unfolded.
  for (const details of document.querySelectorAll('details')) {
    details.addEventListener('toggle', () => details.open && details.querySelectorAll(':scope figure').forEach(drawIn));
  }
  for (const element of document.querySelectorAll('figure')) {
    if (!element.closest('details:not([open])')) drawIn(element);
  }
})();
