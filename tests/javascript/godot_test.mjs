// node godot_test.mjs PEERD PACKAGES: examples/godot/pose_frame.gd reads a real peer's frame and scene, by Godot 3 without a window. Exit codes: 0
// good, 1 something is wrong, 77 skipped, because there is no godot3-server.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { writeFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { onPeers, skipWithout } from './example_peers.mjs';

const [program, packages] = process.argv.slice(2).map((path) => resolve(path));
const { WebSocket } = createRequire(join(packages, 'package.json'))('ws');
const here = dirname(fileURLToPath(import.meta.url));
skipWithout('godot3-server');

await onPeers(program, async ([address], folder) => {
  const socket = new WebSocket(`${address.replace('http', 'ws').split('#')[0]}api/v1/live`);
  await new Promise((opened, failed) => socket.on('open', opened).on('error', failed));
  socket.send('{"do":"watch","hz":60}');
  const frame = await new Promise((got) => socket.on('message', (data, isBinary) => isBinary && got(data)));
  socket.close();
  writeFileSync(join(folder, 'frame'), frame);
  writeFileSync(join(folder, 'scene'), new Uint8Array(await (await fetch(`${address.split('#')[0]}api/v1/scene.glb`)).arrayBuffer()));
  const words = ['-s', join(here, 'read_frame.gd'), join(folder, 'frame'), join(folder, 'scene'), resolve(here, '../../examples/godot/pose_frame.gd')];
  const { stdout, stderr } = spawnSync('godot3-server', words, { cwd: folder, encoding: 'utf8', timeout: 60000 });
  const line = stdout.match(/^read: (.*)$/m);
  assert.ok(line, `${stdout}${stderr}`);
  const read = JSON.parse(line[1]);
  assert.deepEqual(Object.keys(read.places).sort(), ['PUCK', 'STONE', 'WHEEL']);
  assert.deepEqual(read.places.PUCK.position, [-4, 0, 0]);
  assert.deepEqual(read.places.PUCK.orientation, [0, 0, 0, 1]);
  assert.deepEqual([read.places.PUCK.owner, read.places.PUCK.own, read.places.STONE.own], [1, true, false]);
  assert.ok(read.same);
  assert.match(read.cut.error, /a pose frame of 100 bytes cannot have 3 rows of 56/);
  console.log(`Godot has read ${frame.length} bytes of a frame`);
});
