// node follow_test.mjs PEERD PACKAGE PACKAGES: examples/javascript/follow.mjs drives what one real peer owns until it touches what another one owns.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { cpSync, mkdirSync, symlinkSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { onPeers } from './example_peers.mjs';

const [program, folder, packages] = process.argv.slice(2).map((path) => resolve(path));
const example = resolve(dirname(fileURLToPath(import.meta.url)), '../../examples/javascript/follow.mjs');

function run(place, ...words) {
  return new Promise((ended) => {
    const started = spawn(process.execPath, [join(place, 'follow.mjs'), ...words]);
    let out = '';
    for (const stream of [started.stdout, started.stderr]) stream.on('data', (text) => (out += text));
    started.on('exit', (code) => ended({ code, out }));
  });
}

await onPeers(program, async ([address], place) => {
  cpSync(example, join(place, 'follow.mjs'));
  mkdirSync(join(place, 'node_modules'));
  symlinkSync(folder, join(place, 'node_modules', 'peerd'));
  symlinkSync(join(packages, 'node_modules', 'ws'), join(place, 'node_modules', 'ws'));
  const { code, out } = await run(place, address, 'PUCK', 'STONE');
  assert.equal(code, 0, out);
  assert.match(out, /^PUCK touches STONE, peer 1 has decided it$/m);
  assert.match((await run(place, address, 'PUCK', 'NOTHING')).out, /nothing moves that is called NOTHING; there are PUCK, STONE, WHEEL/);
  assert.match((await run(place, address, 'WHEEL', 'STONE')).out, /PeerdError: grab WHEEL: /);
});
