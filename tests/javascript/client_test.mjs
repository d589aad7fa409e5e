// node client_test.mjs PEERD PACKAGE PACKAGES ws|own: the JavaScript package on two real peers.
//
// PEERD is the program, PACKAGE the built package, PACKAGES a folder whose node_modules has ws. `ws` takes the WebSocket of that, `own`
// Node's own. Each step waits until what it asks for is so, for kPatience_ms at most. Exit codes: 0 good, 1 something is wrong, 77 skipped.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { freePort, kPatience_ms, Peer as Program } from '../browser/real_peers.mjs';

const [program, folder, packages, which] = process.argv.slice(2);
const kFlag = '--experimental-websocket'; // of Node 20 and 21
if (which === 'own' && globalThis.WebSocket === undefined) {
  if (!process.allowedNodeEnvironmentFlags.has(kFlag) || process.execArgv.includes(kFlag)) {
    console.log(`skipped: node ${process.version} has no WebSocket of its own`);
    process.exit(77);
  }
  const { status } = spawnSync(process.execPath, [kFlag, ...process.argv.slice(1)], { stdio: 'inherit' });
  process.exit(status ?? 1);
}
const { Peer, PeerdError } = await import(pathToFileURL(resolve(folder, 'index.js')));
const kOptions = which === 'ws' ? { WebSocket: createRequire(join(resolve(packages), 'package.json'))('ws').WebSocket } : {};

const connect = (address, options = {}) => Peer.connect(address, { ...kOptions, ...options });
const sleep = (ms) => new Promise((over) => setTimeout(over, ms));
const refusal = (request, words) => ({ name: 'PeerdError', request, answered: true, message: words });
const lost = (words) => ({ name: 'PeerdError', answered: false, message: words });

async function until(what, holds) {
  for (const begin = Date.now(); !(await holds()); await sleep(20)) assert.ok(Date.now() < begin + kPatience_ms, `waited in vain: ${what}`);
}

// The first of a stream that is wanted; the stream ends by that.
async function first(stream, wanted) {
  const late = setTimeout(() => stream.end(new Error('an event was waited for in vain')), kPatience_ms);
  try {
    for await (const event of stream) {
      if (wanted(event)) return event;
    }
  } finally {
    clearTimeout(late);
  }
  throw new Error('the stream has ended before what was waited for');
}

async function connecting(address) {
  const { origin } = new URL(address);
  await assert.rejects(connect(`${origin}/#token=wrong`), refusal('token', /this is not the token/));
  await assert.rejects(connect(`http://127.0.0.1:${await freePort()}/`), lost(/has ended/));
  await assert.rejects(connect('a.sock'), TypeError);
  const onlooker = await connect(origin);
  assert.equal(onlooker.name, 'a');
  assert.equal((await onlooker.status()).peer.id, 1);
  await assert.rejects(onlooker.remove('PUCK'), refusal('remove', /token/));
  onlooker.close();
  assert.equal(await onlooker.ended, null);
  await assert.rejects(onlooker.status(), lost(/no connection/));
}

// A program at a takes the puck and drives it into the stone of b; both hear of the same contact.
async function meeting(a, b) {
  await until('each peer has the other', async () => (await a.status()).members[0]?.joined && (await b.status()).members[0]?.joined);
  await until('motions have begun', async () => (await a.status()).since_start_s > 0);
  assert.deepEqual((await b.objects()).map(({ path, owner }) => [path, owner]), [['PUCK', 1], ['STONE', 2], ['WHEEL', 2]]);

  const contacts = await Promise.all([a, b].map((peer) => peer.subscribe('contacts')));
  const watch = await b.watch({ hz: 60 });
  assert.deepEqual(watch.paths(), ['PUCK', 'STONE', 'WHEEL']);
  assert.deepEqual(watch.newestPose('PUCK').position_m, [-4, 0, 0]);
  assert.equal(watch.newestPose('NOTHING'), null);

  await assert.rejects(a.pose({ object: 'STONE', position_m: [0, 0, 0] }), refusal('pose', /^pose STONE: /));
  await a.grab('PUCK');
  const met = Promise.all(contacts.map((stream) => first(stream, ({ event, kind }) => event === 'contact' && kind !== 'predicted')));
  let ends = false;
  void met.finally(() => (ends = true)).catch(() => undefined);
  for (const begin = Date.now(); !ends; await sleep(15)) {
    const now = Date.now();
    await a.pose({ object: 'PUCK', position_m: [Math.min(-4 + 0.004 * (now - begin), 4), 0, 0], velocity_m_s: [4, 0, 0], time_s: now / 1000 });
  }
  const [at_a, at_b] = await met;
  assert.deepEqual([at_a, at_b].map(({ collider, collidee }) => [collider, collidee].sort()), [['PUCK', 'STONE'], ['PUCK', 'STONE']]);
  assert.deepEqual([at_a.at_s, at_a.decider], [at_b.at_s, at_b.decider]);
  await a.letGo('PUCK');

  // Frames: the puck has come to b, by itself and between the frames.
  await until('b sees where the puck is', () => watch.newestPose('PUCK').position_m[0] > 2);
  assert.ok(watch.pose('PUCK').position_m[0] > -4);
  assert.deepEqual([watch.pose('PUCK').owner, watch.pose('PUCK').own, watch.pose('STONE').own], [1, false, true]);
  let frames = 0;
  for await (const { sessionTime_s, changed } of watch) {
    assert.ok(sessionTime_s > at_a.at_s - 60);
    if (changed.has('WHEEL') && ++frames === 3) break;
  }
}

