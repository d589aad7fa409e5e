// node sensors_page_test.mjs PEERD PACKAGES OUT: sensors that one page works move the same things alike on another peer's page, on
// two real peers in a headless Chromium.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core, OUT where screenshots go. Exit codes: 0
// good, 1 something is wrong, 77 skipped.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, Page, Pixels, testPages, words } from './real_peers.mjs';

const kConfiguration = join(dirname(fileURLToPath(import.meta.url)), 'sensors.toml');
const kPeers = ['a', 'b'];
const { out } = words();

const at = (page, place) => page.tab.evaluate((wanted) => window.peerd.on_window(wanted), place);
const world = async (page) => (await page.tab.evaluate(() => window.peerd.ask({ do: 'world' }))).world;

async function touch(pages) {
  const { x, y } = await at(pages[0], [-3, 1, 0.7]);
  const before = await world(pages[1]);
  await pages[0].tab.mouse.move(x, y);
  await pages[0].tab.mouse.down();
  await pages[1].until('the lamp shines while the bell is pressed', async () => /DEF LAMP PointLight[^}]*on TRUE/.test((await window.peerd.ask({ do: 'world' })).world));
  await pages[0].tab.mouse.up();
  for (const page of pages) {
    await page.until('the door opens', () => window.peerd.objects().find(({ path }) => path === 'DOOR').position_m[1] > 3.9);
  }
  const after = await world(pages[1]);
  check(/DEF LAMP PointLight(?![^}]*on TRUE)/.test(after), 'the lamp shines on');
  check(before !== after, 'nothing has changed');
}

// Both pages have the door at the same places at the same instants of the past.
async function doorIsAlike(pages) {
  const heights = [];
  const [, end] = await pages[0].tab.evaluate(() => window.peerd.range_s);
  for (const page of pages) {
    heights.push(await page.tab.evaluate(async (last) => {
      const found = [];
      for (let t = last - 5; t < last - 0.5; t += 0.25) {
        window.peerd.set_time(t);
        await new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)));
        found.push(window.peerd.objects().find(({ path }) => path === 'DOOR').position_m[1]);
      }
      window.peerd.live();
      return found;
    }, end));
  }
  // A page draws straight ways between the poses of ticks. A late tick cuts the corners where the door begins to move
  // and stops, so that only what lies between two instants on its way is compared.
  const moves = (i) => heights.every((of) => of[i] > 1.2 && of[i] < 3.8);
  const within = [...heights[0].keys()].filter((i) => moves(i - 1) && moves(i) && moves(i + 1));
  const worst = Math.max(...within.map((i) => Math.abs(heights[0][i] - heights[1][i])));
  console.log(`the door at ${within.length} instants of its way: ${worst.toFixed(3)} m apart at most on the two pages`);
  check(within.length > 2, `the door was hardly seen moving: ${heights[0]}`);
  check(worst < 0.15, 'the two pages have the door at different places');
}

