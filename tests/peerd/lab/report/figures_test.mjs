// node figures_test.mjs peerd/lab/report/figures.js: the figures that the report's script makes of data, by hand.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import test from 'node:test';

const figuresOf = new Function(`${fs.readFileSync(process.argv[2], 'utf8')}; return figuresOf;`)();

const line = (x, y) => ({x, y});
const run = {
  number: 1, title: 'latency 5 ms', scenario: 'zigzag', origin: 'sim, seed 7', scale: '5', duration_s: 4, bin_s: 1,
  object: 'CAR', owner: 'a', component: 'x', peers: ['a', 'b'], truth: line([0, 1, 2, 3], [0, 2, 4, 6]),
  observers: [{name: 'b', mean_m: 0.5, ghost: line([0, 1, 2, 3], [0, 1, null, 5]), error: line([0, 1, 2, 3], [0, 1, null, 1])}],
  updates: {count: 2, at: [0, 2], threshold_m: [0.5, 0.1]}, output: [{name: 'a', kB_s: [1, 2, 3, 2]}, {name: 'b', kB_s: [1, 1, 1, 1]}],
  contacts: {at: [1, 1.5, 3], known: [1, 2, 3], peer: [0, 1, 0], kind: [0, 2, 1], own: [1, 1, 0], counts: [1, 2000, 1, 0, 0]},
  events: [{at: 2, name: 'apart'}],
};
const named = (panel, name) => panel.series.find(series => series.name === name);

test('a run has its position, error and output', () => {
  const figure = figuresOf(new Map([[1, run]])).run({number: 1});
  const [position, error, output] = figure.cells[0].panels;
  assert.equal(figure.subtitle, 'zigzag (sim, seed 7), run 1: CAR, run by a');
  assert.deepEqual(position.y.range, [0, 6]);
  assert.deepEqual(error.y.range, [0, 1]);
  assert.deepEqual(output.y.range, [0, 3]);
  assert.deepEqual(named(position, 'contact').at, [1], 'the other outcome is of another object');
  assert.deepEqual(named(position, 'predicted').x, [3], 'the first sample of the ghost from 1.5 s on');
  assert.equal(named(position, 'ghost at b').legend, 'ghost at b, mean error 0.500 m');
  for (const panel of figure.cells[0].panels) assert.deepEqual(named(panel, 'event').labels, ['apart']);
});

test('a timeline counts what it has not', () => {
  const figure = figuresOf(new Map([[1, run]])).timeline({number: 1});
  const lanes = figure.cells[0].panels[2];
  assert.deepEqual(lanes.y.names, ['a', 'b']);
  assert.deepEqual(named(lanes, 'until it knew').x, [1.5, 2, 2]);
  assert.equal(named(lanes, 'decided').legend, '2000 decided');
  assert.deepEqual(figure.notes, ['1999 contacts not drawn']);
});

// Runs of a sweep over latency, order and approach.
function sweepOf(latencies, orders, approaches) {
  const all = approaches.flatMap(a => orders.flatMap(o => latencies.map(l => [l, o, a])));
  return {repeat: 1, keys: ['latency [ms]', 'order', 'approach'],
    runs: all.map(([l, o, a], i) => ({values: [l, o, a], words: [`latency ${l} ms`, `order ${o}`, a], error_m: 0.1 * i, updates: 10 * i}))};
}

test('small figures are numbered row by row, and have a third key in colours', () => {
  const sweep = sweepOf([100, 5, 500], [1, 2], ['dr', 'rcp']);
  const all = new Map(sweep.runs.map((_, i) => [i + 1, {...run, number: i + 1}]));
  all.delete(12);  // which the page has no room for
  const {cells, columns} = figuresOf(all, sweep).multiples();
  assert.equal(columns, 3);
  assert.deepEqual(cells.map(cell => cell.heading), ['1  order 1, latency 5 ms', '2  order 1, latency 100 ms', '3  order 1, latency 500 ms',
    '4  order 2, latency 5 ms', '5  order 2, latency 100 ms', '6  order 2, latency 500 ms']);
  assert.deepEqual(cells[0].lines.map(line => line.text), ['dr: 2 updates, mean 0.5 m', 'rcp: 2 updates, mean 0.5 m']);
  assert.equal(cells[5].lines.length, 1);
  assert.deepEqual(figuresOf(all, sweepOf([1, 2, 3, 4, 5, 6, 7, 8], [1], ['dr'])).multiples().cells, [], 'more columns than seven');
});

