import type { Ask, SurroundingsReply } from 'peerd';

// What the peer says of its interest and its adaptive thresholds (docs/reference/gateway.md). It is asked for only while something
// shows it.
const kPeriod_ms = 250;

// Asks again and again while it is wanted, one request at a time.
export class SurroundingsWatch {
  newest: SurroundingsReply | null = null;
  private asking = false;

  constructor(private readonly ask: Ask, private readonly wanted: () => boolean, private readonly onReply: () => void, private readonly onFault: (sentence: string) => void) {
    setInterval(() => void this.poll(), kPeriod_ms);
  }

  async poll(): Promise<void> {
    if (this.asking || !this.wanted() || document.hidden) return;
    this.asking = true;
    const reply = await this.ask({ do: 'surroundings' });
    this.asking = false;
    if (!reply.ok) {
      if (this.newest !== null) this.onFault(`surroundings: ${reply.error ?? ''}`);
      this.newest = null;
    } else {
      this.newest = reply as unknown as SurroundingsReply;
    }
    this.onReply();
  }
}
