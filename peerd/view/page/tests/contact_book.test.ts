import { describe, expect, it } from 'vitest';

import { ContactBook } from '../src/contact_book';

function contact(at_s: number, kind: string, decider: number | null, collider = 'A', collidee = 'B'): { event: string; [member: string]: unknown } {
  return { event: 'contact', at_s, kind, decider, collider, collidee, normal: [1, 0, 0] };
}
const names = (peer: number | null | undefined): string => `peer ${peer}`;

describe('the book of contacts', () => {
  it('has those of a stretch of time, in its order, with their deciders', () => {
    const book = new ContactBook(names);
    for (const event of [contact(3, 'applied', 2), contact(1, 'decided', 1), contact(2, 'predicted', null)]) book.take(event);
    expect(book.between(1, 3).map(({ event, decider }) => [event.at_s, decider])).toEqual([[2, ''], [3, 'peer 2']]);
  });

  it('leaves out predictions that have come true', () => {
    const book = new ContactBook(names);
    for (const event of [contact(1, 'predicted', null), contact(1.01, 'decided', 1), contact(2, 'predicted', null), contact(3, 'predicted', null, 'B', 'A'), contact(3.1, 'owner', 1)]) book.take(event);
    expect(book.inForce(0, 4).map(({ event }) => [event.at_s, event.kind])).toEqual([[1.01, 'decided'], [2, 'predicted'], [3.1, 'owner']]);
  });

  it('marks what is overruled', () => {
    const book = new ContactBook(names);
    book.take(contact(1, 'decided', 1));
    book.take(contact(1, 'decided', 1, 'A', 'C'));
    book.take({ event: 'contact_overruled', at_s: 1, collider: 'A', collidee: 'C' });
    expect(book.all().map((known) => known.retracted)).toEqual([false, true]);
  });

  it.each([
    ['of an object', { object: 'A', after_s: 1.5 }, [false, true, true, true]],
    ['with one partner', { object: 'A', after_s: 1.5, partner: 'C' }, [false, false, false, true]],
    ['that were predicted only', { object: 'A', after_s: 0, predicted_only: true }, [false, true, false, false]],
    ['of another object', { object: 'X', after_s: 0 }, [false, false, false, false]],
  ])('marks what is retracted %s', (_name, retraction, expected) => {
    const book = new ContactBook(names);
    book.take(contact(1, 'owner', 1));
    book.take(contact(2, 'predicted', null));
    book.take(contact(3, 'applied', 2));
    book.take(contact(4, 'decided', 1, 'C', 'A'));
    book.take({ event: 'contacts_retracted', ...retraction });
    expect(book.all().map((known) => known.retracted)).toEqual(expected);
  });
});
