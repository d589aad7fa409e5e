import { gatewayAddress, type GatewayAddress } from './address.js';
import { Connection, type WebSocketClass } from './connection.js';
import { edit, refusalIn } from './edits.js';
import { PeerdError } from './errors.js';
import { EventStream } from './event_stream.js';
import {
  kKindOfEvent,
  type Conflict,
  type DaemonEvent,
  type EditName,
  type EventKind,
  type EventOfKind,
  type Hit,
  type Near,
  type Numbers3,
  type ObjectRow,
  type OperationId,
  type PeersReply,
  type PoseKindName,
  type PoseOut,
  type ReplyTo,
  type Request,
  type RequestName,
  type Requests,
  type Status,
} from './messages.js';
import { sceneNodes } from './scene_nodes.js';
import { Watch } from './watch.js';

export interface PeerOptions {
  /** In place of that in the address's fragment. Without a token this program may look, and change nothing. */
  readonly token?: string;
  /** In place of the platform's, which Node before 22 lacks: that of the package `ws`, for one. */
  readonly WebSocket?: WebSocketClass;
  /** How long the peer may take to accept the connection [ms]; 10,000 without it. */
  readonly patience_ms?: number;
}

export interface WatchOptions {
  /** Frames a second, 1 to 120; 20 without it. */
  readonly hz?: number;
  /**
   * `shown` is what a viewer draws, and the default; `truth` is there for own objects alone; `ghost`, what all others predict, for
   * what somebody owns.
   */
  readonly kinds?: readonly PoseKindName[];
  /** Only of what is there; without it of everything. */
  readonly near?: Near;
}

interface Subscription {
  readonly kinds: ReadonlySet<EventKind>;
  readonly stream: EventStream<DaemonEvent>;
}

const kHz = 20;
const kPatience_ms = 10000;
const kAll: readonly EventKind[] = ['objects', 'contacts', 'peers', 'data', 'messages', 'edits'];

/**
 * A running peer, by its gateway. What the peer refuses rejects with a {@link PeerdError} in the peer's own sentence, and what waits
 * when the connection ends rejects, too. Nothing connects again by itself: a peer that starts again has another token, and what
 * happened meanwhile would be missing unseen. {@link ended} says when that is.
 */
export class Peer {
  /** The peer's number in its session. */
  readonly id: number = 0;
  readonly name: string = '';
  /** Resolves when the connection has ended: null, where `close()` did it; else why, in a sentence. */
  readonly ended: Promise<string | null>;

  private readonly connection: Connection;
  private readonly subscriptions = new Set<Subscription>();
  private watching: Watch | null = null;
  private readonly opened: Promise<void>;
  private onOpened: () => void = () => undefined;
  private onEnded: (why: string | null) => void = () => undefined;
  private isOver = false;

  /**
   * Connects to the gateway at the address that the peer prints, `http://HOST:PORT/#token=TOKEN`, also `http://HOST:PORT/`.
   * Rejects where nobody answers there, and where the token is another one.
   */
  static async connect(address: string | URL, options: PeerOptions = {}): Promise<Peer> {
    const peer = new Peer(gatewayAddress(address), options);
    try {
      await peer.begin(options);
    } catch (error) {
      peer.close();
      throw error;
    }
    return peer;
  }

  private constructor(
    private readonly address: GatewayAddress,
    options: PeerOptions,
  ) {
    this.ended = new Promise((resolve) => (this.onEnded = resolve));
    this.opened = new Promise((resolve) => (this.onOpened = resolve));
    const listener = {
      onState: (state: string, why: string) => {
        if (state === 'open') this.onOpened();
        if (state === 'closed') this.end(`the connection to the peer at ${address.page} has ended${why === '' ? '' : `: ${why}`}`);
      },
      onFrame: (frame: Parameters<Watch['take']>[0]) => this.watching?.take(frame),
      onEvent: (event: DaemonEvent) => this.onEvent(event),
      onFault: (sentence: string) => this.end(`the connection to the peer at ${address.page} was given up: ${sentence}`),
    };
    this.connection = new Connection(address.live, listener, { reopens: false, ...(options.WebSocket ? { WebSocket: options.WebSocket } : {}) });
  }

  private async begin(options: PeerOptions): Promise<void> {
    const patience_ms = options.patience_ms ?? kPatience_ms;
    const late = setTimeout(() => this.end(`the peer at ${this.address.page} has not answered within ${patience_ms} ms`), patience_ms);
    this.connection.open();
    const why = await Promise.race([this.opened, this.ended]);
    clearTimeout(late);
    if (typeof why === 'string') throw new PeerdError(why, '', false);
    const token = options.token ?? this.address.token;
    if (token !== null) await this.ask({ do: 'token', token });
    Object.assign(this, (await this.status()).peer);
  }

  /** Ends the connection. Requests that wait are rejected, and loops over events and frames end. */
  close(): void {
    this.end(null);
  }

