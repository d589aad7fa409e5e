// node viewer_page_test.mjs PEERD PACKAGES OUT: the viewer on three real peers, in a headless Chromium.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core, OUT where screenshots go. Each step waits
// until what it asks for is so, and says what it waited for where that does not happen within kPatience_ms. Exit codes: 0
// good, 1 something is wrong, 77 skipped.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { differingPixels, looksWhole } from './pictures.mjs';
import { check, Page, testPages, words } from './real_peers.mjs';

const kPeers = ['a', 'b', 'c'];
const kConfiguration = join(dirname(fileURLToPath(import.meta.url)), 'viewer.toml');
const { out } = words();
const shot = (page, name) => page.shot(join(out, `${name}.png`));

async function objectsMove(browser, pages) {
  for (const page of pages) {
    await page.until('all three objects are shown', () => window.peerd.objects().length >= 3 && window.peerd.pictures > 2);
    await page.until('the peers are in one session', () => document.querySelectorAll('.card[data-peer]').length === 3 || document.querySelector('[data-panel=peers] .badge')?.textContent === '2');
    const before = await page.object('CAR');
    await page.until('the car moves', ([x, , z]) => {
      const car = window.peerd.objects().find((object) => object.path === 'CAR');
      return Math.hypot(car.position_m[0] - x, car.position_m[2] - z) > 1;
    }, before.position_m);
  }
  const stage = pages[0].tab.locator('.picture');
  const first = await stage.screenshot();
  const car = await pages[0].object('CAR');
  await pages[0].until('the car moves on', ([x, , z]) => {
    const now = window.peerd.objects().find((object) => object.path === 'CAR');
    return Math.hypot(now.position_m[0] - x, now.position_m[2] - z) > 1;
  }, car.position_m);
  const pixels = await differingPixels(browser, first, await stage.screenshot());
  console.log(`the car has moved: ${pixels} pixels differ`);
  check(pixels > 500, `only ${pixels} pixels of the picture differ after the car has moved by a metre`);
}

async function pickAndReadOwner(page) {
  const { window_px } = await page.object('PUCK');
  await page.tab.mouse.click(window_px.x, window_px.y);
  await page.until('the puck is selected by the daemon’s pick', () => window.peerd.selected === 'PUCK');
  await page.tab.locator('.inspector h2', { hasText: 'PUCK' }).waitFor();
  const owner = (await page.tab.locator('[data-owner]').textContent()).trim();
  check(owner === 'c', `the inspector says that ${owner} owns the puck, which c owns`);
}

// The hand takes the puck of another peer, draws it towards the stone and lets it go on the way.
async function grab(page, pages) {
  const { window_px } = await page.object('PUCK');
  await page.tab.mouse.move(window_px.x, window_px.y);
  await page.tab.mouse.down();
  for (const each of pages) await each.until('the puck is a’s', () => window.peerd.objects().find((object) => object.path === 'PUCK').owner === 1);
  return window_px;
}

async function release(page, from) {
  const to = (await page.object('STONE')).window_px;
  for (let i = 1; i <= 12; ++i) await page.tab.mouse.move(from.x + ((to.x - from.x) * i) / 30, from.y + ((to.y - from.y) * i) / 30);
  await page.tab.mouse.up();
}

// A hand that a busy computer holds up before it lets go has rested: what it held stays where it is. Then it throws once more.
async function grabAndThrow(page, pages) {
  await page.tab.locator('.segment[data-tool=hand]').click();
  const lies = await page.object('PUCK');
  for (let i = 1; ; ++i) {
    const from = await grab(page, pages);
    if (i === 1) await shot(page, 'grabbed-1280');
    await release(page, from);
    await page.until('the hand holds nothing', () => window.peerd.held === null);
    if (await page.moves('PUCK')) break;
    console.log('the hand has rested before it let go');
    check(i < 5, 'five throws, and the puck does not fly');
  }
  for (const each of pages) {
    await each.until('the puck flies', ([x]) => window.peerd.objects().find((object) => object.path === 'PUCK').position_m[0] > x + 0.5, lies.position_m);
  }
}

