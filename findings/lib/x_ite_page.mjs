// A page with X_ITE in Chromium, in the current folder, which has the packages x_ite and playwright-core.
//   const seen = await inX_ite(worldText, (scene) => ..)  // the function runs in the page
import { existsSync, readFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { createRequire } from 'node:module';

const require = createRequire(`${process.cwd()}/`);
const { chromium } = require('playwright-core');
const kDist = 'node_modules/x_ite/dist';
const kPage = '<x3d-canvas></x3d-canvas><script type="module">import X3D from "/x_ite.mjs"; window.X3D = X3D;</script>';
const kTypes = { mjs: 'text/javascript', js: 'text/javascript', css: 'text/css' };

function serve(request, reply) {
  const path = new URL(request.url, 'http://page').pathname;
  const file = `${kDist}${path}`;
  if (path === '/') reply.setHeader('content-type', 'text/html').end(kPage);
  else if (!path.includes('..') && existsSync(file)) reply.setHeader('content-type', kTypes[path.split('.').pop()] ?? 'application/octet-stream').end(readFileSync(file));
  else reply.writeHead(404).end();
}

export async function inX_ite(world, ask) {
  const server = createServer(serve).listen(0, '127.0.0.1');
  const browser = await chromium.launch({ executablePath: process.env.CHROMIUM, args: ['--no-sandbox', '--enable-unsafe-swiftshader'] });
  try {
    const page = await browser.newPage();
    await page.goto(`http://127.0.0.1:${server.address().port}/`);
    await page.waitForFunction('window.X3D !== undefined', null, { timeout: 60000 });
    return await page.evaluate(
      async ([text, source]) => {
        const browser = X3D.getBrowser();
        const scene = await browser.createX3DFromString(text);
        await browser.replaceWorld(scene);
        return (0, eval)(`(${source})`)(scene);
      },
      [world, String(ask)],
    );
  } finally {
    await browser.close();
    server.close();
  }
}
