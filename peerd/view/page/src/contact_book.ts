import type { ContactEvent, DaemonEvent } from 'peerd';

import type { KnownContact } from './scene/contact_marks';

// The contacts of the last minute, or of a recording, in order of time, and whether they still hold.
const kMost = 2000;
const kMostRecorded = 50000;

export class ContactBook {
  private contacts: KnownContact[] = [];
  private most = kMost;

  constructor(private readonly nameOf: (peer: number | null | undefined) => string) {}

  // What follows is recorded.
  clear(): void {
    this.contacts = [];
    this.most = kMostRecorded;
  }

  // Says how many contacts the event concerns.
  take(event: DaemonEvent): number {
    if (event.event === 'contact_overruled') return this.overrule(event);
    if (event.event === 'contacts_retracted') return this.retract(event);
    if (event.event !== 'contact') return 0;
    this.add(event as unknown as ContactEvent);
    return 1;
  }

  between(since_s: number, until_s: number): readonly KnownContact[] {
    return this.contacts.filter(({ event }) => event.at_s > since_s && event.at_s <= until_s);
  }

  // Those of a stretch of time that still hold, without predictions of what has then been found or decided.
  inForce(since_s: number, until_s: number): readonly KnownContact[] {
    const those = this.between(since_s, until_s).filter((contact) => !contact.retracted);
    return those.filter((contact) => contact.event.kind !== 'predicted' || !those.some((other) => fulfils(other.event, contact.event)));
  }

  all(): readonly KnownContact[] {
    return this.contacts;
  }

  private add(event: ContactEvent): void {
    const decided = event.decider !== undefined && event.decider !== null;
    let at = this.contacts.length; // most come in order
    while (at > 0 && this.contacts[at - 1].event.at_s > event.at_s) at -= 1;
    this.contacts.splice(at, 0, { event, decider: decided ? this.nameOf(event.decider) : '', retracted: false });
    if (this.contacts.length > this.most) this.contacts.splice(0, this.contacts.length - this.most);
  }

  private overrule(event: DaemonEvent): number {
    return this.retractThose(({ at_s, collider, collidee }) => at_s === event['at_s'] && collider === event['collider'] && collidee === event['collidee']);
  }

  private retract(event: DaemonEvent): number {
    const { object, partner } = event as { object?: unknown; partner?: unknown };
    return this.retractThose(({ at_s, collider, collidee, kind }) => {
      if (at_s <= Number(event['after_s']) || (event['predicted_only'] === true && kind !== 'predicted')) return false;
      const concerned = collider === object || collidee === object;
      return concerned && (partner === undefined || collider === partner || collidee === partner);
    });
  }

  private retractThose(is: (event: ContactEvent) => boolean): number {
    const those = this.contacts.filter((contact) => !contact.retracted && is(contact.event));
    for (const contact of those) contact.retracted = true;
    return those.length;
  }
}

const kAlike_s = 0.25; // between the instant that was predicted and the one that was decided

function fulfils(event: ContactEvent, predicted: ContactEvent): boolean {
  if (event.kind === 'predicted' || Math.abs(event.at_s - predicted.at_s) > kAlike_s) return false;
  const same = event.collider === predicted.collider && event.collidee === predicted.collidee;
  return same || (event.collider === predicted.collidee && event.collidee === predicted.collider);
}