test('an overview has a line for each combination of the keys but the one with the most numbers', () => {
  const sweep = sweepOf([100, 5], [1], ['dr', 'rcp']);
  const [errors, updates] = figuresOf(new Map(), sweep).overview({}).cells.map(cell => cell.panels[0]);
  assert.equal(errors.x.label, 'latency [ms]');
  assert.deepEqual(errors.series.map(s => [s.name, s.colour, s.x]), [['order 1, dr', 0, [5, 100]], ['order 1, rcp', 1, [5, 100]]]);
  assert.deepEqual(errors.series[0].y, [0.1, 0]);
  assert.deepEqual(updates.bars.map(bar => bar.value), [5, 25]);
  const repeated = {...sweep, repeat: 2, runs: sweep.runs.flatMap(one => [one, {...one, updates: one.updates + 2}])};
  const again = figuresOf(new Map(), repeated).overview({}).cells[1].panels[0];
  assert.deepEqual(again.bars.map(bar => bar.value), [6, 26], 'means over seeds');
  const bars = figuresOf(new Map(), sweepOf([5], [1], ['dr', 'rcp'])).overview({}).cells[0].panels[0];
  assert.equal(bars.bars.length, 2, 'no key has two numbers');
});

// The range of the plan along x, and its highest -z, of a path of 100 m by 80 m with a shape of this role.
const truth = {name: 'truth', role: 'truth', x: [0, 100], y: [0, -80]};
const planOf = (...series) => figuresOf(new Map()).plan({subtitle: 'CAR', notes: [], series: structuredClone(series)});
const rectangle = (x0, z0, x1, z1) => ({name: 's', role: 'scene', polygons: [[x0, z0, x1, z0, x1, z1, x0, z1]]});
for (const [name, shape, least, greatest] of [
  ['a floor does not dwarf the paths', rectangle(-5000, -5000, 5000, 5000), 100, 115],
  ['a wall nearby', rectangle(104, -80, 106, 0), 106, 120],
  ['none far away', rectangle(600, -80, 602, 0), 100, 110],
  ['the near side of a long wall', rectangle(115, -5000, 116, 5000), 116, 125],
]) {
  test(`the plan has ${name}`, () => {
    const [{x, y}] = planOf(truth, shape).cells[0].panels;
    assert.ok(x.range[1] >= least && x.range[1] <= greatest, `${x.range}`);
    assert.ok(y.range[1] < 100, `${y.range}`);
  });
}

test('the plan is around where most are', () => {
  const path = {name: 'of b', role: 'path', x: [], y: []};
  for (let i = 0; i < 99; ++i) {
    path.x.push(i, i, null);
    path.y.push(-50, 50, null);
  }
  path.x.push(0, 9000, null);
  path.y.push(0, 0, null);
  const plan = planOf({...truth, x: [0, 10], y: [0, 0]}, path);
  const {range} = plan.cells[0].panels[0].x;
  assert.ok(range[0] <= 0 && range[1] >= 98 && range[1] < 200, `${range}`);
  assert.deepEqual(plan.notes, ['1 path leads out of the picture']);
});

test('the plan is a map, and a road along z lies along the page', () => {
  const map = planOf(truth);
  assert.equal(map.cells[0].panels[0].x.label, 'x [m]');
  assert.deepEqual(map.cells[0].panels[0].series[0].y, [-0, 80]);
  const road = planOf({...truth, x: [0, 10], y: [0, -300]});
  assert.match(road.subtitle, /turned by 90 degrees/);
  assert.deepEqual(road.cells[0].panels[0].series[0], {...truth, x: [-0, 300], y: [-0, -10]});
  for (const places of [{x: [], y: []}, {x: [3], y: [3]}]) {
    const {range} = planOf({...truth, ...places}).cells[0].panels[0].x;
    assert.ok(range[1] > range[0], `${range}`);
  }
});
