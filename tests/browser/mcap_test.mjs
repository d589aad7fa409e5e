// node mcap_test.mjs PEERD PACKAGES: what `peerd export --mcap` writes, read by another implementation of the format.
//
// PACKAGES is the folder whose node_modules has @mcap/core and fzstd. Exit codes: 0 good, 1 something is wrong, 77 skipped.
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { createRequire } from 'node:module';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check } from './real_peers.mjs';

const [program, packages] = process.argv.slice(2).map((path) => resolve(path));
const kScenarios = join(dirname(fileURLToPath(import.meta.url)), '../../configs/scenarios');
if (!existsSync(join(packages, 'node_modules', '@mcap/core'))) {
  console.log(`skipped: no @mcap/core in ${packages}: the viewer was not built`);
  process.exit(77);
}
const need = createRequire(join(packages, 'package.json'));
const { McapIndexedReader, McapStreamReader } = need('@mcap/core');
const { decompress } = need('fzstd');
const decompressHandlers = { zstd: (bytes) => decompress(bytes) };

async function opened(file) {
  const bytes = readFileSync(file);
  const readable = { size: async () => BigInt(bytes.length), read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))) };
  return { bytes, reader: await McapIndexedReader.Initialize({ readable, decompressHandlers }) };
}

async function messagesOf(reader, options = {}) {
  const all = [];
  for await (const message of reader.readMessages(options)) {
    const channel = reader.channelsById.get(message.channelId);
    all.push({ topic: channel.topic, schema: reader.schemasById.get(channel.schemaId).name, time_s: Number(message.logTime) / 1e9, json: JSON.parse(new TextDecoder().decode(message.data)) });
  }
  return all;
}

// The same messages come by the index and from one end to the other, and the checksums of chunks are right.
function streamed(bytes) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(new Uint8Array(bytes));
  let count = 0;
  for (let record = reader.nextRecord(); record !== undefined; record = reader.nextRecord()) if (record.type === 'Message') ++count;
  check(reader.done(), 'the file has something after its end');
  return count;
}

function places(messages, frame) {
  return messages.flatMap(({ json }) => json.transforms ?? []).filter((transform) => transform.child_frame_id === frame).map(({ translation, timestamp }) => ({ ...translation, time_s: timestamp.sec + timestamp.nsec / 1e9 }));
}

// The last place up to an instant.
function placeAt(places_, time_s) {
  return places_.filter((place) => place.time_s <= time_s + 1e-6).at(-1);
}

async function aRun(folder) {
  const run = join(folder, 'eq47');
  const options = ['--set', 'replication.approach="dr+rcp"', '--set', 'replication.order=1', '--set', 'network.latency_ms=200'];
  execFileSync(program, ['sim', join(kScenarios, 'eq47.toml'), '--samples', 'all', '--out', run, ...options], { stdio: 'ignore' });
  const file = join(folder, 'eq47.mcap');
  const said = JSON.parse(execFileSync(program, ['export', run, '--mcap', file, '--json']));
  const { bytes, reader } = await opened(file);
  check(bytes.length === said.bytes, `the file has ${bytes.length} bytes, and the program says ${said.bytes}`);
  const messages = await messagesOf(reader);
  check(messages.length === said.messages && Number(reader.statistics.messageCount) === said.messages, `${messages.length} messages, and the program says ${said.messages}`);
  check(streamed(bytes) === said.messages, 'a reader of the whole stream finds other messages than the index');
  check(messages.every((message, i) => i === 0 || message.time_s >= messages[i - 1].time_s), 'the messages are not in order of time');
  check((await messagesOf(reader, { topics: ['/c/tf'], startTime: 5_000_000_000n, endTime: 6_000_000_000n })).every(({ topic, time_s }) => topic === '/c/tf' && time_s >= 5 && time_s <= 6), 'the index leads elsewhere');

  const errors = messages.filter(({ topic }) => topic === '/c/errors');
  check(errors.length > 440 && errors.every(({ schema }) => schema === 'peerd.GhostErrors'), `${errors.length} errors in 15 s`);
  const truths = places(messages, 'truth/CAR');
  const ghosts = places(messages, 'c/ghost/CAR');
  check(truths.length > 400 && ghosts.length > 400, `${truths.length} truths, ${ghosts.length} ghosts`);
  let largest = 0;
  for (const { time_s, json } of errors) {
    const [truth, ghost] = [placeAt(truths, time_s), placeAt(ghosts, time_s)];
    const distance_m = Math.hypot(truth.x - ghost.x, truth.y - ghost.y, truth.z - ghost.z);
    check(Math.abs(distance_m - json.objects.CAR) < 1e-5, `at ${time_s} s truth and ghost are ${distance_m} m apart, and the error is ${json.objects.CAR} m`);
    largest = Math.max(largest, distance_m);
  }
  check(largest > 1, `the largest error is ${largest} m`);

  const scene = messages.find(({ topic, schema }) => topic === '/c/scene' && schema === 'foxglove.SceneUpdate').json;
  const car = scene.entities.find((entity) => entity.frame_id === 'c/CAR');
  check(car.frame_locked && car.triangles.length > 0 && car.triangles[0].indices.every((index) => index < car.triangles[0].points.length), 'the car has no triangles');
  check(messages.some(({ topic, json }) => topic === '/c/contacts' && json.event === 'contact' && json.collider === 'CAR'), 'the car hits nothing');
  check(messages.some(({ topic, json }) => topic === '/c/contacts/marks' && json.entities[0].arrows.length === 1), 'no contact is marked');
  console.log(`${bytes.length} bytes, ${messages.length} messages, the largest error ${largest.toFixed(3)} m`);
}

async function aCapture(folder) {
  const captures = join(folder, 'captures');
  execFileSync(program, ['sim', join(kScenarios, 'snooker.toml'), '--out', join(folder, 'snooker'), '--capture', captures], { stdio: 'ignore' });
  const file = join(folder, 'a.mcap');
  execFileSync(program, ['export', join(captures, 'a.pcapng'), '--mcap', file]);
  const messages = await messagesOf((await opened(file)).reader);
  check(messages.some(({ topic }) => topic === '/a/tf'), 'the capture has no poses');
  check(messages.some(({ topic, json }) => topic === '/a/contacts' && json.event === 'contact' && typeof json.decider === 'number'), 'no contact has a decider');
}

const folder = mkdtempSync(join(tmpdir(), 'peerd-mcap-'));
let failed = false;
try {
  await aRun(folder);
  await aCapture(folder);
} catch (error) {
  failed = true;
  console.log(error.stack);
}
rmSync(folder, { recursive: true, force: true });
process.exit(failed ? 1 : 0);
