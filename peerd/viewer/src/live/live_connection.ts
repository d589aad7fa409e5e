import { readPoseFrame, type PoseFrame } from './pose_frame';

// The WebSocket to the daemon: requests with their replies, events, and pose frames. It comes back by itself when the
// connection ends, and says so.
export type Reply = { ok: boolean; error?: string; [member: string]: unknown };
export type DaemonEvent = { event: string; [member: string]: unknown };
export type LinkState = 'connecting' | 'open' | 'closed';

export interface LiveListener {
  onState(state: LinkState): void;
  onFrame(frame: PoseFrame): void;
  onEvent(event: DaemonEvent): void;
  onFault(sentence: string): void; // what the daemon sent and the page cannot read
}

const kFirstRetry_ms = 500;
const kLongestRetry_ms = 8000;

export class LiveConnection {
  private socket: WebSocket | null = null;
  private readonly waiting = new Map<number, (reply: Reply) => void>();
  private nextSeq = 1;
  private retry_ms = kFirstRetry_ms;
  bytesIn = 0;
  framesIn = 0;

  constructor(private readonly address: string, private readonly listener: LiveListener) {}

  open(): void {
    this.listener.onState('connecting');
    const socket = new WebSocket(this.address);
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.retry_ms = kFirstRetry_ms;
      this.listener.onState('open');
    };
    socket.onmessage = (message: MessageEvent<ArrayBuffer | string>) => this.onMessage(message.data);
    socket.onclose = () => this.onClose();
    this.socket = socket;
  }

  // The reply to a request; where the connection ends before it comes, a reply that says so.
  ask(request: Record<string, unknown>): Promise<Reply> {
    return new Promise((resolve) => {
      if (this.socket?.readyState !== WebSocket.OPEN) {
        resolve({ ok: false, error: 'there is no connection to the peer' });
        return;
      }
      const seq = this.nextSeq++;
      this.waiting.set(seq, resolve);
      this.socket.send(JSON.stringify({ ...request, seq }));
    });
  }

  // Poses of the hand: the newest is what counts, so nothing is sent while earlier ones still wait in the browser.
  get congested(): boolean {
    return (this.socket?.bufferedAmount ?? 0) > 4096;
  }

  private onMessage(data: ArrayBuffer | string): void {
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
      this.listener.onEvent(message as DaemonEvent);
      return;
    }
    const seq = message['seq'];
    const resolve = typeof seq === 'number' ? this.waiting.get(seq) : undefined;
    if (resolve === undefined || typeof seq !== 'number') {
      this.listener.onFault(typeof message['error'] === 'string' ? message['error'] : `a reply to no request: ${text.slice(0, 80)}`);
      return;
    }
    this.waiting.delete(seq);
    resolve(message as Reply);
  }

  private onClose(): void {
    this.socket = null;
    for (const resolve of this.waiting.values()) resolve({ ok: false, error: 'the connection to the peer has ended' });
    this.waiting.clear();
    this.listener.onState('closed');
    setTimeout(() => this.open(), this.retry_ms);
    this.retry_ms = Math.min(2 * this.retry_ms, kLongestRetry_ms);
  }
}
