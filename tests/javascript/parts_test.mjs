// node parts_test.mjs PACKAGE: the parts of the JavaScript package that need no peer.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

const { EventStream, gatewayAddress, sceneNodes, kKindOfEvent } = await import(pathToFileURL(resolve(process.argv[2], 'index.js')));

test('an address has the page, the WebSocket and the token', () => {
  assert.deepEqual(gatewayAddress('http://127.0.0.1:80/#token=a-_b'), { page: 'http://127.0.0.1/', live: 'ws://127.0.0.1/api/v1/live', token: 'a-_b' });
  assert.deepEqual(gatewayAddress('http://[::1]:81'), { page: 'http://[::1]:81/', live: 'ws://[::1]:81/api/v1/live', token: null });
  assert.equal(gatewayAddress('https://a.example/peer/').live, 'wss://a.example/peer/api/v1/live');
  for (const wrong of ['', 'a.sock', 'ws://127.0.0.1/', 'file:///a']) assert.throws(() => gatewayAddress(wrong), TypeError, wrong);
});

test('a stream gives events in their order, whether they wait or are waited for', async () => {
  const stream = new EventStream(() => undefined);
  stream.give(1);
  stream.give(2);
  const read = [stream.next(), stream.next(), stream.next(), stream.next()];
  stream.give(3);
  stream.give(4);
  assert.deepEqual((await Promise.all(read)).map(({ value }) => value), [1, 2, 3, 4]);
});

test('leaving the loop closes a stream, once', async () => {
  let closed = 0;
  const stream = new EventStream(() => ++closed);
  stream.give(1);
  for await (const event of stream) {
    assert.equal(event, 1);
    break;
  }
  stream.give(2);
  stream.close();
  assert.equal(closed, 1);
  assert.deepEqual(await stream.next(), { done: true, value: undefined });
});

test('an error comes after what came before it, and once', async () => {
  const stream = new EventStream(() => undefined);
  stream.give(1);
  stream.end(new Error('over'));
  assert.equal((await stream.next()).value, 1);
  await assert.rejects(stream.next(), /over/);
  assert.equal((await stream.next()).done, true);
  const waited = new EventStream(() => undefined);
  const readers = [waited.next(), waited.next()];
  waited.end(new Error('over'));
  for (const reader of readers) await assert.rejects(reader, /over/);
});

test('a stream that nobody reads ends with an error', async () => {
  let closed = 0;
  const stream = new EventStream(() => ++closed);
  for (let i = 0; i < 65536; ++i) stream.give(i);
  assert.equal(closed, 1);
  let read = 0;
  await assert.rejects(async () => {
    for await (const event of stream) assert.equal(event, read++);
  }, { name: 'PeerdError', message: /65536 events wait/ });
  assert.equal(read, 65536);
});

function glb(json, type = 0x4e4f534a) {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const file = new ArrayBuffer(20 + text.length);
  const view = new DataView(file);
  [0x46546c67, 2, file.byteLength, text.length, type].forEach((value, i) => view.setUint32(4 * i, value, true));
  new Uint8Array(file, 20).set(text);
  return file;
}

test('the nodes of a scene are those that have an id', () => {
  const nodes = [{ name: 'root' }, { extras: { id: '0:1', path: 'CAR' } }, { extras: { static: true } }, { extras: { id: '0:4', path: 'CAR/WHEEL' } }];
  const read = sceneNodes(glb({ asset: { extras: { revision: 7 } }, nodes }));
  assert.deepEqual([read.revision, read.nodeCount], [7, 4]);
  assert.deepEqual(read.nodes, [{ index: 1, path: 'CAR' }, { index: 3, path: 'CAR/WHEEL' }]);
  assert.equal(read.byPath.get('CAR/WHEEL').index, 3);
  for (const wrong of [new ArrayBuffer(0), new ArrayBuffer(64), glb({}, 1), glb({ nodes }).slice(0, 30)]) assert.throws(() => sceneNodes(wrong), /the scene is/);
});

test('each event has a kind, or is everybody’s', () => {
  assert.equal(kKindOfEvent.contact, 'contacts');
  assert.equal(kKindOfEvent.dropped, null);
});
