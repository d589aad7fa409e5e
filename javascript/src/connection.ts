import type { DaemonEvent, Reply } from './messages.js';
import { readPoseFrame, type PoseFrame } from './pose_frame.js';

export type LinkState = 'connecting' | 'open' | 'closed';

/** What is used of a WebSocket: browsers' and Node's have it, and that of the package `ws`. */
export interface WebSocketLike {
  binaryType: string;
  readonly readyState: number;
  readonly bufferedAmount: number;
  onopen: ((event: any) => void) | null;
  onmessage: ((event: any) => void) | null;
  onerror: ((event: any) => void) | null;
  onclose: ((event: any) => void) | null;
  send(text: string): void;
  close(): void;
}
export type WebSocketClass = new (address: string) => WebSocketLike;

export interface ConnectionListener {
  /** `why` says of `closed` what is known. */
  onState(state: LinkState, why: string): void;
  onFrame(frame: PoseFrame): void;
  onEvent(event: DaemonEvent): void;
  /** What the peer has sent and cannot be read, or a refusal of no request. */
  onFault(sentence: string): void;
}

export interface ConnectionOptions {
  /** Opens it again where it has ended, after half a second at first and after 8 s at most. */
  readonly reopens: boolean;
  readonly WebSocket?: WebSocketClass;
}

const kOpen = 1; // WebSocket.OPEN
const kFirstRetry_ms = 500;
const kLongestRetry_ms = 8000;
const kCongested_bytes = 4096;

/**
 * The WebSocket to a peer's gateway: requests with their replies, events, and pose frames. A request is answered by its reply as
 * it comes, refusals included; `Peer` stands on this and rejects instead.
 */
export class Connection {
  private socket: WebSocketLike | null = null;
  private readonly waiting = new Map<number, (reply: Reply) => void>();
  private nextSeq = 1;
  private retry_ms = kFirstRetry_ms;
  private retry: ReturnType<typeof setTimeout> | undefined;
  private wanted = false; // until close()
  bytesIn = 0;
  framesIn = 0;

  constructor(
    private readonly address: string,
    private readonly listener: ConnectionListener,
    private readonly options: ConnectionOptions,
  ) {}

  /** Begins to connect; the listener is told of what comes of it. Throws where the platform has no WebSocket and none is given. */
  open(): void {
    const Socket = this.options.WebSocket ?? (globalThis as { WebSocket?: WebSocketClass }).WebSocket;
    if (Socket === undefined) throw new Error('this platform has no WebSocket: give one, such as that of the package ws, in the options');
    this.wanted = true;
    this.listener.onState('connecting', '');
    const socket = new Socket(this.address);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.retry_ms = kFirstRetry_ms;
      this.listener.onState('open', '');
    };
    socket.onmessage = (message: { data: ArrayBuffer | string }) => this.onMessage(message.data);
    socket.onerror = (error: { message?: string }) => this.onClose(socket, error.message ?? ''); // Node 20's own says no more than that
    socket.onclose = (end: { reason: string }) => this.onClose(socket, end.reason);
    this.socket = socket;
  }

  /** Ends the connection for good. Requests that wait are answered by that. */
  close(): void {
    this.wanted = false;
    clearTimeout(this.retry);
    this.socket?.close();
    this.failAll('the connection to the peer was closed by this program');
  }

  /** Opens it anew at once, as where it has ended: a peer that hangs, or a tunnel that has lost its way, may end nothing for minutes. */
  reopen(why: string): void {
    const { socket } = this;
    if (socket === null || !this.wanted) return;
    socket.onopen = socket.onmessage = socket.onerror = socket.onclose = null;
    socket.close();
    this.onClose(socket, why);
  }

  /** The reply to a request; where the connection ends before it comes, a reply that says so. */
  ask(request: Readonly<Record<string, unknown>>): Promise<Reply> {
    return new Promise((resolve) => {
      if (!this.wanted || this.socket?.readyState !== kOpen) {
        resolve(unanswered('there is no connection to the peer'));
        return;
      }
      const seq = this.nextSeq++;
      this.waiting.set(seq, resolve);
      this.socket.send(JSON.stringify({ ...request, seq }));
    });
  }

  /** Poses: the newest is what counts, so send none while earlier ones still wait on this side. */
  get congested(): boolean {
    return (this.socket?.bufferedAmount ?? 0) > kCongested_bytes;
  }

  private onMessage(data: ArrayBuffer | string): void {
    if (!this.wanted) return;
    if (typeof data === 'string') {
      this.bytesIn += data.length;
      this.onText(data);
      return;
    }
    this.bytesIn += data.byteLength;
    this.framesIn += 1;
    const frame = readPoseFrame(data);
    if (typeof frame === 'string') this.listener.onFault(frame);
    else this.listener.onFrame(frame);
  }

  private onText(text: string): void {
    let message: Record<string, unknown>;
    try {
      message = JSON.parse(text) as Record<string, unknown>;
    } catch {
      this.listener.onFault(`a message is not JSON: ${text.slice(0, 80)}`);
      return;
    }
    if (typeof message['event'] === 'string') {
      this.listener.onEvent(message as unknown as DaemonEvent);
      return;
    }
    const seq = message['seq'];
    const resolve = typeof seq === 'number' ? this.waiting.get(seq) : undefined;
    if (resolve === undefined || typeof seq !== 'number') {
      this.listener.onFault(typeof message['error'] === 'string' ? message['error'] : `a reply to no request: ${text.slice(0, 80)}`);
      return;
    }
    this.waiting.delete(seq);
    resolve(message as unknown as Reply);
  }

  private onClose(socket: WebSocketLike, why: string): void {
    if (this.socket !== socket) return;
    this.socket = null;
    this.failAll(`the connection to the peer has ended${why === '' ? '' : `: ${why}`}`);
    this.listener.onState('closed', why);
    if (!this.wanted || !this.options.reopens) return;
    this.retry = setTimeout(() => this.open(), this.retry_ms);
    this.retry_ms = Math.min(2 * this.retry_ms, kLongestRetry_ms);
  }

  private failAll(sentence: string): void {
    const waiting = [...this.waiting.values()];
    this.waiting.clear();
    for (const resolve of waiting) resolve(unanswered(sentence));
  }
}

function unanswered(error: string): Reply {
  return { ok: false, error, unanswered: true };
}
