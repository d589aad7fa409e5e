import type { LookRecord } from 'peerd';

// The newest record of each form and look of one scene, and which of them the picture does not show yet.
export class LookBook {
  private readonly newest = new Map<string, LookRecord>();
  private readonly changed = new Set<LookRecord>();

  take(records: readonly LookRecord[]): void {
    for (const record of records) {
      const key = `${record.kind} ${record.number}`;
      const before = this.newest.get(key);
      if (before !== undefined) this.changed.delete(before);
      this.newest.set(key, record);
      this.changed.add(record);
    }
  }

  clear(): void {
    this.newest.clear();
    this.changed.clear();
  }

  // Another picture has been made of the same scene: it shows none of them yet.
  renew(): void {
    for (const record of this.newest.values()) this.changed.add(record);
  }

  all(): readonly LookRecord[] {
    return [...this.newest.values()];
  }

  // Those that have come since the last call.
  drain(): readonly LookRecord[] {
    const out = [...this.changed];
    this.changed.clear();
    return out;
  }
}
