import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';

import { PeerLink } from '../src/live/peer_link';

// A gateway that answers, until it hangs: then the connection stays open, and nothing comes.
class Gateway {
  static all: Gateway[] = [];
  static hangs = false;
  static token = 'first';
  binaryType = '';
  readyState = 0;
  bufferedAmount = 0;
  onopen: ((event: unknown) => void) | null = null;
  onmessage: ((event: { data: string }) => void) | null = null;
  onerror: ((event: unknown) => void) | null = null;
  onclose: ((event: { reason: string }) => void) | null = null;

  constructor() {
    Gateway.all.push(this);
    setTimeout(() => {
      this.readyState = 1;
      this.onopen?.({});
    }, 1);
  }
  send(text: string): void {
    const request = JSON.parse(text) as { do: string; seq: number; token?: string };
    const ok = request.do !== 'token' || request.token === Gateway.token;
    if (!Gateway.hangs) setTimeout(() => this.onmessage?.({ data: JSON.stringify({ ok, seq: request.seq, error: ok ? undefined : 'no', members: [], waits_for: [] }) }), 1);
  }
  close(): void {
    this.readyState = 3;
  }
  end(): void {
    this.onclose?.({ reason: '' });
  }
}

function opened(): { link: PeerLink; faults: string[] } {
  const faults: string[] = [];
  const link = new PeerLink(
    { live: 'ws://peer/', token: 'first' } as never,
    { onFrame: () => undefined, onEvent: () => undefined, onFault: (sentence) => faults.push(sentence), onOpen: () => Promise.resolve() },
  );
  link.open();
  return { link, faults };
}

describe('the link to the peer', () => {
  beforeEach(() => {
    vi.useFakeTimers();
    vi.stubGlobal('WebSocket', Gateway);
    vi.stubGlobal('document', { hidden: false });
    Object.assign(Gateway, { all: [], hangs: false, token: 'first' });
  });
  afterEach(() => {
    vi.useRealTimers();
    vi.unstubAllGlobals();
  });

  it('says after three seconds that nothing comes, and connects anew after ten', async () => {
    const { link } = opened();
    await vi.advanceTimersByTimeAsync(3000);
    expect(link.silent_s.value).toBe(0);
    Gateway.hangs = true;
    await vi.advanceTimersByTimeAsync(5000);
    expect(link.silent_s.value).toBeGreaterThanOrEqual(3);
    expect(Gateway.all).toHaveLength(1);
    await vi.advanceTimersByTimeAsync(8000);
    expect(Gateway.all.length).toBeGreaterThan(1);
    Gateway.hangs = false;
    await vi.advanceTimersByTimeAsync(15000);
    expect(link.silent_s.value).toBe(0);
    expect(link.state.value).toBe('open');
  });

  it('says that the peer was started again, where its token is another one then', async () => {
    const { link, faults } = opened();
    await vi.advanceTimersByTimeAsync(100);
    expect(link.mayEdit.value).toBe(true);
    Gateway.token = 'second';
    Gateway.all[0].end();
    await vi.advanceTimersByTimeAsync(3000);
    expect(link.mayEdit.value).toBe(false);
    expect(link.token.value).toBe('refused');
    expect(faults).toEqual(['the peer was started again, with another token: open the address that its log has now (peerd view says it)']);
  });
});
