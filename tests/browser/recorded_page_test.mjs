// node recorded_page_test.mjs PEERD PACKAGES OUT: `peerd view` on simulated runs and on a capture, in a headless Chromium.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core, OUT where screenshots go. Exit codes: 0
// good, 1 something is wrong, 77 skipped.
import { execFileSync, spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { differingPixels, looksWhole } from './pictures.mjs';
import { check, findBrowser, Page } from './real_peers.mjs';

const [program, packages, out] = process.argv.slice(2).map((path) => resolve(path));
const kScenarios = join(dirname(fileURLToPath(import.meta.url)), '../../configs/scenarios');
const kOneRun = ['--set', 'replication.approach="dr+rcp+acpt"', '--set', 'replication.order=2', '--set', 'network.latency_ms=100'];
const kHz = 30;
const kAlike_m = 1e-5; // places are kept in steps of a micrometre, and a cell of the report has nine digits

const views = [];

// `peerd view` of something; `address` is where its page is.
class View {
  constructor(what) {
    this.log = '';
    views.push(this);
    this.process = spawn(program, ['view', what], { stdio: ['ignore', 'pipe', 'pipe'] });
    this.ended = new Promise((done) => this.process.on('exit', (code, signal) => done(code ?? signal)));
    this.address = new Promise((found, failed) => {
      const read = (text) => {
        this.log += text;
        const line = this.log.match(/http:\/\/[\d.]+:\d+\//);
        if (line) found(line[0]);
      };
      this.process.stdout.on('data', read);
      this.process.stderr.on('data', read);
      void this.ended.then((code) => failed(new Error(`peerd view ${what} has ended with ${code}:\n${this.log}`)));
    });
  }
  async end() {
    this.process.kill('SIGTERM');
    check((await this.ended) === 0, `peerd view has not ended cleanly:\n${this.log}`);
  }
}

function simulate(scenario, folder, ...options) {
  execFileSync(program, ['sim', join(kScenarios, scenario), '--samples', 'all', '--out', folder, ...options], { stdio: 'ignore' });
  return folder;
}

// The report's rows of one observer and object: time and error.
function reported(folder, observer, object) {
  const rows = readFileSync(join(folder, 'errors.csv'), 'utf8').split('\n').slice(1).map((line) => line.split(','));
  return rows.filter((row) => row[2] === observer && row[3] === object).map((row) => ({ time_s: Number(row[1]), error_m: Number(row[13]) }));
}

async function seek(page, time_s) {
  await page.tab.evaluate((at_s) => window.peerd.set_time(at_s), time_s);
  await page.until(`the instant ${time_s} s is shown`, (at_s) => window.peerd.time_s === at_s && window.peerd.settled, time_s);
}

async function showView(page, name) {
  await page.tab.getByLabel('Whose view is shown').selectOption({ label: name });
  await page.until(`the view of ${name} is shown`, (wanted) => window.peerd.view === wanted && window.peerd.settled && window.peerd.objects().length > 0, name);
}

// Where the ghost is wrong by more than at most other instants the page says the same error as the report.
async function errorsAreTheReports(page, folder) {
  await showView(page, 'c');
  const rows = reported(folder, 'c', 'CAR').filter(({ time_s }) => Math.abs(time_s * kHz - Math.round(time_s * kHz)) < 1e-3);
  check(rows.length > 400, `the report has ${rows.length} instants of the page's`);
  const wrongest = rows.filter(({ error_m }) => error_m > 0.05);
  check(wrongest.length > 10, 'the report has no errors to compare');
  let alike = 0;
  const some = wrongest.filter((_, i) => i % Math.ceil(wrongest.length / 12) === 0);
  for (const { time_s, error_m } of some) {
    await seek(page, Math.round(time_s * kHz) / kHz);
    const car = await page.object('CAR');
    const distance_m = Math.hypot(...car.truth_m.map((value, axis) => value - car.ghost_m[axis]));
    check(Math.abs(distance_m - car.error_m) < 1e-9, `truth and ghost are ${distance_m} m apart, the error is ${car.error_m} m`);
    if (Math.abs(car.error_m - error_m) < kAlike_m) alike += 1;
    else console.log(`at ${time_s} s the page says ${car.error_m} m and the report ${error_m} m`);
  }
  console.log(`${alike} of ${some.length} errors are those of the report, the largest ${Math.max(...some.map(({ error_m }) => error_m)).toFixed(3)} m`);
  check(alike >= some.length - 1, 'the page says other errors than the report'); // one instant may lie on an update
}

async function truthIsDrawn(browser, page, folder) {
  const { time_s } = reported(folder, 'c', 'CAR').filter((row) => Math.abs(row.time_s * kHz - Math.round(row.time_s * kHz)) < 1e-3).reduce((a, b) => (b.error_m > a.error_m ? b : a));
  await seek(page, Math.round(time_s * kHz) / kHz);
  await page.tab.evaluate(() => window.peerd.select('CAR'));
  await page.tab.getByRole('button', { name: 'Look' }).click();
  await page.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 1200)));
  const stage = page.tab.locator('.picture');
  const without = await stage.screenshot();
  await page.option('truth', true);
  await page.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 500)));
  const pixels = await differingPixels(browser, without, await stage.screenshot());
  console.log(`the truth is drawn: ${pixels} pixels differ`);
  check(pixels > 100, `only ${pixels} pixels differ where the truth is drawn`);
  await page.shot(join(out, 'recorded-truth-1280.png'));
  await page.option('truth', false);
}

