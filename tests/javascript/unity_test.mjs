// node unity_test.mjs PEERD: examples/unity without Unity: the client compiles by mcs without a warning, sees a real peer's objects by Mono, and
// lifts one of them; what the peer refuses is said in its words. Exit codes: 0 good, 1 something is wrong, 77 skipped, because there is no Mono.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { onPeers, skipWithout } from './example_peers.mjs';

const program = resolve(process.argv[2]);
const unity = resolve(dirname(fileURLToPath(import.meta.url)), '../../examples/unity');
skipWithout('mcs');
skipWithout('mono');

await onPeers(program, async ([address], folder) => {
  const console_ = join(folder, 'peerd_console.exe');
  const libraries = ['System.Net.Http', 'System.Runtime.Serialization', 'System.Xml.Linq'].map((name) => `-r:${name}`);
  execFileSync('mcs', ['-warnaserror', `-out:${console_}`, ...libraries, join(unity, 'PeerdClient.cs'), join(unity, 'PeerdConsole.cs')], { stdio: 'inherit' });
  const run = (...words) => spawnSync('mono', [console_, ...words], { encoding: 'utf8', timeout: 60000 });

  const lifted = run(address, 'STONE');
  assert.equal(lifted.status, 0, lifted.stdout + lifted.stderr);
  assert.match(lifted.stdout, /^PUCK -4.00 0.00 0.00 of peer 1$/m);
  assert.match(lifted.stdout, /^STONE 4.00 0.00 0.00 of peer 2$[^]*^owner STONE$[^]*^STONE 4.00 (1.0\d|0.9\d) 0.00 of peer 1$/m);
  for (const [words, sentence] of [[[`${address}x`], /this is not the token/], [[address, 'NOTHING'], /^grab: .*NOTHING/], [[address.split('#')[0], 'PUCK'], /needs the token/]]) {
    const refused = run(...words);
    assert.equal(refused.status, 1);
    assert.match(refused.stderr, sentence);
  }
});