  /** The reply to any request of docs/reference/control-protocol.md and gateway.md. Rejects where `ok` is false. */
  async ask<Name extends RequestName>(request: Request<Name>): Promise<ReplyTo<Name>> {
    const reply = await this.connection.ask(request as Readonly<Record<string, unknown>>);
    if (!reply.ok) throw new PeerdError(`${request.do}: ${reply.error ?? ''}`, request.do, reply.unanswered === undefined);
    return reply as unknown as ReplyTo<Name>;
  }

  // ------------------------------------------------------------------------------------------------------------- questions

  status(): Promise<Status> {
    return this.ask({ do: 'status' });
  }
  /** The other peers, from that number on, at most 256. */
  peers(from = 0): Promise<PeersReply> {
    return this.ask({ do: 'peers', from });
  }
  /** All objects that have an owner. */
  async objects(): Promise<ObjectRow[]> {
    const all: ObjectRow[] = [];
    for (let from: number | null = 0; from !== null; ) {
      const piece: ReplyTo<'objects'> = await this.ask({ do: 'objects', from });
      all.push(...piece.objects);
      from = piece.next;
    }
    return all;
  }
  /** The scene as it is now, as VRML, at most 4 MiB. */
  async world(): Promise<string> {
    return (await this.done({ do: 'world' })).world as string;
  }
  /** Edits of the last 24 hours that are lost by others made at the same time. */
  async conflicts(): Promise<Conflict[]> {
    const all: Conflict[] = [];
    for (let from: number | null = 0; from !== null; ) {
      const piece: ReplyTo<'conflicts'> = await this.ask({ do: 'conflicts', from });
      all.push(...piece.conflicts);
      from = piece.next;
    }
    return all;
  }
  /** What a ray from a place of the world [m] hits first. */
  async pick(origin_m: Numbers3, direction: Numbers3): Promise<Hit | null> {
    return (await this.ask({ do: 'pick', origin_m, direction })).hit;
  }
  /** The scene as glTF binary. By HTTP; a page must be of an origin that the peer lets in. */
  async scene(): Promise<ArrayBuffer> {
    const reply = await fetch(new URL('api/v1/scene.glb', this.address.page));
    if (!reply.ok) throw new PeerdError(`the scene was not given: ${((await reply.json()) as { error?: string }).error ?? reply.status}`, 'scene');
    return reply.arrayBuffer();
  }

  // ----------------------------------------------------------------------------------------------------------------- edits
  // Each resolves when the edit is applied at the peer, and rejects where it is refused, or not applied after 10 s. Paths are
  // those of the scene as it is now; `text` and `value` are VRML.

  add(text: string, under?: string): Promise<OperationId> {
    return this.edit<'add'>({ do: 'add', text, ...(under === undefined ? {} : { under }) });
  }
  remove(path: string): Promise<OperationId> {
    return this.edit<'remove'>({ do: 'remove', path });
  }
  /** To another node, or to the top level. */
  move(path: string, under?: string): Promise<OperationId> {
    return this.edit<'move'>({ do: 'move', path, ...(under === undefined ? {} : { under }) });
  }
  set(path: string, field: string, value: string): Promise<OperationId> {
    return this.edit<'set'>({ do: 'set', path, field, value });
  }
  /** Makes the peer the owner: its physics runs the object. Another owner is asked, and may refuse. */
  own(path: string): Promise<OperationId> {
    return this.edit<'own'>({ do: 'own', path });
  }
  /** Makes the peer the owner, and poses move the object. */
  grab(path: string): Promise<OperationId> {
    return this.edit<'grab'>({ do: 'grab', path });
  }
  /** As `own`, without asking; refused unless the configuration has `replication.steal`. */
  steal(path: string): Promise<OperationId> {
    return this.edit<'steal'>({ do: 'steal', path });
  }
  /** The peer owns it no more. */
  release(path: string): Promise<OperationId> {
    return this.edit<'release'>({ do: 'release', path });
  }
  lock(path: string): Promise<OperationId> {
    return this.edit<'lock'>({ do: 'lock', path });
  }
  unlock(path: string): Promise<OperationId> {
    return this.edit<'unlock'>({ do: 'unlock', path });
  }
  undo(): Promise<OperationId> {
    return this.edit<'undo'>({ do: 'undo' });
  }
  redo(): Promise<OperationId> {
    return this.edit<'redo'>({ do: 'redo' });
  }
  setData(path: string, key: string, value: string): Promise<OperationId> {
    return this.edit<'data'>({ do: 'data', path, key, value });
  }
  removeData(path: string, key: string): Promise<OperationId> {
    return this.edit<'data'>({ do: 'data', path, key, remove: true });
  }
  /** Rejects where the node has no such key. */
  async data(path: string, key: string): Promise<string> {
    return (await this.done({ do: 'data', path, key })).value as string;
  }
  async dataKeys(path: string): Promise<readonly string[]> {
    return (await this.done({ do: 'data', path })).keys ?? [];
  }
  /** A message to all peers: those that have subscribed get it, once. */
  send(topic: string, text: string): Promise<OperationId> {
    return this.edit<'send'>({ do: 'send', topic, text });
  }

  // ---------------------------------------------------------------------------------------------------------------- motion