async function contactIsSeen(pages) {
  const deciders = [];
  for (const page of pages) {
    await page.until('a decided contact of puck and stone is known', () =>
      window.peerd.contacts().some((contact) => contact.collider === 'PUCK' && contact.collidee === 'STONE' && contact.decider !== null && !contact.retracted));
    const contact = await page.tab.evaluate(() => window.peerd.contacts().find((known) => known.collider === 'PUCK' && known.decider !== null && !known.retracted));
    check(Math.abs(contact.normal[0]) > 0.9, `the normal of the contact is ${contact.normal}`);
    deciders.push(contact.decider_name);
    if (await page.tab.locator('[data-panel=log]').isVisible()) {
      await page.panel('log');
      await page.tab.locator('.log-line', { hasText: `by ${contact.decider_name}` }).first().waitFor();
    }
  }
  console.log(`the contact is decided by ${deciders.join(', ')}, as the three pages say`);
  check(deciders.every((name) => name === deciders[0] && kPeers.includes(name)), `the pages name different deciders: ${deciders}`);
}

// The picture of the contact's instant has a mark there that names the decider.
async function contactIsMarked(page) {
  const contact = await page.tab.evaluate(() => window.peerd.contacts().find((known) => known.collider === 'PUCK' && known.decider !== null && !known.retracted));
  await page.tab.evaluate((time_s) => window.peerd.set_time(time_s), contact.at_s + 0.3);
  await page.tab.locator('.label.contact:not([hidden])', { hasText: `decided by ${contact.decider_name}` }).first().waitFor();
  await shot(page, 'contact-1280');
  await page.tab.getByRole('button', { name: 'Live' }).click();
}

async function addAndRemove(page, pages) {
  await page.panel('world');
  await page.tab.getByLabel('VRML to add').fill(`DEF BOX Transform {
  translation 0 0.5 4.5
  children Shape {
    appearance Appearance { material Material { diffuseColor 0.95 0.75 0.1 } }
    geometry Box { size 1.2 1.2 1.2 }
  }
}`);
  const began = performance.now();
  await page.tab.getByRole('button', { name: 'Add', exact: true }).click();
  for (const each of pages) await each.until('the box is there', () => window.peerd.has('BOX'));
  console.log(`a box is on all three pages after ${Math.round(performance.now() - began)} ms`);
  const { x, y } = await page.tab.evaluate(() => window.peerd.on_window([0, 1, 4.5]));
  await page.tab.mouse.click(x, y);
  await page.tab.locator('.inspector h2', { hasText: 'BOX' }).waitFor();
  await shot(page, 'box-1280');
  await page.tab.getByRole('button', { name: 'Remove' }).click();
  for (const each of pages) await each.until('the box is gone', () => !window.peerd.has('BOX'));
}

async function scrubBack(page) {
  await page.until('six seconds are kept', () => window.peerd.range_s[1] - window.peerd.range_s[0] > 6);
  await page.tab.locator('.timeline input').fill('-5');
  await page.until('the page stands in the past', () => window.peerd.state === 'paused' && window.peerd.range_s[1] - window.peerd.time_s > 4.5);
  const at = await page.tab.evaluate(() => window.peerd.time_s);
  const car = await page.object('CAR');
  await page.until('time goes on', (then) => window.peerd.range_s[1] - then > 7, at);
  const later = await page.object('CAR');
  check(car.position_m.every((value, axis) => value === later.position_m[axis]), 'the car moves although the page is paused');
  await shot(page, 'paused-1280');
  await page.tab.getByRole('button', { name: 'Play' }).click();
  await page.until('the past plays on', (then) => window.peerd.time_s > then + 0.5, at);
  await page.tab.getByRole('button', { name: 'Live' }).click();
  await page.until('the page is live', () => window.peerd.state === 'live');
}

