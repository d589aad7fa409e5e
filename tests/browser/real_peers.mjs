// Real peers with their pages, and a headless Chromium to look at them: for tests and for pictures of the documents.
import { spawn } from 'node:child_process';
import { createSocket } from 'node:dgram';
import { existsSync, mkdirSync } from 'node:fs';
import { createRequire } from 'node:module';
import { delimiter, join, resolve } from 'node:path';

export const kPatience_ms = 120000; // a busy machine takes its time
const kFlags = ['--no-sandbox', '--disable-gpu-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--disable-quic',
  '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage'];

export function check(holds, sentence) {
  if (!holds) throw new Error(sentence);
}

function skip(sentence) {
  console.log(`skipped: ${sentence}`);
  process.exit(77);
}

// A function that starts a browser. `packages` is the folder whose node_modules has playwright-core. Where the browser or the
// package is missing, the process ends with 77.
export function findBrowser(packages) {
  if (!existsSync(join(packages, 'node_modules', 'playwright-core'))) skip(`no playwright-core in ${packages}: the viewer was not built`);
  const folders = (process.env.PATH ?? '').split(delimiter);
  const executablePath = folders.map((folder) => join(folder, 'chromium')).find(existsSync);
  if (!executablePath) skip('no program chromium; scripts/test --full installs it');
  const { chromium } = createRequire(join(packages, 'package.json'))('playwright-core');
  return () => chromium.launch({ executablePath, args: kFlags });
}

export async function freePort() {
  const socket = createSocket('udp4');
  await new Promise((done) => socket.bind(0, done));
  const { port } = socket.address();
  await new Promise((done) => socket.close(done));
  return port;
}

// A real peer with its gateway; `address` is where its page is.
export class Peer {
  constructor(program, configuration, name, port, more = []) {
    this.name = name;
    this.log = '';
    const words = ['run', '-c', configuration, '--peer', name, '--interface', 'lo', '--port', String(port), '--control', '', '--take-over', '--view', '127.0.0.1:0', ...more];
    this.process = spawn(program, words, { stdio: ['ignore', 'pipe', 'pipe'] });
    this.ended = new Promise((done) => {
      this.process.on('exit', (code, signal) => done(code ?? signal));
      this.process.on('error', (error) => done(error.message));
    });
    this.address = new Promise((found, failed) => {
      const read = (text) => {
        this.log += text;
        const line = this.log.match(/http:\/\/[\d.]+:\d+\/#token=[\w-]+/);
        if (line) found(line[0]);
      };
      this.process.stdout.on('data', read);
      this.process.stderr.on('data', read);
      void this.ended.then((code) => failed(new Error(`peer ${name} has ended with ${code}:\n${this.log}`)));
    });
    this.address.catch(() => undefined); // whoever waits for it says so
  }
  async leave() {
    this.process.kill('SIGTERM');
    check((await this.ended) === 0, `peer ${this.name} has not left cleanly:\n${this.log}`);
  }
}

// A page on a peer, and all that went wrong on it.
export class Page {
  static async open(browser, name, address, faults, options = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: 'light', reducedMotion: 'reduce', ...options });
    context.setDefaultTimeout(kPatience_ms);
    const tab = await context.newPage();
    tab.on('console', (message) => ['error', 'warning'].includes(message.type()) && faults.push(`${name}: ${message.type()}: ${message.text()}`));
    tab.on('pageerror', (error) => faults.push(`${name}: ${error.message}`));
    await tab.goto(address);
    return new Page(name, tab, context);
  }
  constructor(name, tab, context) {
    Object.assign(this, { name, tab, context });
  }
  async until(what, condition, argument) {
    try {
      await this.tab.waitForFunction(condition, argument, { timeout: kPatience_ms, polling: 50 });
    } catch (error) {
      const shown = await this.tab.evaluate(() => JSON.stringify([window.peerd?.objects(), window.peerd?.contacts()])).catch(() => 'nothing');
      throw new Error(`page ${this.name}: ${what}, waited in vain; it shows ${shown}\n${error.message}`);
    }
  }
  object(path) {
    return this.tab.evaluate((wanted) => window.peerd.objects().find((object) => object.path === wanted), path);
  }
  // Whether it goes by half a metre towards positive x within some seconds.
  async moves(path) {
    const { position_m } = await this.object(path);
    const goes = ([name, x]) => window.peerd.objects().find((object) => object.path === name).position_m[0] > x + 0.5;
    return this.tab.waitForFunction(goes, [path, position_m[0]], { timeout: kPatience_ms / 12, polling: 50 }).then(() => true, () => false);
  }
  async option(name, on) {
    await this.tab.locator('.menu summary').click();
    await this.tab.locator(`[data-option="${name}"]`).setChecked(on);
    await this.tab.keyboard.press('Escape');
  }
  panel(name) {
    return this.tab.locator(`[role=tab][data-panel="${name}"]`).click();
  }
  async viewpoint(description) {
    await this.tab.locator('.toolbar select').selectOption({ label: description });
    await this.tab.evaluate(() => new Promise((drawn) => setTimeout(drawn, 300)));
  }
  shot(path) {
    return this.tab.screenshot({ path });
  }
}

