import type { DaemonEvent } from './live/live_connection';
import type { ContactEvent } from './live/replies';
import type { KnownContact } from './scene/contact_marks';

// The contacts of the last minute, in order of time, and whether they still hold.
const kMost = 2000;

export class ContactBook {
  private contacts: KnownContact[] = [];

  constructor(private readonly nameOf: (peer: number | null | undefined) => string) {}

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

  all(): readonly KnownContact[] {
    return this.contacts;
  }

  private add(event: ContactEvent): void {
    const decided = event.decider !== undefined && event.decider !== null;
    this.contacts.push({ event, decider: decided ? this.nameOf(event.decider) : '', retracted: false });
    this.contacts.sort((a, b) => a.event.at_s - b.event.at_s);
    if (this.contacts.length > kMost) this.contacts.splice(0, this.contacts.length - kMost);
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