async function drag(pages) {
  const [from, to, beyond] = [await at(pages[1], [3, 1, 0.5]), await at(pages[1], [4.5, 1, 0.5]), await at(pages[1], [9, 3, 0.5])];
  const { mouse } = pages[1].tab;
  const knobAt = () => async (wanted) => {
    const text = (await window.peerd.ask({ do: 'world' })).world;
    const found = text.match(/DEF KNOB Transform \{\s*translation ([-\d.e]+) ([-\d.e]+)/);
    return found !== null && Math.abs(Number(found[1]) - wanted) < 0.1 && Math.abs(Number(found[2]) - 1) < 0.01;
  };
  await mouse.move(from.x, from.y);
  await mouse.down();
  for (let i = 1; i <= 6; ++i) await mouse.move(from.x + ((to.x - from.x) * i) / 6, from.y);
  await pages[1].shot(join(out, 'knob-1280.png'));
  const pixels = await Pixels.of(pages[1]);
  const [left, taken] = [await pixels.at([2.7, 1, 0.5]), await pixels.at([4.5, 1, 0.5])];
  check(taken[2] > taken[0] + 60 && left[2] < left[0] + 60, `the knob is not drawn where it is dragged: there ${taken}, where it was ${left}`);
  await mouse.up();
  for (const page of pages) await page.until('the knob is where it was let go', knobAt(), 4.5);
  // The other page goes on from there, and not beyond the rail's end.
  await pages[0].until('the other page has the knob there', () => Math.abs(window.peerd.sensors.find(({ type }) => type === 'PlaneSensor').offset[0] - 4.5) < 0.1);
  const again = await at(pages[0], [4.5, 1, 0.5]);
  await pages[0].tab.mouse.move(again.x, again.y);
  await pages[0].tab.mouse.down();
  await pages[0].tab.mouse.move(beyond.x, beyond.y, { steps: 5 });
  await pages[0].tab.mouse.up();
  for (const page of pages) await page.until('the knob stays on its rail', knobAt(), 5);
}

const isRed = ([red, green, blue]) => red > 180 && green < 100 && blue < 100;
const around = ([x, y, z], radius, angle, axis) => axis === 'y' ? [x + radius * Math.sin(angle), y, z + radius * Math.cos(angle)] : [x - radius * Math.sin(angle), y + radius * Math.cos(angle), z];

// Drags a red mark from one place of the world to another one, and sees that it is drawn there before it is let go, whatever happens
// `meanwhile`.
async function dragMark(page, from, to, seen, picture, meanwhile = () => {}) {
  const { mouse } = page.tab;
  const [a, b] = [await at(page, from), await at(page, to)];
  await mouse.move(a.x, a.y);
  await mouse.down();
  for (let i = 1; i <= 8; ++i) await mouse.move(a.x + ((b.x - a.x) * i) / 8, a.y + ((b.y - a.y) * i) / 8);
  await meanwhile();
  // On a busy computer a picture may be taken before the page has drawn the last move.
  await page.tab.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
  await page.shot(join(out, picture));
  const pixels = await Pixels.of(page);
  const [there, before] = [await pixels.at(seen), await pixels.at(from)];
  check(isRed(there) && !isRed(before), `${picture}: the mark is not drawn where it is dragged: there ${there}, where it was ${before}`);
  await mouse.up();
}

async function hasTurned(pages, name, axis, angle) {
  for (const page of pages) {
    await page.until(`${name} is turned by ${angle}`, async ([node, wanted]) => {
      const text = (await window.peerd.ask({ do: 'world' })).world;
      const found = text.match(new RegExp(`DEF ${node} Transform \\{[^{[]*?rotation ([-\\d.e]+) ([-\\d.e]+) ([-\\d.e]+) ([-\\d.e]+)`));
      return found !== null && wanted.every((value, i) => Math.abs(Number(found[i + 1]) - value) < 0.03);
    }, [name, [...axis, angle]]);
    const { x, y } = await at(page, [0, 6.5, 0]);
    await page.tab.mouse.move(x, y);
  }
}

// Edits the world on one page, until another one shows the scene that comes of it.
async function editAndShow(page, other) {
  const before = await other.tab.evaluate(() => window.peerd.revision);
  check((await page.tab.evaluate(() => window.peerd.ask({ do: 'set', path: 'LAMP', field: 'intensity', value: '0.9' }))).ok, 'an edit was refused');
  await other.until('the edited scene is shown', (then) => window.peerd.revision > then, before);
}

async function turn(pages) {
  const drum = [-3, 5, 0];
  await dragMark(pages[0], around(drum, 1, 0, 'y'), around(drum, 1, 1, 'y'), around(drum, 1, 1, 'y'), 'drum-1280.png', () => editAndShow(pages[1], pages[0]));
  await hasTurned(pages, 'DRUM', [0, 1, 0], 1);
  const wheel = [3, 5, 0.3];
  const angleOfCrank = (angle) => Math.abs(window.peerd.sensors.find(({ min }) => min?.length === 1 && min[0] === -1).offset[0] - angle) < 0.03;
  await dragMark(pages[1], around(wheel, 0.6, 0), around(wheel, 0.6, 1.3), around(wheel, 0.6, 1), 'wheel-1280.png'); // its end is at 1
  await hasTurned(pages, 'WHEEL', [0, 1, 0], 1);
  await pages[0].until('the other page has the wheel there', angleOfCrank, 1);
  await dragMark(pages[0], around(wheel, 0.6, 1), around(wheel, 0.6, 0.2), around(wheel, 0.6, 0.2), 'wheel-back-1280.png');
  await hasTurned(pages, 'WHEEL', [0, 1, 0], 0.2);
  const globe = [0, -1.5, 0];
  await dragMark(pages[1], around(globe, 1, 0, 'y'), around(globe, 1, 0.8, 'y'), around(globe, 1, 0.8, 'y'), 'globe-1280.png');
  await hasTurned(pages, 'GLOBE', [0, 1, 0], 0.8);
}

// Whoever enters the hall lights it for all; the last that happens counts, whoever is still there.
async function enter(pages, reader) {
  const glows = (on) => [async (wanted) => /DEF GLOW PointLight[^}]*on TRUE/.test((await window.peerd.ask({ do: 'world' })).world) === wanted, on];
  const startOf = async (name) => Number((await world(pages[1])).match(new RegExp(`DEF ${name} TimeSensor \\{[^}]*startTime ([-\\d.e]+)`))?.[1] ?? 0);
  await reader.viewpoint('In the hall');
  await reader.tab.evaluate(() => new Promise((later) => setTimeout(later, 1000)));
  check((await startOf('GREETING')) === 0, 'a page without the token has entered the hall');
  await pages[0].viewpoint('In the hall');
  await pages[1].until('the hall is lit', ...glows(true));
  await pages[1].until('the flag is hoisted', () => window.peerd.objects().find(({ path }) => path.endsWith('FLAG')).position_m[1] > 2.9);
  await pages[0].shot(join(out, 'hall-1280.png'));
  const entered_s = await startOf('GREETING');
  check(entered_s > 0 && (await startOf('FAREWELL')) === 0, 'the hall has been left');
  await pages[1].viewpoint('In the hall');
  await pages[1].until('the second one is greeted, too', async (then) => {
    const text = (await window.peerd.ask({ do: 'world' })).world;
    return Number(text.match(/DEF GREETING TimeSensor \{[^}]*startTime ([-\d.e]+)/)[1]) > then;
  }, entered_s);
  await pages[0].viewpoint('In front');
  await pages[1].until('the hall is dark', ...glows(false)); // although one is still in it
  check((await startOf('FAREWELL')) > entered_s, 'nobody has left the hall');
  await pages[1].viewpoint('Before the hall');
  await walkIn(pages, glows);
}

