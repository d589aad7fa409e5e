import type { Reply } from './live_connection';

// An edit from its request to the instant at which it holds: the daemon makes an operation of it, and the operation is
// then applied, or refused because another one came in between.
export type Ask = (request: Record<string, unknown>) => Promise<Reply>;
export interface Outcome {
  readonly done: boolean;
  readonly sentence: string; // the daemon's own words where it was not done
}

const kPatience_ms = 10000;
const kPoll_ms = 60;

export async function edit(ask: Ask, request: Record<string, unknown>): Promise<Outcome> {
  const reply = await ask(request);
  const refusal = refusalIn(reply);
  if (refusal !== null) return { done: false, sentence: `${nameOf(request)}: ${refusal}` };
  const operation = reply['operation'] as { author: number; number: number } | undefined | null;
  if (operation === undefined || operation === null) return { done: true, sentence: nameOf(request) };
  return await applied(ask, request, operation);
}

async function applied(ask: Ask, request: Record<string, unknown>, operation: { author: number; number: number }): Promise<Outcome> {
  for (let waited_ms = 0; waited_ms < kPatience_ms; waited_ms += kPoll_ms) {
    const state = await ask({ do: 'operation', author: operation.author, number: operation.number });
    const refusal = refusalIn(state);
    if (refusal !== null) return { done: false, sentence: `${nameOf(request)}: ${refusal}` };
    if (state['applied'] === true) return { done: true, sentence: `${nameOf(request)}: done` };
    await new Promise((resolve) => setTimeout(resolve, kPoll_ms));
  }
  return { done: false, sentence: `${nameOf(request)}: operation ${operation.author}:${operation.number} is not applied yet` };
}

export function refusalIn(reply: Reply): string | null {
  if (!reply.ok) return reply.error ?? 'refused without a reason';
  if (typeof reply['refused'] === 'string') return reply['refused'];
  if (reply['done'] === false && !('applied' in reply)) return 'not done';
  return null;
}

function nameOf(request: Record<string, unknown>): string {
  const about = request['path'] ?? request['object'] ?? request['under'] ?? '';
  return `${String(request['do'])} ${String(about)}`.trim();
}