async function scrubs(browser, page) {
  await seek(page, 2);
  const stage = page.tab.locator('.picture');
  const before = { car: await page.object('CAR'), picture: await stage.screenshot() };
  await page.tab.locator('.timeline input').fill('6');
  await page.until('the slider has been followed', () => window.peerd.time_s === 6 && window.peerd.settled);
  await page.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 300)));
  const after = { car: await page.object('CAR'), picture: await stage.screenshot() };
  check(Math.hypot(...after.car.position_m.map((value, axis) => value - before.car.position_m[axis])) > 10, 'the car has not moved');
  const pixels = await differingPixels(browser, before.picture, after.picture);
  console.log(`scrubbed: ${pixels} pixels differ`);
  check(pixels > 200, `only ${pixels} pixels differ between two instants`);
  await page.tab.getByRole('button', { name: 'Play' }).click();
  await page.until('it plays', () => window.peerd.time_s > 6.5);
  await page.tab.getByRole('button', { name: 'Pause' }).click();
  const at = await page.tab.evaluate(() => window.peerd.time_s);
  await page.tab.evaluate(() => new Promise((later) => setTimeout(later, 300)));
  check(at === (await page.tab.evaluate(() => window.peerd.time_s)), 'time goes on although the page is paused');
}

async function nothingCanBeChanged(page) {
  check(await page.tab.locator('.segment[data-tool=hand]').isDisabled(), 'the hand could take something');
  check(await page.tab.locator('.segment[data-tool=walk]').isDisabled(), 'an avatar could walk');
  check(await page.tab.locator('[data-option=regions]').isDisabled(), 'regions could be asked for');
  await page.tab.evaluate(() => window.peerd.select('CAR'));
  check(await page.tab.getByRole('button', { name: 'Grab' }).isDisabled(), 'something could be grabbed');
  await page.panel('world');
  check(await page.tab.getByRole('button', { name: 'Add', exact: true }).isDisabled(), 'something could be added');
  await page.tab.getByText('Nothing can be changed: this is a recording.').waitFor();
}

async function widths(browser, address, faults, name) {
  for (const [width, colorScheme] of [[1280, 'light'], [1280, 'dark'], [800, 'light'], [400, 'light'], [400, 'dark']]) {
    const page = await Page.open(browser, `${name} ${width} ${colorScheme}`, address, faults, { viewport: { width, height: 800 }, colorScheme });
    await page.until('it shows the world', () => window.peerd.objects().length > 0 && window.peerd.settled);
    const [, end_s] = await page.tab.evaluate(() => window.peerd.range_s);
    await seek(page, end_s / 2);
    for (const option of ['owner-colours', 'labels']) await page.option(option, true);
    await page.tab.evaluate(() => window.peerd.select(window.peerd.objects()[0].path));
    if (width === 1280) await page.panel('charts');
    await page.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 600)));
    await looksWhole(page, width);
    await page.shot(join(out, `recorded-${name}-${colorScheme}-${width}.png`));
    await page.context.close();
  }
}

