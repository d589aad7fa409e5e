// node many_objects.mjs PEERD PACKAGES [COUNT]: the time that the page's one thread takes for 10,000 moving objects, by the browser's
// own trace, and the bytes that it gets for them, on a real peer in a headless Chromium that draws in software. It prints figures
// (docs/measurements/viewer.md).
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core. Exit codes: 0 good, 77 skipped.
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join, resolve } from 'node:path';
import { findBrowser, freePort, Page, Peer } from './real_peers.mjs';

const [program, packages] = process.argv.slice(2, 4).map((path) => resolve(path));
const count = Number(process.argv[4] ?? 10000);
const kTraced_ms = 8000;

// Boxes that drift apart slowly, each by its own velocityVector.
function world() {
  const side = Math.ceil(Math.sqrt(count));
  const boxes = Array.from({ length: count }, (_, i) => {
    const [x, z] = [(i % side) - side / 2, Math.floor(i / side) - side / 2];
    return `Transform { translation ${x} 0 ${z} velocityVector ${0.002 * x} 0 ${0.002 * z} children USE BOX }`;
  });
  const view = `Viewpoint { description "All" position 0 ${0.8 * side} ${0.9 * side} orientation 1 0 0 -0.75 }`;
  return `#VRML V2.0 utf8\n${view}\nSwitch { choice DEF BOX Shape { appearance Appearance { material Material { } } geometry Box { size 0.6 0.6 0.6 } } }
DEF CAR Transform { translation 0 3 0 children USE BOX }\n${boxes.join('\n')}\n`;
}

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1] ?? NaN;

const launch = findBrowser(packages);
const folder = mkdtempSync(join(tmpdir(), 'peerd-many-'));
writeFileSync(join(folder, 'many.wrl'), world());
writeFileSync(join(folder, 'many.toml'), 'world = "many.wrl"\nduration_s = 3600\n\n[peer.a]\nid = 1\nowns = ["CAR"]\n');
const peer = new Peer(program, join(folder, 'many.toml'), 'a', await freePort());
const address = await peer.address;
const browser = await launch();
const page = await Page.open(browser, 'many', address, []);
await page.until('all objects are shown', (wanted) => window.peerd?.objects().length >= wanted && window.peerd.pictures > 20, count);
await browser.startTracing(page.tab, { categories: ['devtools.timeline', 'disabled-by-default-devtools.timeline'] });
const { works, span_s, bytes, poseFrames } = await page.tab.evaluate(async (span_ms) => {
  const begin = performance.now();
  const before = window.peerd.received;
  const found = [];
  let last = -1;
  while (performance.now() < begin + span_ms) {
    await new Promise((next) => requestAnimationFrame(next));
    if (window.peerd.pictures !== last) found.push(window.peerd.drawn.work_ms);
    last = window.peerd.pictures;
  }
  const { bytes, frames } = window.peerd.received;
  return { works: found, span_s: (performance.now() - begin) / 1000, bytes: bytes - before.bytes, poseFrames: frames - before.frames };
}, kTraced_ms);
const { traceEvents } = JSON.parse((await browser.stopTracing()).toString());
const drawn = await page.tab.evaluate(() => window.peerd.drawn);
// The page's main thread is the one with the most animation frames.
const threads = new Map();
for (const event of traceEvents) if (event.name === 'FireAnimationFrame') threads.set(event.tid, (threads.get(event.tid) ?? 0) + 1);
const [main] = [...threads].sort((a, b) => b[1] - a[1])[0];
const durations_ms = (name) => traceEvents.filter((event) => event.tid === main && event.name === name && event.dur !== undefined).map((event) => event.dur / 1000);
const frames = durations_ms('FireAnimationFrame').filter((ms) => ms > 0.3);
const messages = durations_ms('WebSocketReceive').concat(durations_ms('FunctionCall').filter((ms) => ms > 0.3));
console.log(`${count} objects, ${drawn.instances} instances in ${drawn.calls} draw calls; ${works.length} pictures in ${kTraced_ms / 1000} s`);
console.log(`our own work for a picture (poses, colours, culling, matrices): ${median(works).toFixed(2)} ms (median)`);
console.log(`an animation frame that draws, with three.js and the browser's WebGL calls: ${median(frames).toFixed(2)} ms (median of ${frames.length})`);
console.log(`a call of our code, of any kind, above 0.3 ms: ${median(messages).toFixed(2)} ms (median of ${messages.length})`);
const each_s = bytes / count / span_s;
console.log(`received: ${each_s.toFixed(0)} bytes an object and second (${((each_s * count) / 1e6).toFixed(1)} MB/s), in ${(poseFrames / span_s).toFixed(1)} frames a second: ${(bytes / count / poseFrames).toFixed(1)} bytes an object and frame`);
await browser.close();
await peer.leave();
rmSync(folder, { recursive: true });
