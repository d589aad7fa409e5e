// Makes figures, as report.js draws them, of what happened in runs. These are the kinds of data:
//
// run        {number, title, scenario, origin, scale, duration_s, object, owner, component, peers: [name, ..],
//            truth: line, observers: [{name, mean_m, ghost: line, error: line}, ..],
//            updates: {count, at, threshold_m}, output: [{name, kB_s}, ..] (of those that send most first), bin_s,
//            contacts: {at, known, peer, kind, own, counts}, events: [{at, name}, ..]}
//            line: {x, y} over time [s]; of runs of one `scale` the axes are alike; contacts are columns: `peer` is an
//            index, `kind` one of STATEMENTS, `own` says whether the object takes part; without an `object`, no peer
//            observes any
// sweep      {repeat, keys: [axis label, ..], runs: [{values, words, error_m, updates}, ..]}: a value and words a key
// overview   {title, subtitle, width}
// compare    {title, systems}, those of compare.json
// plan       {series, notes}: series with x and y in the world's x and z [m], each with a `role`
'use strict';
const figuresOf = (runs, sweep) => {
  const MOST_LANES = 10, MOST_SENDERS = 6;  // peers; there are six colours

  const most = (values, from = 0) => values.reduce((high, v) => v > high ? v : high, from);
  const least = values => values.reduce((low, v) => v !== null && v < low ? v : low, Infinity);
  const outputOf = (run, name) => run.output.find(sender => sender.name === name) || {kB_s: []};

  // The scales that all runs of one latency share, so that they can be laid side by side; output has one for all.
  const known = new Map();  // scales by latency
  function scalesOf(run) {
    if (known.has(run.scale)) return known.get(run.scale);
    const scales = {position: [Infinity, -Infinity], error: 0, owner: 0, peer: 0, threshold: 0};
    for (const other of runs.values()) {
      for (const sender of other.output) scales.peer = most(sender.kB_s, scales.peer);
      if (!other.object) continue;
      scales.owner = most(outputOf(other, other.owner).kB_s, scales.owner);
      scales.threshold = most(other.updates.threshold_m, scales.threshold);
      if (other.scale !== run.scale) continue;
      for (const line of [other.truth, ...other.observers.map(observer => observer.ghost)]) {
        scales.position = [Math.min(scales.position[0], least(line.y)), most(line.y.filter(y => y !== null), scales.position[1])];
      }
      for (const observer of other.observers) scales.error = most(observer.error.y, scales.error);
    }
    known.set(run.scale, scales);
    return scales;
  }

  const timeOf = run => ({label: 'time [s]', range: [0, run.duration_s]});
  const steps = (run, kB_s, look) => ({x: kB_s.map((_, i) => i * run.bin_s), y: kB_s, step: true, ...look});
  const mean = values => values.reduce((sum, v) => sum + v, 0) / Math.max(1, values.length);
  // The second line often covers the first, and dashes let the first show through. Colours are repeated with other dashes.
  const dashOf = i => i === 0 ? 0 : 1 + Math.floor(i / MOST_SENDERS) % 3;
  const where = (contacts, holds) => contacts.at.map((_, i) => i).filter(holds);

  // The outcomes that the object takes part in.
  function outcomesOf(run) {
    const {at, kind, own} = run.contacts;
    const times = where(run.contacts, i => own[i] && kind[i] < 2).map(i => at[i]);
    return times.length > 0 ? [{name: 'contact', colour: 'contact', mark: 'upright', at: times}] : [];
  }

  function withEvents(run, panels) {
    const event = {name: 'event', colour: 'event', mark: 'upright', at: run.events.map(e => e.at), labels: run.events.map(e => e.name)};
    if (run.events.length > 0) for (const panel of panels) panel.series.push({...event});
    return panels;
  }

  // The panels of position, error and output; one observer's, or all.
  function panelsOf(run, {position, error, output}, heights) {
    const scales = scalesOf(run), x = timeOf(run);
    return [
      {height: heights[0], x, y: {label: `${run.component} [m]`, range: scales.position}, series: position},
      {height: heights[1], x, y: {label: heights[1] > 100 ? 'ghost error [m]' : 'error [m]', range: [0, scales.error], zero: true}, series: error},
      {height: heights[2], x, y: {label: heights[2] > 100 ? 'output [kB/s]' : 'kB/s', range: [0, scales.owner], zero: true}, series: output},
    ];
  }

  // Places where an observer's ghost met something as predicted: a ring if that is the outcome, a cross if there was no
  // such outcome or it was on the other side.
  function predictionsOf(run, observer, colour) {
    const {at, kind, own, peer} = run.contacts, {x, y} = observer.ghost;
    return [['predicted', 'ring', [2, 4]], ['mispredicted', 'cross', [3]]].flatMap(([name, mark, kinds]) => {
      const found = where(run.contacts, i => own[i] && kinds.includes(kind[i]) && run.peers[peer[i]] === observer.name)
        .map(i => x.findIndex((t, k) => t >= at[i] && y[k] !== null)).filter(i => i >= 0);
      return found.length > 0 ? [{name, mark, colour, line: false, x: found.map(i => x[i]), y: found.map(i => y[i])}] : [];
    });
  }

  // In the manner of the thesis's figures A.1 to A.12.
  function runFigure({number}) {
    const run = runs.get(number), title = run.title, from = `${run.scenario} (${run.origin}), run ${number}: `;
    if (!run.object) return {title, subtitle: `${from}no object that another peer observes`, cells: []};
    const position = [...outcomesOf(run), {name: 'truth', colour: 'truth', width: 4, ...run.truth}];
    const error = outcomesOf(run), marks = [];
    run.observers.forEach((observer, i) => {
      const look = {name: `ghost at ${observer.name}`, colour: i, dash: dashOf(i)};
      position.push({...look, ...observer.ghost, legend: `${look.name}, mean error ${observer.mean_m.toFixed(3)} m`});
      error.push({...look, ...observer.error});
      marks.push(...predictionsOf(run, observer, i));
    });
    position.push(...marks, {name: 'updates', colour: 'ink', mark: 'comb', at: run.updates.at, legend: `${run.updates.count} updates`});
    const sent = outputOf(run, run.owner).kB_s, name = `sent by ${run.owner}`;
    const output = [steps(run, sent, {name, colour: 'bar', fill: true, legend: `${name}, mean ${mean(sent).toFixed(2)} kB/s`})];
    const panels = withEvents(run, panelsOf(run, {position, error, output}, [210, 170, 130]));
    return {title, subtitle: `${from}${run.object}, run by ${run.owner}`, cells: [{panels}]};
  }

  const STATEMENTS = [['to an own object', 'square', 'bar'], ['decided', 'square', 0], ['predicted', 'ring', 2], ['wrong', 'cross', 1], ['taken over', 'disc', 4]];

  // A lane for each peer with its statements about contacts at the contact's time, and a line to when the peer knew.
  function lanesOf(run) {
    const {at, known, peer, kind, counts} = run.contacts;
    const drawn = where(run.contacts, i => peer[i] < MOST_LANES);
    const late = drawn.filter(i => Math.abs(known[i] - at[i]) > 0.005 * run.duration_s);
    const series = late.length === 0 ? [] : [{name: 'until it knew', colour: 'contact', width: 1,
      x: late.flatMap(i => [at[i], known[i], known[i]]), y: late.flatMap(i => [peer[i], peer[i], null])}];
    STATEMENTS.forEach(([name, mark, colour], k) => {
      const found = drawn.filter(i => kind[i] === k);
      if (found.length > 0) series.push({name, mark, colour, line: false, legend: `${counts[k]} ${name}`, x: found.map(i => at[i]), y: found.map(i => peer[i])});
    });
    return {series, leftOut: counts.reduce((sum, n) => sum + n, 0) - drawn.length};
  }

  function timelineFigure({number}) {
    const run = runs.get(number), scales = scalesOf(run), x = timeOf(run);
    const senders = run.output.slice(0, MOST_SENDERS), lanes = run.peers.slice(0, MOST_LANES), notes = [];
    const panels = [{height: 130, x, y: {label: 'sent [kB/s]', range: [0, scales.peer], zero: true}, series: senders.map((sender, i) =>
      steps(run, sender.kB_s, {name: sender.name, colour: i, dash: dashOf(i), legend: `${sender.name} sends ${mean(sender.kB_s).toFixed(2)} kB/s`}))}];
    if (run.peers.length > senders.length) notes.push(`of ${run.peers.length} peers, what the ${senders.length} send that send most`);
    if (run.object) {
      const {at, threshold_m} = run.updates;
      panels.push({height: 110, x, y: {label: 'threshold [m]', range: [0, scales.threshold], zero: true}, series: [
        // Changes between two updates are not published. More marks could not be told apart.
        {name: 'threshold', legend: `threshold of ${run.object}`, colour: 'ink', x: at, y: threshold_m, step: true, mark: at.length < 350 ? 'dot' : undefined}]});
    }
    if (lanes.length > 0) {
      const {series, leftOut} = lanesOf(run);
      panels.push({height: 26 * lanes.length, near: 'xy', x, y: {names: lanes}, series});
      if (lanes.length < run.peers.length) notes.push(`contacts of ${lanes.length} of ${run.peers.length} peers`);
      if (leftOut > 0) notes.push(`${leftOut} contacts not drawn`);
    }
    return {title: run.title, subtitle: `${run.scenario}, run ${number}: what each peer sends, thresholds in force, contacts by who says so`,
      cells: [{panels: withEvents(run, panels)}], notes};
  }

  // One cell of the small figures of a sweep; runs that the page has not are left out.
  function smallCell(cell, observerName) {
    const position = [], error = [], output = [], lines = [];
    let first = null;
    cell.runs.forEach(({number, words}, colour) => {
      const run = runs.get(number), observer = run && run.object && run.observers.find(o => o.name === observerName);
      if (!observer) return;
      if (!first) {
        first = run;
        position.push(...outcomesOf(run), {name: 'truth', colour: 'truth', width: 3, ...run.truth});
        error.push(...outcomesOf(run));
      }
      const look = {name: words ? `ghost, ${words}` : 'ghost', colour, dash: dashOf(colour), width: 1.3};
      position.push({...look, ...observer.ghost}, {name: 'update', colour, mark: 'comb', row: colour, at: run.updates.at});
      error.push({...look, ...observer.error});
      output.push(steps(run, outputOf(run, run.owner).kB_s, look));
      lines.push({text: `${words ? `${words}: ` : ''}${run.updates.count} updates, mean ${Number(observer.mean_m.toPrecision(3))} m`, colour, dash: dashOf(colour)});
    });
    return first && {heading: cell.heading, lines, panels: panelsOf(first, {position, error, output}, [104, 76, 52])};
  }

  // --- All runs of a sweep

  const distinct = values => [...new Set(values)];

  // The swept keys, each with the words of its values in order of appearance, numbers by size.
  const keysOf = () => sweep.keys.map((axis, k) => {
    const numeric = sweep.runs.every(run => typeof run.values[k] === 'number');
    const sorted = numeric ? [...sweep.runs].sort((a, b) => a.values[k] - b.values[k]) : sweep.runs;
    return {k, axis, numeric, values: distinct(sorted.map(run => run.words[k]))};
  });
  const best = (keys, rank) => keys.reduce((a, b) => a && rank(a) >= rank(b) ? a : b, null);

  // Rows and columns of small figures, each like a run's with the same axes: columns are the numeric key with the most
  // values, rows the other key with the most, and the values of a third key are colours.
  function multiplesFigure() {
    const first = [...runs.values()].find(run => run.object && run.observers.length > 0);
    const keys = keysOf(), taken = [];
    const take = rank => {
      const key = best(keys.filter(one => !taken.includes(one)), rank);
      if (key) taken.push(key);
      return key || {values: ['']};
    };
    const count = key => key.values.length;
    const columns = take(key => count(key) + (key.numeric ? 1e6 : 0)), rows = take(count), colours = take(count);
    if (!first || keys.length === 0 || keys.length > 3 || count(columns) > 7 || count(rows) > 8 || count(colours) > 4) {
      return {title: 'Run by run', cells: [],
        subtitle: 'no figure of all runs side by side: none has an observed object, or the sweep has more than three keys or more values than can be told apart'};
    }
    const observer = first.observers[0].name, drawn = count(columns) * count(rows) * count(colours);
    const numberOf = words => 1 + sweep.runs.findIndex(run => keys.every(key => words.get(key) === run.words[key.k]));
    const cells = rows.values.flatMap(row => columns.values.map(column => {
      const words = new Map([[rows, row], [columns, column]]);
      const heading = [row, column].filter(text => text).join(', ');
      return {heading, runs: colours.values.map(colour => ({words: colour, number: numberOf(words.set(colours, colour))}))};
    }));
    const again = sweep.runs.length > drawn ? `; ${sweep.runs.length - drawn} runs repeat others and are left out` : '';
    return {title: `${first.scenario}: ${first.object} and its ghost at ${observer}, run by run`, columns: count(columns), width: 260,
      subtitle: `${first.origin}; one scale for each latency, one for output${again}`,
      cells: cells.map((cell, i) => smallCell({...cell, heading: `${i + 1}  ${cell.heading}`}, observer))};
  }

  // Errors over the numeric key with the most values, a line for each combination of the other keys, or else as bars;
  // and the updates.
  function overviewFigure(figure) {
    const key = best(keysOf().filter(k => k.numeric && k.values.length > 1), k => k.values.length);
    // Runs that differ in their seed alone are one point, which is their mean.
    const points = [];
    for (let i = 0; i + sweep.repeat <= sweep.runs.length; i += sweep.repeat) {
      const same = sweep.runs.slice(i, i + sweep.repeat), {words, values} = same[0];
      const others = words.filter((_, k) => !key || k !== key.k);
      if (same[0].error_m === null) continue;
      points.push({label: others.join(', '), whole: words.join(', '), last: others.at(-1), rest: others.slice(0, -1).join(),
        x: key && values[key.k], error_m: mean(same.map(run => run.error_m)), updates: mean(same.map(run => run.updates))});
    }
    // Colours tell the values of the last key apart, and patterns of dashes those of the keys before it.
    const colours = distinct(points.map(p => p.last)), dashes = distinct(points.map(p => p.rest));
    const lines = distinct(points.map(p => p.label)).map(label => {
      const own = points.filter(p => p.label === label);
      return {label, own, colour: colours.indexOf(own[0].last), dash: dashes.indexOf(own[0].rest)};
    });
    const bars = what => lines.map(({label, own, colour, dash}) => ({label, colour, dash, value: mean(own.map(p => p[what]))}));
    let errors = {title: 'mean ghost error [m], mean over the observers', bars: bars('error_m')};
    const updates = {title: 'updates sent', bars: bars('updates')};
    if (key) {
      const series = lines.map(({label, own, colour, dash}) => {
        const sorted = [...own].sort((a, b) => a.x - b.x);
        return {name: label, colour, dash, width: 2, mark: 'dot', x: sorted.map(p => p.x), y: sorted.map(p => p.error_m)};
      });
      errors = {title: 'mean ghost error, mean over the observers', height: 310, near: 'xy', series,
        x: {label: key.axis, zero: points.every(p => p.x >= 0)}, y: {label: 'mean ghost error [m]', zero: true}};
      // The updates of a single line change along it.
      if (lines.length === 1) updates.bars = points.map(p => ({label: p.whole, colour: 0, value: p.updates}));
      else updates.title = 'updates sent, mean over the runs of a line';
    }
    return {...figure, columns: 2, cells: [{panels: [errors]}, {panels: [updates]}]};
  }

  // --- The plan: which part of the world it shows, and how it lies on the page

  // A rectangle of the ground is [lowest x, lowest z, highest x, highest z].
  const NOTHING = [Infinity, Infinity, -Infinity, -Infinity];
  const isNothing = r => !(r[0] <= r[2] && r[1] <= r[3]);
  const around = (a, b) => [Math.min(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[2], b[2]), Math.max(a[3], b[3])];
  const within = (a, b) => [Math.max(a[0], b[0]), Math.max(a[1], b[1]), Math.min(a[2], b[2]), Math.min(a[3], b[3])];
  const grown = (r, by) => [r[0] - by, r[1] - by, r[2] + by, r[3] + by];
  const longer = r => Math.max(r[2] - r[0], r[3] - r[1]);
  const holds = (r, x, z) => r[0] <= x && x <= r[2] && r[1] <= z && z <= r[3];
  const addPoint = (r, x, z) => x === null ? r : around(r, [x, z, x, z]);

  // The rectangles around the pieces of all paths that have the role.
  function groundsOf(series, role) {
    const grounds = [];
    for (const one of series.filter(s => s.role === role)) {
      for (const polygon of one.polygons || []) {
        let ground = NOTHING;
        for (let i = 0; i < polygon.length; i += 2) ground = addPoint(ground, polygon[i], polygon[i + 1]);
        grounds.push(ground);
      }
      let ground = NOTHING;
      (one.x || []).forEach((x, i) => {
        if (x === null && !isNothing(ground)) grounds.push(ground);
        ground = x === null ? NOTHING : addPoint(ground, x, one.y[i]);
      });
      if (!isNothing(ground)) grounds.push(ground);
    }
    return grounds;
  }

  // Without the lowest and the highest tenth of the values, but a quarter of the rest more on either side: this holds all
  // values that are spread evenly, and all of less than ten.
  function usual(values) {
    const sorted = [...values].sort((a, b) => a - b), cut = Math.floor(sorted.length / 10);
    const low = sorted[cut], high = sorted[sorted.length - 1 - cut], room = 0.25 * (high - low);
    return [low - room, high + room];
  }

  // The ground around all paths and what stands near them. A few movers that go far off do not count, nor does what a
  // shape has far from the paths.
  function planGround(series) {
    const all = role => groundsOf(series, role).reduce(around, NOTHING);
    let paths = all('truth');
    const movers = groundsOf(series, 'path');
    if (movers.length > 0) {
      const x = usual(movers.flatMap(r => [r[0], r[2]])), z = usual(movers.flatMap(r => [r[1], r[3]]));
      const near = within(movers.reduce(around, NOTHING), [x[0], z[0], x[1], z[1]]);
      if (!isNothing(near)) paths = around(paths, near);
    }
    if (isNothing(paths)) return [0, 0, 1, 1];
    const ghosts = within(all('ghost'), grown(paths, 0.5 * longer(paths)));
    if (!isNothing(ghosts)) paths = around(paths, ghosts);
    const reach = longer(paths) || 1;
    let ground = paths;
    for (const [role, near] of [['scene', 0.2], ['owned', 0.5], ['mark', 0.5]]) {
      for (const shape of groundsOf(series, role)) {
        if (isNothing(within(shape, grown(paths, near * reach)))) continue;
        // A small shape is shown whole, of others a little beyond the paths, or the near side.
        const limit = grown(paths, Math.max(near, 0.25) * reach);
        const whole = holds(limit, shape[0], shape[1]) && holds(limit, shape[2], shape[3]);
        const wide = grown(paths, (near + 0.05) * reach), narrow = grown(paths, 0.05 * reach);
        const beside = [shape[2] < paths[0], shape[3] < paths[1], shape[0] > paths[2], shape[1] > paths[3]];
        ground = around(ground, whole ? shape : within(shape, wide.map((v, i) => beside[i] ? v : narrow[i])));
      }
    }
    ground = grown(ground, 0.02 * (longer(ground) || 1));
    const shortest = 0.06 * longer(ground);
    for (const i of [0, 1]) {
      const lacks = Math.max(0, shortest - (ground[i + 2] - ground[i])) / 2;
      ground[i] -= lacks;
      ground[i + 2] += lacks;
    }
    return ground;
  }

  // As on a map, x goes right and -z up. A road along z is turned clockwise to lie along the page.
  function planFigure(figure) {
    const ground = planGround(figure.series);
    const turned = ground[3] - ground[1] > 2 * (ground[2] - ground[0]);
    const onPage = (x, z) => x === null ? [null, null] : turned ? [-z, -x] : [x, -z];
    const paths = figure.series.filter(s => s.role === 'path');
    const leaving = paths.flatMap(s => groundsOf([s], 'path')).filter(r => !holds(ground, r[0], r[1]) || !holds(ground, r[2], r[3])).length;
    const notes = [...figure.notes];
    if (leaving > 0) notes.push(leaving === 1 ? '1 path leads out of the picture' : `${leaving} paths lead out of the picture`);
    const outside = ['mark', 'owned'].flatMap(role => groundsOf(figure.series, role)).filter(r => isNothing(within(r, ground))).length;
    if (outside > 0) notes.push(outside === 1 ? '1 object stands outside of the picture' : `${outside} objects stand outside of the picture`);
    for (const one of figure.series) {
      if (one.polygons) one.polygons = one.polygons.map(p => Array.from({length: p.length / 2}, (_, i) => onPage(p[2 * i], p[2 * i + 1])).flat());
      if (!one.x) continue;
      const places = one.x.map((x, i) => onPage(x, one.y[i]));
      [one.x, one.y] = [places.map(p => p[0]), places.map(p => p[1])];
    }
    const [a, b] = [onPage(ground[0], ground[1]), onPage(ground[2], ground[3])];
    const axis = (i, label) => ({label, range: [Math.min(a[i], b[i]), Math.max(a[i], b[i])]});
    const panel = {square: true, near: 'xy', x: axis(0, turned ? '−z [m]' : 'x [m]'), y: axis(1, turned ? '−x [m]' : '−z [m]'), series: figure.series};
    return {...figure, subtitle: figure.subtitle + (turned ? '; turned by 90 degrees: −z points right' : ''), cells: [{panels: [panel]}], notes};
  }

  // --- Systems side by side

  function compareFigure({title, systems}) {
    const bars = (heading, log, measure, decimals) => ({panels: [{title: heading, log, bars: systems.map((system, i) =>
      ({label: system.system, value: system[measure], text: system[measure] === null ? '-' : system[measure].toFixed(decimals), colour: i === 0 ? 2 : 'bar'}))}]});
    return {title, subtitle: 'by one scenario, network and seed; shorter is better', columns: 3, width: 290, cells: [
      bars('bytes/s, logarithmic', true, 'bytes_per_s', 0), bars('shown error [m], logarithmic', true, 'shown_error_m', 3),
      bars('shown later than true [ms]', false, 'others_delay_ms', 0)]};
  }

  return {run: runFigure, timeline: timelineFigure, overview: overviewFigure, multiples: multiplesFigure, plan: planFigure, compare: compareFigure};
};