async function editing(a, b) {
  const [edits, data, messages] = [await b.subscribe('edits'), await b.subscribe('data'), await b.subscribe('messages')];
  const watch = await b.watch();
  const operation = await a.add('DEF BOX Transform { translation 0 3 0 children Shape { geometry Box { } } }');
  await first(edits, (event) => event.event === 'edit' && event.operation.author === operation.author && event.operation.number === operation.number);
  await a.grab('BOX');
  await until('b has the box', () => watch.newestPose('BOX') !== null);
  assert.deepEqual(watch.newestPose('BOX').position_m, [0, 3, 0]);
  assert.ok(watch.newestPose('PUCK') !== null);

  await a.setData('BOX', 'colour', 'red');
  const { node, key, value } = await first(data, ({ event }) => event === 'data');
  assert.deepEqual([node, key, value], ['BOX', 'colour', 'red']);
  assert.equal(await b.data('BOX', 'colour'), 'red');
  assert.deepEqual(await b.dataKeys('BOX'), ['colour']);
  await assert.rejects(b.data('BOX', 'size'), refusal('data', /no such key/));

  await a.send('chat', 'hello');
  const { topic, text, peer } = await first(messages, ({ event }) => event === 'message');
  assert.deepEqual([topic, text, peer], ['chat', 'hello', 1]);

  await a.set('BOX', 'scale', '2 2 2');
  assert.match(await a.world(), /scale 2 2 2/);
  await a.undo();
  assert.doesNotMatch(await a.world(), /scale 2 2 2/);
  await a.lock('BOX');
  await until('b knows of the lock', async () => (await b.status()).locks.length === 1);
  await assert.rejects(b.own('BOX'), refusal('own', /./)); // what is grabbed is not given
  await a.unlock('BOX');
  await a.remove('BOX');
  await until('the box is gone', () => watch.newestPose('BOX') === null);
  assert.deepEqual(await a.conflicts(), []);
  const hit = await a.pick([0, 5, -30], [0, 0, 1]);
  assert.equal(hit.path, 'WHEEL');
}

async function refusals(a) {
  await assert.rejects(a.ask({ do: 'dance' }), refusal('dance', /"do" must be one of/));
  await assert.rejects(a.remove('NOTHING'), refusal('remove', /NOTHING/));
  await assert.rejects(a.watch({ hz: 1e9 }), refusal('watch', /hz/));
  await assert.rejects(a.letGo('STONE'), refusal('let_go', /./));
  await assert.rejects(a.add('this is no VRML'), refusal('add', /./));
  assert.equal((await a.status()).peer.id, 1, 'the connection goes on');
}

// What is closed ends, and what else there is goes on.
async function streams(a) {
  const [all, messages] = [await a.subscribe(), await a.subscribe('messages')];
  all.close();
  assert.deepEqual(await all.next(), { done: true, value: undefined });
  await a.send('chat', 'still there?');
  assert.equal((await first(messages, ({ event }) => event === 'message')).text, 'still there?');
  const watch = await a.watch();
  const another = await a.watch({ kinds: ['truth', 'ghost'] });
  assert.deepEqual(another.paths('truth'), ['PUCK']);
  for await (const instant of watch) assert.fail(`a frame of a watch that has ended: ${instant.sessionTime_s}`);
}

async function gone(b, leaving) {
  const [stream, watch] = [await b.subscribe(), await b.watch()];
  const events = assert.rejects(async () => {
    for await (const event of stream) assert.ok(event.event);
  }, lost(/has ended/));
  const frames = assert.rejects(async () => {
    for await (const instant of watch) assert.ok(instant.changed);
  }, lost(/has ended/));
  await leaving();
  await Promise.all([events, frames]);
  assert.match(await b.ended, /the connection to the peer at http:.* has ended/);
  await assert.rejects(b.grab('STONE'), lost(/^grab STONE: there is no connection to the peer$/));
}

process.env.XDG_CONFIG_HOME = mkdtempSync(join(tmpdir(), 'peerd-javascript-')); // keys of this test's own
const configuration = join(dirname(fileURLToPath(import.meta.url)), 'meet.toml');
const port = await freePort();
const programs = ['a', 'b'].map((name) => new Program(program, configuration, name, port));
let failed = false;
try {
  const addresses = await Promise.all(programs.map(({ address }) => address));
  await connecting(addresses[0]);
  const [a, b] = await Promise.all(addresses.map((address) => connect(address)));
  assert.deepEqual([a.id, a.name, b.id, b.name], [1, 'a', 2, 'b']);
  for (const [step, ...peers] of [[meeting, a, b], [editing, a, b], [refusals, a], [streams, a]]) {
    await step(...peers);
    console.log(`${step.name}: good`);
  }
  await gone(b, () => programs[1].leave());
  await a.leave();
  assert.equal(await programs[0].ended, 0);
  assert.match(await a.ended, /has ended/);
  assert.ok(new PeerdError('') instanceof Error);
} catch (error) {
  failed = true;
  console.log(error);
}
for (const peer of programs) {
  if (peer.process.exitCode === null) await peer.leave().catch((error) => (failed = true, console.log(error.message)));
  if (failed) console.log(`--- peer ${peer.name}\n${peer.log.slice(-3000)}`);
}
rmSync(process.env.XDG_CONFIG_HOME, { recursive: true });
process.exit(failed ? 1 : 0);
