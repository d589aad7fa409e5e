import { Connection, type DaemonEvent, edit, type GatewayAddress, type LinkState, type Outcome, type PeersReply, type PoseFrame, type Reply, type Status } from 'peerd';

import { Setting } from '../page/setting';

// The page's peer: the connection to it, whether the page may change its world, and what it says of itself every second.
const kPoll_ms = 1000;
const kWatch_ms = 500;
const kSilent_s = 3; // then the page says that nothing comes
const kLost_s = 10; // then it connects anew

export interface PeerListener {
  onFrame(frame: PoseFrame): void;
  onEvent(event: DaemonEvent): void;
  onFault(sentence: string): void;
  onOpen(): Promise<void>; // asks for what it needs; called at each new connection
}

export class PeerLink {
  readonly state = new Setting<LinkState>('connecting');
  readonly mayEdit = new Setting<boolean>(false);
  readonly status = new Setting<Status | null>(null);
  readonly peers = new Setting<PeersReply | null>(null);
  readonly silent_s = new Setting<number>(0); // how long a question has waited while nothing came, from kSilent_s on
  readonly token = new Setting<'none' | 'accepted' | 'refused'>('none');
  readonly connection: Connection;
  private askedAt_s: number | null = null; // a question of poll() waits since then
  private heardAt_s = 0;
  private heard_bytes = 0;
  private recorded: { id: number; names: ReadonlyMap<number, string> } | null = null;

  constructor(private readonly address: GatewayAddress, private readonly listener: PeerListener) {
    this.connection = new Connection(address.live, {
      onState: (state) => this.onState(state),
      onFrame: (frame) => listener.onFrame(frame),
      onEvent: (event) => listener.onEvent(event),
      onFault: (sentence) => listener.onFault(sentence),
    }, { reopens: true });
  }

  open(): void {
    this.connection.open();
    setInterval(() => void this.poll(), kPoll_ms);
    setInterval(() => this.watch(performance.now() / 1000), kWatch_ms);
  }

  // The page shows a recording, of that peer's view: there is nobody to connect to.
  showRecorded(id: number, name: string, peers: readonly { readonly id: number; readonly name: string }[]): void {
    this.recorded = { id, names: new Map([...peers.map((peer) => [peer.id, peer.name] as const), [id, name]]) };
  }

  ask(request: Record<string, unknown>): Promise<Reply> {
    if (this.recorded !== null) return Promise.resolve({ ok: false, error: 'this is a recording: there is no peer that could do that' });
    return this.connection.ask(request);
  }

  edit(request: Record<string, unknown>): Promise<Outcome> {
    return edit((r) => this.ask(r), request);
  }

  get ownId(): number {
    return this.recorded?.id ?? this.status.value?.peer.id ?? 0;
  }

  nameOf(peer: number | null | undefined): string {
    if (peer === null || peer === undefined || peer === 0) return 'nobody';
    const status = this.status.value;
    if (this.recorded !== null) return this.recorded.names.get(peer) ?? `peer ${peer}`;
    if (status?.peer.id === peer) return status.peer.name;
    return status?.members.find((member) => member.id === peer)?.name ?? this.peers.value?.peers.find((row) => row.id === peer)?.name ?? `peer ${peer}`;
  }

  // A peer that hangs, or a tunnel that has lost its way, leaves the connection open and sends nothing.
  watch(now_s: number): void {
    if (this.connection.bytesIn !== this.heard_bytes) this.heardAt_s = now_s;
    this.heard_bytes = this.connection.bytesIn;
    const waits = this.state.value === 'open' && this.askedAt_s !== null;
    const silent_s = waits ? now_s - Math.max(this.askedAt_s ?? now_s, this.heardAt_s) : 0;
    this.silent_s.value = silent_s >= kSilent_s ? Math.floor(silent_s) : 0;
    if (silent_s >= kLost_s) this.connection.reopen(`the peer has not answered for ${kLost_s} s`);
  }

  private onState(state: LinkState): void {
    this.state.value = state;
    this.askedAt_s = null;
    this.silent_s.value = 0;
    if (state === 'open') void this.begin();
  }

  private async begin(): Promise<void> {
    const { token } = this.address;
    this.mayEdit.value = token !== null && (await this.isAccepted(token));
    await this.poll();
    await this.listener.onOpen();
  }

  private async isAccepted(token: string): Promise<boolean> {
    const before = this.token.value;
    const reply = await this.ask({ do: 'token', token });
    if (!reply.ok && this.state.value !== 'open') return false; // it was not asked
    this.token.value = reply.ok ? 'accepted' : 'refused';
    if (!reply.ok && before === 'accepted') this.listener.onFault('the peer was started again, with another token: open the address that its log has now (peerd view says it)');
    else if (!reply.ok && before === 'none') this.listener.onFault(`the token is not accepted: ${reply.error ?? ''}`);
    return reply.ok;
  }

  private async poll(): Promise<void> {
    if (this.state.value !== 'open' || document.hidden || this.askedAt_s !== null) return;
    this.askedAt_s = performance.now() / 1000;
    const status = await this.ask({ do: 'status' });
    this.askedAt_s = null;
    if (status.ok) this.status.value = status as unknown as Status;
    else if (this.state.value === 'open') this.listener.onFault(`status: ${status.error ?? ''}`);
    const peers = await this.ask({ do: 'peers' });
    if (peers.ok) this.peers.value = peers as unknown as PeersReply;
  }
}