// Somebody walks at one page: all pages see the avatar go, the peer looks from its eye, a wall ends the way, and closing the page
// takes the avatar away.
async function walk(browser, address, pages, faults) {
  const walker = await Page.open(browser, 'walker', address, faults);
  await walker.until('the world is there', () => window.peerd.objects().length >= 3 && window.peerd.pictures > 2);
  await walker.viewpoint('From the side');
  await walker.tab.locator('[data-tool=walk]').click();
  await walker.until('the avatar is there', () => window.peerd.avatar !== null);
  const path = await walker.tab.evaluate(() => window.peerd.avatar);
  for (const page of pages) await page.until('the avatar is seen', (avatar) => window.peerd.objects().some((object) => object.path === avatar), path);
  const from = await pages[0].object(path);
  await walker.tab.locator('.picture').focus();
  await walker.tab.keyboard.down('w');
  for (const page of pages) {
    await page.until('the avatar walks', ([avatar, [x, , z]]) => {
      const now = window.peerd.objects().find((object) => object.path === avatar);
      return now !== undefined && Math.hypot(now.position_m[0] - x, now.position_m[2] - z) > 0.5;
    }, [path, from.position_m]);
  }
  await walker.tab.keyboard.up('w');
  await shot(walker, 'walking');
  await walker.context.close();
  for (const page of pages) await page.until('the avatar is gone with its page', (avatar) => !window.peerd.has(avatar), path);
  console.log(`somebody has walked as ${path}`);
}

async function withoutToken(browser, address, faults) {
  const page = await Page.open(browser, 'without a token', address.replace(/#.*/, ''), faults);
  await page.tab.locator('.read-only').waitFor();
  await page.panel('world');
  check(await page.tab.getByRole('button', { name: 'Add', exact: true }).isDisabled(), 'a page without a token can add');
  await page.until('it shows the world all the same', () => window.peerd.objects().length >= 3);
  await shot(page, 'read-only-1280');
  await page.context.close();
}

async function widths(browser, address, faults) {
  for (const [width, colorScheme] of [[1280, 'dark'], [800, 'light'], [800, 'dark'], [400, 'light'], [400, 'dark']]) {
    const page = await Page.open(browser, `${width} ${colorScheme}`, address, faults, { viewport: { width, height: 800 }, colorScheme });
    await page.until('it shows the world', () => window.peerd.objects().length >= 3 && window.peerd.pictures > 10);
    await page.viewpoint('From the side');
    for (const name of ['owner-colours', 'ghosts', 'labels']) await page.option(name, true);
    await page.tab.evaluate(() => window.peerd.select('CAR'));
    await page.tab.locator('.inspector h2', { hasText: 'CAR' }).waitFor();
    await looksWhole(page, width);
    await shot(page, `${colorScheme}-${width}`);
    if (width === 1280) {
      await page.panel('charts');
      await page.panel('peers');
      await page.until('the error is charted', () => /\d/.test(document.querySelector('.legend-value').textContent));
      await shot(page, `charts-${width}`);
    }
    await page.context.close();
  }
}

async function firstPaint(page) {
  const [paint] = await page.tab.evaluate(() => performance.getEntriesByName('first-contentful-paint').map((entry) => entry.startTime));
  console.log(`first contentful paint after ${Math.round(paint)} ms`);
}

await testPages(kConfiguration, kPeers, async (browser, addresses, faults) => {
  const pages = [];
  for (const [i, address] of addresses.entries()) pages.push(await Page.open(browser, kPeers[i], address, faults));
  await firstPaint(pages[0]);
  await objectsMove(browser, pages);
  await shot(pages[0], 'live-1280');
  await pickAndReadOwner(pages[0]);
  await grabAndThrow(pages[0], pages);
  await contactIsSeen(pages);
  await contactIsMarked(pages[0]);
  await addAndRemove(pages[1], pages);
  await scrubBack(pages[2]);
  await walk(browser, addresses[0], pages, faults);
  for (const page of pages) await page.context.close();
  await withoutToken(browser, addresses[1], faults);
  await widths(browser, addresses[0], faults);
});