// The pixels of a page's picture at one instant. Places are of the world [m].
export class Pixels {
  static async of(page) {
    const png = (await page.tab.screenshot()).toString('base64');
    const store = await page.tab.evaluateHandle(async (data) => {
      const image = new Image();
      image.src = `data:image/png;base64,${data}`;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext('2d', { willReadFrequently: true });
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height);
    }, png);
    return new Pixels(page, store);
  }
  constructor(page, store) {
    Object.assign(this, { page, store });
  }
  at(place) {
    return this.store.evaluate(({ data, width }, at) => {
      const { x, y } = window.peerd.on_window(at);
      const begin = 4 * (Math.round(y) * width + Math.round(x));
      return [...data.slice(begin, begin + 3)];
    }, place);
  }
  // How many pixels of a square around a place have about that colour.
  countAround(place, reach, colour) {
    return this.store.evaluate(({ data, width }, [at, pixels, wanted]) => {
      const { x, y } = window.peerd.on_window(at);
      let count = 0;
      for (let row = Math.round(y) - pixels; row <= Math.round(y) + pixels; ++row) {
        for (let column = Math.round(x) - pixels; column <= Math.round(x) + pixels; ++column) {
          const begin = 4 * (row * width + column);
          if ([0, 1, 2].every((channel) => Math.abs(data[begin + channel] - wanted[channel]) < 60)) ++count;
        }
      }
      return count;
    }, [place, reach, colour]);
  }
  // How many pixels of the picture differ from those of another one.
  differing(other) {
    return this.store.evaluate(({ data, width, height }, then) => {
      const { left, top, right, bottom } = document.querySelector('.picture').getBoundingClientRect();
      const bar = document.querySelector('.toolbar').getBoundingClientRect();
      let count = 0;
      for (let y = Math.ceil(top); y < Math.min(height, bottom); ++y) {
        for (let x = Math.ceil(left); x < Math.min(width, right); ++x) {
          const at = 4 * (y * width + x);
          const off = [0, 1, 2].reduce((sum, channel) => sum + Math.abs(data[at + channel] - then.data[at + channel]), 0);
          if (off > 30 && y > bar.bottom + 20) ++count;
        }
      }
      return count;
    }, other.store);
  }
  isLike(a, b) {
    return a.every((value, channel) => Math.abs(value - b[channel]) <= 24);
  }
}

// What a test of pages is called with: `program` is peerd, `packages` the folder whose node_modules has playwright-core, `out`
// where screenshots go.
export function words() {
  const [program, packages, out] = process.argv.slice(2).map((path) => resolve(path));
  return { program, packages, out };
}

// Runs the steps of a test on real peers of a configuration, and ends the process: 0 good, 1 something is wrong, 77 skipped. The steps get
// a browser, the peers' addresses, and a list for what goes wrong on the pages that they open.
export async function testPages(configuration, names, steps) {
  const { program, packages, out } = words();
  const launch = findBrowser(packages);
  mkdirSync(out, { recursive: true });
  const port = await freePort();
  const peers = names.map((name) => new Peer(program, configuration, name, port));
  const faults = [];
  let browser = null;
  let failed = false;
  try {
    const addresses = await Promise.all(peers.map((peer) => peer.address));
    browser = await launch();
    await steps(browser, addresses, faults);
    check(faults.length === 0, `the consoles of the pages are not empty:\n${faults.join('\n')}`);
  } catch (error) {
    failed = true;
    console.log(error.stack);
    if (faults.length > 0) console.log(`on the consoles:\n${faults.join('\n')}`);
  }
  await browser?.close();
  for (const peer of peers) {
    await peer.leave().catch((error) => {
      failed = true;
      console.log(error.message);
    });
    if (failed) console.log(`--- peer ${peer.name}\n${peer.log.slice(-4000)}`);
  }
  process.exit(failed ? 1 : 0);
}