async function aRun(browser, faults, folder) {
  const run = simulate('eq47.toml', join(folder, 'eq47'), ...kOneRun);
  const view = new View(run);
  const address = await view.address;
  const page = await Page.open(browser, 'run', address, faults);
  await page.until('it shows the world', () => window.peerd.objects().length > 0 && window.peerd.settled);
  check((await page.tab.evaluate(() => window.peerd.views.join(' '))) === 'a b c', 'the views are not those of a, b and c');
  await scrubs(browser, page);
  await errorsAreTheReports(page, run);
  await truthIsDrawn(browser, page, run);
  await nothingCanBeChanged(page);
  const hits = await page.tab.evaluate(() => window.peerd.contacts().filter((contact) => contact.collider === 'CAR' && !contact.retracted).length);
  check(hits > 3, `there are ${hits} contacts, and the car hits the walls`);
  await page.context.close();
  await widths(browser, address, faults, 'run');
  await view.end();
}

// What an edit has added is there from then on, and not before.
async function aRunWithEdits(browser, faults, folder) {
  const view = new View(simulate('edits.toml', join(folder, 'edits')));
  const page = await Page.open(browser, 'edits', await view.address, faults);
  await page.until('it shows the world', () => window.peerd.objects().length > 0 && window.peerd.settled);
  const [begin_s, end_s] = await page.tab.evaluate(() => window.peerd.range_s);
  const pathsAt = async (time_s) => {
    await seek(page, time_s);
    return (await page.tab.evaluate(() => window.peerd.objects().map((object) => object.path))).join(' ');
  };
  const seen = [];
  for (let i = 0; i <= 8; ++i) seen.push(await pathsAt(begin_s + (i * (end_s - begin_s)) / 8));
  check(new Set(seen).size > 1, `the objects are always the same: ${seen[0]}`);
  for (let i = 8; i >= 0; --i) check((await pathsAt(begin_s + (i * (end_s - begin_s)) / 8)) === seen[i], 'going back shows other objects than going forth');
  await page.context.close();
  await view.end();
}

async function aCapture(browser, faults, folder) {
  const captures = join(folder, 'captures');
  simulate('snooker.toml', join(folder, 'snooker'), '--capture', captures);
  const view = new View(join(captures, 'a.pcapng'));
  const address = await view.address;
  const page = await Page.open(browser, 'capture', address, faults);
  await page.until('it shows the world', () => window.peerd.objects().length > 0 && window.peerd.settled);
  const [, end_s] = await page.tab.evaluate(() => window.peerd.range_s);
  const places = async (time_s) => {
    await seek(page, time_s);
    return page.tab.evaluate(() => window.peerd.objects().map((object) => object.position_m));
  };
  const early = await places(0.2 * end_s);
  const late = await places(0.9 * end_s);
  check(early.some((place, i) => Math.hypot(...place.map((value, axis) => value - late[i][axis])) > 0.1), 'nothing has moved');
  const deciders = await page.tab.evaluate(() => [...new Set(window.peerd.contacts().map((contact) => contact.decider_name))].filter((name) => name !== ''));
  check(deciders.length > 0 && deciders.every((name) => 'abc'.includes(name)), `the contacts were decided by ${deciders}`);
  check((await page.tab.locator('.run-view option').count()) === 1, 'a capture has one view');
  check((await page.tab.locator('label:has([data-option=truth])').isHidden()), 'a capture does not know the truth of others');
  await page.context.close();
  await widths(browser, address, faults, 'capture');
  await view.end();
}

const launch = findBrowser(packages);
mkdirSync(out, { recursive: true });
const folder = mkdtempSync(join(tmpdir(), 'peerd-view-'));
const faults = [];
let failed = false;
const browser = await launch();
try {
  await aRun(browser, faults, folder);
  await aRunWithEdits(browser, faults, folder);
  await aCapture(browser, faults, folder);
  check(faults.length === 0, `the consoles of the pages are not empty:\n${faults.join('\n')}`);
} catch (error) {
  failed = true;
  console.log(error.stack);
  if (faults.length > 0) console.log(`on the consoles:\n${faults.join('\n')}`);
}
await browser.close();
rmSync(folder, { recursive: true, force: true });
for (const view of views) view.process.kill('SIGKILL'); // that have not ended
process.exit(failed ? 1 : 0);