  /** Moves what is grabbed, or what the configuration leaves to a program. Rejects where one of them was refused; the others count. */
  async pose(poses: PoseOut | readonly PoseOut[]): Promise<void> {
    const reply = await this.ask<'pose'>({ do: 'pose', ...(isList(poses) ? { poses } : poses) });
    if (reply.refused.length > 0) throw new PeerdError(reply.refused.map(({ object, why }) => `pose ${object}: ${why}`).join('; '), 'pose');
  }
  /** Poses wait on this side of the connection: leave some out, the newest is what counts. */
  get congested(): boolean {
    return this.connection.congested;
  }
  /** Poses move it no more: it goes on with the velocity of the last ones, as a thrown thing does. */
  async letGo(path: string): Promise<void> {
    await this.done({ do: 'let_go', path });
  }
  /** A key for the world's KeySensors, by the browser's name of it. */
  async key(key: string, flags: Omit<Requests['key'][0] & { key: string }, 'key'> = {}): Promise<ReplyTo<'key'>> {
    return this.done<'key'>({ do: 'key', key, ...flags });
  }
  /** Where the peer looks from; without a place it is that of its configuration again. */
  async viewpoint(viewpoint: Requests['viewpoint'][0] = {}): Promise<void> {
    await this.done({ do: 'viewpoint', ...viewpoint });
  }
  /** Makes the peer leave its session and end. */
  async leave(): Promise<void> {
    await this.ask({ do: 'leave' });
  }

  // --------------------------------------------------------------------------------------------------------------- watching

  /** Events of these kinds, or of all kinds, from the instant on at which it resolves. Several streams do not disturb each other. */
  async subscribe<Kind extends EventKind = EventKind>(...kinds: Kind[]): Promise<EventStream<EventOfKind<Kind>>> {
    const wanted: readonly EventKind[] = kinds.length > 0 ? kinds : kAll;
    const stream = new EventStream<DaemonEvent>(() => this.drop(subscription));
    const subscription: Subscription = { kinds: new Set(wanted), stream };
    this.subscriptions.add(subscription);
    try {
      await this.subscribeToAll();
    } catch (error) {
      this.subscriptions.delete(subscription);
      throw error;
    }
    return stream as unknown as EventStream<EventOfKind<Kind>>;
  }

  /** The poses of all that can move, from the first frame on. There is one watch at a time: another one ends the one before. */
  async watch(options: WatchOptions = {}): Promise<Watch> {
    this.watching?.close();
    const hz = options.hz ?? kHz;
    const watch: Watch = new Watch(hz, async () => sceneNodes(await this.scene()), () => this.dropWatch(watch));
    this.watching = watch;
    try {
      await this.ask<'watch'>({ do: 'watch', ...options, hz });
      if (!(await watch.hasFrame())) throw new PeerdError('watch: it was closed before its first frame came', 'watch');
    } catch (error) {
      watch.close();
      throw error;
    }
    return watch;
  }

  private async edit<Name extends EditName>(request: Request<Name>): Promise<OperationId> {
    const outcome = await edit((asked) => this.connection.ask(asked), request as Readonly<Record<string, unknown>>);
    if (!outcome.done || outcome.operation === undefined) throw new PeerdError(outcome.sentence, request.do, outcome.unanswered === undefined);
    return outcome.operation;
  }

  /** A request that the peer can refuse in its reply. */
  private async done<Name extends RequestName>(request: Request<Name>): Promise<ReplyTo<Name>> {
    const reply = await this.ask<Name>(request);
    const refusal = refusalIn({ ...reply, ok: true });
    if (refusal !== null) throw new PeerdError(`${request.do}: ${refusal}`, request.do);
    return reply;
  }

  private subscribeToAll(): Promise<unknown> {
    const to = kAll.filter((kind) => [...this.subscriptions].some(({ kinds }) => kinds.has(kind)));
    return this.ask<'subscribe'>({ do: 'subscribe', to });
  }

  private drop(subscription: Subscription): void {
    if (!this.subscriptions.delete(subscription) || this.isOver) return;
    this.subscribeToAll().catch((error: Error) => this.failAll(error)); // else the others would miss events
  }

  private dropWatch(watch: Watch): void {
    if (this.watching !== watch) return;
    this.watching = null;
    if (!this.isOver) this.ask<'unwatch'>({ do: 'unwatch' }).catch((error: Error) => this.failAll(error));
  }

  private onEvent(event: DaemonEvent): void {
    const kind = (kKindOfEvent as Readonly<Record<string, EventKind | null>>)[event.event];
    if (kind === undefined) return; // of a newer peer
    for (const { kinds, stream } of this.subscriptions) {
      if (kind === null || kinds.has(kind)) stream.give(event);
    }
  }

  // null: this program has closed it.
  private end(why: string | null): void {
    if (this.isOver) return;
    this.isOver = true;
    this.connection.close();
    this.failAll(why === null ? null : new PeerdError(why, '', false));
    this.onEnded(why);
  }

  private failAll(error: Error | null): void {
    for (const { stream } of [...this.subscriptions]) stream.end(error);
    this.watching?.end(error);
  }
}

function isList(poses: PoseOut | readonly PoseOut[]): poses is readonly PoseOut[] {
  return Array.isArray(poses);
}
