// node nodes_page_test.mjs PEERD PACKAGES OUT: the tree of all nodes, and what the page draws of LOD, Switch, Billboard, Text, Anchor, PixelTexture and of
// ROUTEs into coordinates, scales and colours, by the colours of pixels, on a real peer in a headless Chromium.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core, OUT where screenshots go. Exit codes: 0
// good, 1 something is wrong, 77 skipped.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, Page, Pixels, testPages, words } from './real_peers.mjs';

const kConfiguration = join(dirname(fileURLToPath(import.meta.url)), 'nodes.toml');
const { out } = words();

const kRed = [255, 0, 0];
const kGreen = [0, 255, 0];
const kBlue = [0, 0, 255];
const kYellow = [255, 255, 0];
const kMagenta = [255, 0, 255];
const kCyan = [0, 255, 255];

async function drawn(page) {
  const pixels = await Pixels.of(page);
  const is = async (what, place, wanted) => {
    const found = await pixels.at(place);
    check(pixels.isLike(found, wanted), `${what}: the pixel at ${place} is ${found}, and not ${wanted}`);
  };
  return { pixels, is };
}

async function near(page) {
  await page.viewpoint('Near');
  const { pixels, is } = await drawn(page);
  await is('level 0 of the LOD', [-6, 1, 0], kRed);
  await is('the Billboard', [-4, 1, 0], kBlue);
  await is('the Switch has its first choice', [0, -1.5, 0], [51, 255, 255]);
  await is('the lower pixel', [2, 0.45, 0.7], kMagenta);
  await is('the upper pixel', [2, 1.55, 0.7], kCyan);
  const letters = await pixels.countAround([-2, 1, 0], 60, kYellow);
  console.log(`the Text has ${letters} yellow pixels around its middle`);
  check(letters > 200, `the Text has only ${letters} yellow pixels`);
}

async function far(page) {
  await page.viewpoint('Far');
  await (await drawn(page)).is('level 1 of the LOD', [-6, 1, 0], kGreen);
}

async function behind(page) {
  await page.viewpoint('Behind');
  await (await drawn(page)).is('the Billboard has turned', [-4, 1, 0], kBlue);
}

// What ROUTEs change: each place has both of its looks within a few seconds, and stands while the page is paused.
async function looksChange(page) {
  await page.viewpoint('Near');
  const places = { 'the cloth, below': [4, 0.6, 0], 'the cloth, above': [4, 3.3, 0], 'the lamp': [6, 1, 0.4], 'the box that breathes': [6.6, 2.5, 0] };
  const seen = Object.fromEntries(Object.keys(places).map((name) => [name, []]));
  for (let i = 0; i < 24; ++i) {
    const pixels = await Pixels.of(page);
    for (const [name, place] of Object.entries(places)) seen[name].push(await pixels.at(place));
  }
  for (const [name, colours] of Object.entries(seen)) {
    const spread = Math.max(...[0, 1, 2].map((channel) => Math.max(...colours.map((colour) => colour[channel])) - Math.min(...colours.map((colour) => colour[channel]))));
    check(spread > 100, `${name} keeps its colour: ${colours.join(' | ')}`);
  }
  await page.tab.evaluate(() => window.peerd.pause());
  await page.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 300)));
  const first = await Pixels.of(page);
  await page.tab.evaluate(() => new Promise((later) => setTimeout(later, 700)));
  const second = await Pixels.of(page);
  for (const [name, place] of Object.entries(places)) {
    const [a, b] = [await first.at(place), await second.at(place)];
    check(first.isLike(a, b), `${name} moves although the page is paused: ${a}, then ${b}`);
  }
  await page.tab.evaluate(() => window.peerd.live());
}

async function anchor(page) {
  await page.viewpoint('Near');
  const { x, y } = await page.tab.evaluate(() => window.peerd.on_window([0, 1, 0.7]));
  await page.tab.mouse.click(x, y);
  const offer = page.tab.locator('.anchor-offer');
  await offer.getByText('From far away').waitFor();
  await page.shot(join(out, 'anchor-1280.png'));
  await offer.getByRole('button', { name: 'Go there' }).click();
  await page.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 300)));
  await (await drawn(page)).is('the Anchor has led far away', [-6, 1, 0], kGreen);
  check(await offer.isHidden(), 'the offer stays when it was taken');
}

// An edit of whichChoice makes the page show the other one.
async function choice(page) {
  const reply = await page.tab.evaluate(() => window.peerd.ask({ do: 'set', path: 'CHOICE', field: 'whichChoice', value: '1' }));
  check(reply.ok, `the edit is refused: ${JSON.stringify(reply)}`);
  await page.until('the scene has the other choice', () => window.peerd.revision > 1);
  await page.viewpoint('Near');
  const { is } = await drawn(page);
  await is('the Switch has its second choice', [2, -1.5, 0], [255, 51, 255]);
}

const edited = (page, request) =>
  page.tab.evaluate(async (wanted) => {
    const reply = await window.peerd.ask(wanted);
    if (!reply.ok || !reply.done) throw new Error(`refused: ${JSON.stringify(reply)}`);
  }, request);

