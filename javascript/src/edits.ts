import type { OperationId, Reply } from './messages.js';

// An edit from its request to the instant at which it holds: the peer makes an operation of it, and the operation is then
// applied, or refused because another one came in between.
export type Ask = (request: Readonly<Record<string, unknown>>) => Promise<Reply>;

export interface Outcome {
  readonly done: boolean;
  /** What was asked, and the peer's own words where it was not done. */
  readonly sentence: string;
  /** Where the peer has made one of it. */
  readonly operation?: OperationId;
  readonly unanswered?: true;
}

const kPatience_ms = 10000;
const kPoll_ms = 60;

/** Asks for an edit and waits until it is applied at the peer, for 10 s at most. */
export async function edit(ask: Ask, request: Readonly<Record<string, unknown>>): Promise<Outcome> {
  const reply = await ask(request);
  if (refusalIn(reply) !== null) return notDone(request, reply);
  const operation = reply['operation'] as OperationId | undefined | null;
  if (operation === undefined || operation === null) return { done: true, sentence: nameOf(request) };
  return applied(ask, request, operation);
}

async function applied(ask: Ask, request: Readonly<Record<string, unknown>>, operation: OperationId): Promise<Outcome> {
  const { author, number } = operation;
  for (let waited_ms = 0; waited_ms < kPatience_ms; waited_ms += kPoll_ms) {
    const state = await ask({ do: 'operation', author, number });
    if (refusalIn(state) !== null) return notDone(request, state);
    if (state['applied'] === true) return { done: true, sentence: `${nameOf(request)}: done`, operation };
    await new Promise((resolve) => setTimeout(resolve, kPoll_ms));
  }
  return { done: false, sentence: `${nameOf(request)}: operation ${author}:${number} is not applied yet` };
}

function notDone(request: Readonly<Record<string, unknown>>, reply: Reply): Outcome {
  return { done: false, sentence: `${nameOf(request)}: ${refusalIn(reply)}`, ...(reply.unanswered === undefined ? {} : { unanswered: true }) };
}

/** Why a peer has not done what was asked, in its words; null: it has. */
export function refusalIn(reply: Reply): string | null {
  if (!reply.ok) return reply.error ?? 'refused without a reason';
  if (typeof reply['refused'] === 'string') return reply['refused'];
  if (reply['done'] === false && !('applied' in reply)) return 'not done';
  return null;
}

function nameOf(request: Readonly<Record<string, unknown>>): string {
  const about = request['path'] ?? request['object'] ?? request['under'] ?? '';
  return `${String(request['do'])} ${String(about)}`.trim();
}