// Who walks enters as the avatar does.
async function walkIn([walker, watcher], glows) {
  await walker.viewpoint('Before the hall');
  await walker.tab.locator('[data-tool=walk]').click();
  await walker.until('the avatar is there', () => window.peerd.avatar !== null);
  check(!(await watcher.tab.evaluate(...glows(true))), 'the hall is lit before anybody walks in');
  await walker.tab.locator('.picture').focus();
  await walker.tab.keyboard.down('w');
  await watcher.until('the avatar is in the hall, and it is lit', ...glows(true));
  await walker.tab.keyboard.up('w');
  await watcher.shot(join(out, 'walk-in-1280.png'));
  await walker.tab.locator('[data-tool=orbit]').click();
  await walker.until('the avatar is gone', () => window.peerd.avatar === null);
  await walker.viewpoint('In front');
  await watcher.until('the hall is dark', ...glows(false));
}

await testPages(kConfiguration, kPeers, async (browser, addresses, faults) => {
  const pages = [];
  for (const [i, address] of addresses.entries()) pages.push(await Page.open(browser, kPeers[i], address, faults));
  for (const page of pages) {
    await page.until('the world is shown', () => window.peerd.objects().length >= 3 && window.peerd.pictures > 2 && document.querySelector('[data-panel=peers] .badge')?.textContent === '1');
    await page.viewpoint('In front');
    check((await page.tab.evaluate(() => window.peerd.sensors.length)) === 6, 'the page has not six sensors');
  }
  const reader = await Page.open(browser, 'reader', addresses[0].replace(/#.*/, ''), faults);
  await reader.until('the world is shown', () => window.peerd?.objects().length >= 3 && window.peerd.pictures > 2);
  await touch(pages);
  await doorIsAlike(pages);
  await drag(pages);
  await turn(pages);
  await enter(pages, reader);
});
