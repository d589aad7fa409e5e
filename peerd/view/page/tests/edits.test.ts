import { describe, expect, it } from 'vitest';
import { edit, type Reply } from 'peerd';

// A daemon's replies, in order; what the page asked stands in `asked`.
function daemon(replies: Reply[]): { ask: (request: Record<string, unknown>) => Promise<Reply>; asked: Record<string, unknown>[] } {
  const asked: Record<string, unknown>[] = [];
  const ask = (request: Record<string, unknown>): Promise<Reply> => {
    asked.push(request);
    return Promise.resolve(replies.shift() ?? { ok: false, error: 'no reply is left' });
  };
  return { ask, asked };
}

describe('an edit', () => {
  it('is done when its operation is applied', async () => {
    const { ask, asked } = daemon([
      { ok: true, done: true, operation: { author: 7, number: 3 } },
      { ok: true, applied: false, done: true },
      { ok: true, applied: true, done: true },
    ]);
    expect((await edit(ask, { do: 'grab', path: 'CAR' })).done).toBe(true);
    expect(asked).toHaveLength(3);
    expect(asked[1]).toEqual({ do: 'operation', author: 7, number: 3 });
  });

  it.each<[string, Reply[], string]>([
    ['where the daemon refuses the request', [{ ok: false, error: 'this needs the token' }], 'grab CAR: this needs the token'],
    ['where no operation is made of it', [{ ok: true, done: false, refused: 'CAR is driven' }], 'grab CAR: CAR is driven'],
    ['where another edit came in between', [{ ok: true, done: true, operation: { author: 1, number: 1 } }, { ok: true, applied: false, done: false, refused: 'its owner keeps it' }], 'grab CAR: its owner keeps it'],
  ])('has the daemon’s own words %s', async (_name, replies, sentence) => {
    expect(await edit(daemon(replies).ask, { do: 'grab', path: 'CAR' })).toEqual({ done: false, sentence });
  });
});