// The tree of all nodes is walked by keys alone, down to a Material without a name, whose field an edit changes.
async function nodesByKeys(page) {
  await page.panel('nodes');
  const row = (path) => page.tab.locator(`[role=treeitem][data-path="${path}"]`);
  const keys = async (...pressed) => {
    for (const key of pressed) await page.tab.keyboard.press(key);
  };
  const [width, room] = await page.tab.evaluate(() => {
    for (const [name, count] of [['objects', '10000'], ['peers', '10']]) document.querySelector(`[data-panel=${name}] .badge`).textContent = count;
    const { scrollWidth, clientWidth } = document.querySelector('.dock-left .tabs');
    return [scrollWidth, clientWidth];
  });
  check(width <= room, `the tabs are ${width} px wide, and have room for ${room}`);
  await row('LEVELS').locator('.row-owner', { hasText: 'Transform' }).waitFor();
  await page.tab.locator('[role=tree]').focus();
  await page.tab.evaluate(() => window.peerd.select('LAMP'));
  await page.until('the tree shows what is selected', () => document.querySelector('[data-path="LAMP"][aria-selected=true]') !== null);
  await page.tab.locator('[role=tree]').focus();
  await keys('ArrowRight', 'ArrowDown', 'ArrowDown', 'ArrowRight', 'ArrowRight', 'ArrowRight', 'ArrowRight', 'ArrowRight', 'ArrowRight');
  const material = 'LAMP/BREATH/0/appearance/material';
  await row(material).waitFor();
  check((await page.tab.locator('[role=tree]').getAttribute('aria-activedescendant')) === (await row(material).getAttribute('id')), 'the keys have not led to the Material');
  check((await row(material).getAttribute('aria-level')) === '5', 'the Material is not at level 5');
  await keys('Enter');
  await page.until('the Material is selected', (path) => window.peerd.selected === path, material);
  await page.tab.locator('.inspector .chip', { hasText: 'Material' }).waitFor();
  const field = page.tab.locator('.inspector [data-field="emissiveColor"]');
  check((await field.inputValue()) === '0.5 0 1', `the Material glows ${await field.inputValue()}`);
  await page.shot(join(out, 'tree-1280.png'));
  await field.fill('0 1 0');
  await field.press('Enter');
  await page.until('the Material glows green', async (path) => (await window.peerd.ask({ do: 'inspect', path })).fields?.emissiveColor === '0 1 0', material);
  await row(material).waitFor(); // what was open stays so
}

// What is added is in the tree at once; of ten thousand nodes only those that are seen are in the page.
async function nodesAreMany(page) {
  await edited(page, { do: 'add', text: `DEF MANY Group { children [ ${'Group{}'.repeat(5000)} ] }` });
  await page.until('the group is there', () => window.peerd.has('MANY/4999'));
  await edited(page, { do: 'add', under: 'MANY', text: 'Group{}'.repeat(5000) });
  await page.until('what was added is in the tree', () => window.peerd.has('MANY/9999'));
  await page.tab.locator('[role=tree]').focus();
  await page.tab.keyboard.press('End');
  await page.tab.locator('[role=treeitem][data-path="MANY"]').waitFor();
  const opened_ms = await page.tab.evaluate(() => {
    const began = performance.now();
    document.querySelector('[data-path="MANY"] .twisty').click();
    void document.querySelector('[role=tree]').getBoundingClientRect();
    return performance.now() - began;
  });
  await page.tab.keyboard.press('End');
  await page.tab.locator('[role=treeitem][data-path="MANY/9999"]').waitFor();
  const rows = await page.tab.locator('[role=treeitem]').count();
  console.log(`10,000 nodes open in ${opened_ms.toFixed(1)} ms; ${rows} of them are in the page`);
  check(rows < 60, `${rows} rows are in the page`);
  await page.shot(join(out, 'tree-10000-1280.png'));
  await edited(page, { do: 'remove', path: 'MANY' });
  await page.until('what was removed is not in the tree', () => !window.peerd.has('MANY') && document.querySelector('[data-path="MANY"]') === null);
}

await testPages(kConfiguration, ['a'], async (browser, [address], faults) => {
  const page = await Page.open(browser, 'nodes', address, faults);
  await page.until('the world is shown', () => window.peerd.objects().length >= 1 && window.peerd.pictures > 2 && window.peerd.range_s[1] > 1);
  await near(page);
  await page.shot(join(out, 'nodes-1280.png'));
  await far(page);
  await behind(page);
  await looksChange(page);
  await anchor(page);
  await choice(page);
  await nodesByKeys(page);
  await nodesAreMany(page);
  check((await page.tab.evaluate(() => window.peerd.undrawn.length)) === 0, 'something is not drawn');
  for (const [width, colorScheme] of [[800, 'dark'], [400, 'light'], [400, 'dark']]) {
    const narrow = await Page.open(browser, `${width} ${colorScheme}`, address, faults, { viewport: { width, height: 800 }, colorScheme });
    await narrow.until('the world is shown', () => window.peerd.objects().length >= 1 && window.peerd.pictures > 2);
    const [tabs, place] = await narrow.tab.evaluate(() => [document.querySelector('.dock-right .tabs')].flatMap(({ scrollWidth, clientWidth }) => [scrollWidth, clientWidth]));
    check(tabs <= place, `at ${width} px the tabs are ${tabs} px wide, and have room for ${place}`);
    await narrow.viewpoint('Near');
    const { x, y } = await narrow.tab.evaluate(() => window.peerd.on_window([0, 1, 0.7]));
    await narrow.tab.mouse.click(x, y);
    await narrow.tab.locator('.anchor-offer').getByText('From far away').waitFor();
    await narrow.shot(join(out, `nodes-${colorScheme}-${width}.png`));
    await narrow.context.close();
  }
});
