// node insight_page_test.mjs PEERD PACKAGES OUT: proximity spheres, the grid of regions, and levels of a hierarchy on the page of one
// of two real peers, in a headless Chromium.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core, OUT where screenshots go. Exit codes: 0
// good, 1 something is wrong, 77 skipped.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, Page, testPages, words } from './real_peers.mjs';

const kConfiguration = join(dirname(fileURLToPath(import.meta.url)), 'insight.toml');
const { out } = words();

const insight = (page) => page.tab.evaluate(() => window.peerd.insight);

async function proximity(page) {
  await page.option('proximity', true);
  await page.until('two spheres are drawn', () => window.peerd.insight.proximity === 2);
  await page.until('a sphere is tight', async () => (await window.peerd.ask({ do: 'surroundings' })).proximity.objects.some(({ tight }) => tight));
  await page.until('and then it is not', async () => !(await window.peerd.ask({ do: 'surroundings' })).proximity.objects.some(({ tight }) => tight));
}

async function regions(page) {
  await page.option('regions', true);
  await page.until('the regions are known', () => window.peerd.insight.joined.length > 0);
  const { joined } = await insight(page);
  console.log(`the peer has joined the regions ${joined}`);
  check(joined.length < 40, 'a peer with a small area of interest has joined all regions');
  const { regions: reply } = await page.tab.evaluate(() => window.peerd.ask({ do: 'surroundings' }));
  check(reply.cell_m === 3 && reply.published.length === 1 && joined.includes(reply.published[0]), `the puck is in ${reply.published} of ${joined}`);
}

async function hierarchy(page) {
  await page.tab.evaluate(() => window.peerd.select('STONE'));
  await page.option('hierarchy', true);
  await page.until('level 0 is one volume', () => window.peerd.insight.volumes === 1);
  await page.tab.locator('.menu summary').click();
  await page.tab.locator('[data-option="hierarchy-level"]').fill('2');
  await page.until('level 2 has more', () => window.peerd.insight.volumes > 1);
  const text = await page.tab.locator('.level-row output').textContent();
  console.log(`the slider says: ${text}`);
  check(/^level 2: \d+ volumes for 12 triangles/.test(text), `it says ${text}`);
  const refused = await page.tab.evaluate(() => window.peerd.ask({ do: 'hierarchy', path: 'NOTHING' }));
  check(!refused.ok, 'a hierarchy of nothing is given');
}

await testPages(kConfiguration, ['a', 'b'], async (browser, addresses, faults) => {
  for (const [width, colorScheme] of [[1280, 'light'], [1280, 'dark'], [800, 'dark'], [400, 'light']]) {
    const page = await Page.open(browser, `${width} ${colorScheme}`, addresses[0], faults, { viewport: { width, height: 800 }, colorScheme });
    await page.until('the world is shown', () => window.peerd.objects().length >= 2 && window.peerd.pictures > 2);
    await page.viewpoint('From the side');
    await proximity(page);
    await regions(page);
    await hierarchy(page);
    await page.shot(join(out, `insight-menu-${colorScheme}-${width}.png`));
    await page.tab.keyboard.press('Escape');
    await page.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 300)));
    await page.shot(join(out, `insight-${colorScheme}-${width}.png`));
    await page.context.close();
  }
});
