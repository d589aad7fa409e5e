// node page_test.mjs PEERD PACKAGE PACKAGES OUT: examples/javascript/live.html, served from elsewhere, shows a real peer's objects in a headless
// Chromium, where the peer lets its origin in, and says so where it does not. PACKAGES is the folder whose node_modules has playwright-core, OUT
// where a screenshot goes. Exit codes: 0 good, 1 something is wrong, 77 skipped, because there is no Chromium.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { basename, dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { findBrowser, kPatience_ms } from '../browser/real_peers.mjs';
import { onPeers } from './example_peers.mjs';

const [program, folder, packages, out] = process.argv.slice(2).map((path) => resolve(path));
const example = resolve(dirname(fileURLToPath(import.meta.url)), '../../examples/javascript/live.html');
const launch = findBrowser(packages);
mkdirSync(out, { recursive: true });

// The page, and beside it the package.
const server = createServer((request, answer) => {
  const { pathname } = new URL(request.url, 'http://localhost');
  const isPage = pathname === '/live.html';
  if (!isPage && !/^\/peerd\/\w+\.js$/.test(pathname)) return answer.writeHead(404).end();
  answer.writeHead(200, { 'content-type': isPage ? 'text/html' : 'text/javascript' }).end(readFileSync(isPage ? example : join(folder, basename(pathname))));
});
await new Promise((listens) => server.listen(0, '127.0.0.1', listens));
const { port } = server.address();
const origin = `http://localhost:${port}`;

await onPeers(program, async ([address]) => {
  const browser = await launch();
  try {
    const page = await browser.newPage({ viewport: { width: 720, height: 360 } });
    page.setDefaultTimeout(kPatience_ms);
    const faults = [];
    page.on('pageerror', (error) => faults.push(error.message));
    await page.goto(`${origin}/live.html#${address}`);
    await page.getByText('Peer a sees:').waitFor();
    const cells = (i) => page.locator('#rows tr').nth(i).locator('td').allTextContents();
    await page.locator('#rows tr').nth(2).waitFor();
    assert.deepEqual(await cells(0), ['PUCK', 'this peer', '-4.00', '0.00', '0.00']);
    assert.deepEqual((await cells(2)).slice(0, 2), ['WHEEL', '2']);
    const z = (await cells(2))[4];
    await page.waitForFunction((before) => document.querySelectorAll('#rows tr')[2].cells[4].textContent !== before, z);
    await page.screenshot({ path: join(out, 'live.png') });

    const stranger = await browser.newPage();
    await stranger.goto(`http://127.0.0.1:${port}/live.html#${address}`);
    await stranger.getByText(/the connection to the peer at .* has ended/).waitFor();
    assert.deepEqual(faults, []);
  } finally {
    await browser.close();
    server.close();
  }
}, ['--set', `gateway.origins=["${origin}"]`]);
