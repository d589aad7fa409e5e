import type { DaemonEvent } from './live/live_connection';
import type { ContactEvent } from './live/replies';
import type { KnownContact } from './scene/contact_marks';

// The contacts of the last minute, in order of time, and whether they still hold.
const kMost = 2000;

export class ContactBook {
  private contacts: KnownContact[] = [];

  constructor(private readonly nameOf: (peer: number | null | undefined) => string) {}

  take(event: DaemonEvent): void {
    if (event.event === 'contact') this.add(event as unknown as ContactEvent);
    if (event.event === 'contact_overruled') this.overrule(event);
    if (event.event === 'contacts_retracted') this.retract(event);
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

  private overrule(event: DaemonEvent): void {
    for (const contact of this.contacts) {
      const { at_s, collider, collidee } = contact.event;
      if (at_s === event['at_s'] && collider === event['collider'] && collidee === event['collidee']) contact.retracted = true;
    }
  }

  private retract(event: DaemonEvent): void {
    const { object, partner } = event as { object?: unknown; partner?: unknown };
    for (const contact of this.contacts) {
      const { at_s, collider, collidee, kind } = contact.event;
      if (at_s <= Number(event['after_s']) || (event['predicted_only'] === true && kind !== 'predicted')) continue;
      const concerned = collider === object || collidee === object;
      if (concerned && (partner === undefined || collider === partner || collidee === partner)) contact.retracted = true;
    }
  }
}
