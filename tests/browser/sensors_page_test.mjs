// node sensors_page_test.mjs PEERD PACKAGES OUT: a TouchSensor and a PlaneSensor that one page works move the same things alike on
// another peer's page, on two real peers in a headless Chromium.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core, OUT where screenshots go. Exit codes: 0
// good, 1 something is wrong, 77 skipped.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, Page, testPages, words } from './real_peers.mjs';

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
  const worst = Math.max(...heights[0].map((height, i) => Math.abs(height - heights[1][i])));
  const moving = heights[0].filter((height) => height > 1.2 && height < 3.8).length;
  console.log(`the door at ${moving} instants of its way: ${worst.toFixed(3)} m apart at most on the two pages`);
  check(moving > 3, `the door was hardly seen moving: ${heights[0]}`);
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

await testPages(kConfiguration, kPeers, async (browser, addresses, faults) => {
  const pages = [];
  for (const [i, address] of addresses.entries()) pages.push(await Page.open(browser, kPeers[i], address, faults));
  for (const page of pages) {
    await page.until('the world is shown', () => window.peerd.objects().length >= 3 && window.peerd.pictures > 2 && document.querySelector('[data-panel=peers] .badge')?.textContent === '1');
    await page.viewpoint('In front');
    check((await page.tab.evaluate(() => window.peerd.sensors.length)) === 2, 'the page has not two sensors');
  }
  await touch(pages);
  await doorIsAlike(pages);
  await drag(pages);
});
