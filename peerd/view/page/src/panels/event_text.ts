import type { DaemonEvent } from 'peerd';

// An event of the daemon as a sentence. One that this page does not know is shown as it came.
export function eventText(event: DaemonEvent, nameOf: (peer: number | null | undefined) => string): string {
  const text = (member: string): string => String(event[member] ?? '');
  const peer = (member: string): string => nameOf(event[member] as number | null | undefined);
  switch (event.event) {
    case 'owner':
      return `${text('object')}: ${peer('owner')} owns it, before it was ${peer('before')}`;
    case 'orphaned':
      return `${text('object')} has no owner: ${peer('before')} is gone`;
    case 'contact':
      return contactText(event, peer('decider'));
    case 'contact_overruled':
      return `${text('collider')} with ${text('collidee')}: a decided contact does not count`;
    case 'contacts_retracted':
      return `contacts of ${text('object')}${event['partner'] === undefined ? '' : ` with ${text('partner')}`} are retracted`;
    case 'joined':
      return `${text('name')} has joined${event['restarted'] === true ? ', restarted' : ''}`;
    case 'left':
      return `${text('name')} has left${event['left_gracefully'] === true ? '' : ' without a word'}`;
    case 'data':
      return `${text('node')}: ${text('key')} is ${event['value'] === null ? 'gone' : text('value')}`;
    case 'message':
      return `${peer('peer')} says on ${text('topic')}: ${text('text')}`;
    case 'edit': {
      const operation = event['operation'] as { author: number; number: number } | undefined;
      const refused = event['refused'] === undefined ? '' : `: ${text('refused')}`;
      return `edit ${operation?.author ?? '?'}:${operation?.number ?? '?'} takes effect${refused}`;
    }
    case 'dropped':
      return `${text('count')} events were dropped, because this page read too slowly`;
    default:
      return JSON.stringify(event);
  }
}

function contactText(event: DaemonEvent, decider: string): string {
  const pair = `${String(event['collider'])} hits ${String(event['collidee'])}`;
  switch (event['kind']) {
    case 'owner':
      return `${pair}: found by its owner ${decider}`;
    case 'decided':
      return `${pair}: decided here, by ${decider}`;
    case 'applied':
      return `${pair}: decided by ${decider}`;
    case 'predicted':
      return `${pair}: predicted`;
    default:
      return `${pair}: in the scene`;
  }
}
