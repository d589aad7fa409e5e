// node town_picture.mjs PEERD PACKAGES OUT.png: the picture of the README, a page of one of three real peers in the town of
// configs/scenarios/town.toml, half a minute after its start.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core. Exit codes: 0 good, 1 something is wrong,
// 77 skipped.
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { findBrowser, freePort, Page, Peer } from './real_peers.mjs';

const kConfiguration = join(dirname(fileURLToPath(import.meta.url)), '../../configs/scenarios/town.toml');
const [program, packages, out] = process.argv.slice(2).map((path) => resolve(path));

const launch = findBrowser(packages);
const port = await freePort();
const peers = ['ada', 'ben', 'cleo'].map((name) => new Peer(program, kConfiguration, name, port));
const addresses = await Promise.all(peers.map((peer) => peer.address));
const browser = await launch();
const faults = [];
const page = await Page.open(browser, 'ada', addresses[0], faults, { viewport: { width: 1280, height: 760 } });
await page.until('the town is shown', () => window.peerd.objects().length >= 20 && window.peerd.pictures > 10);
await page.viewpoint('The town');
await page.option('owner-colours', true);
await page.tab.evaluate(() => window.peerd.select('CAR_RED'));
await page.panel('peers');
await page.until('half a minute has passed', () => window.peerd.range_s[1] - window.peerd.range_s[0] > 30);
await page.shot(out);
await browser.close();
for (const peer of peers) await peer.leave();
if (faults.length > 0) {
  console.log(faults.join('\n'));
  process.exit(1);
}
