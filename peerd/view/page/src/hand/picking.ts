import type { Vector3 } from 'three';
import type { Ask, Hit } from 'peerd';

// What the daemon says that a ray meets first, by its own exact query on the world as it is now.
export async function pick(ask: Ask, origin: Vector3, direction: Vector3): Promise<Hit | null | string> {
  const reply = await ask({ do: 'pick', origin_m: origin.toArray(), direction: direction.toArray() });
  if (!reply.ok) return reply.error ?? 'the pick was refused';
  return (reply['hit'] as Hit | null | undefined) ?? null;
}
