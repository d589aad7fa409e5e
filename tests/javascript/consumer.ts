// A program that uses the package, for the compiler alone: what is right is taken, and what is wrong is not.
import { Connection, Peer, PeerdError, type ContactEvent, type EventOf, type Numbers3, type ObjectPose } from 'peerd';

export async function use(address: string): Promise<void> {
  const peer: Peer = await Peer.connect(address, { WebSocket });
  const place: Numbers3 | undefined = (await peer.objects())[0]?.position_m;
  await peer.pose([{ object: 'CAR', position_m: place ?? [0, 0, 0] }]);
  const { time_s } = (await peer.ask({ do: 'status' })).session;
  const known: number = time_s ?? 0;
  for await (const event of await peer.subscribe('contacts', 'peers')) {
    if (event.event === 'contact') takeContact(event);
    if (event.event === 'joined') console.log(event.name.toUpperCase(), known);
    if (event.event === 'dropped') console.log(event.count + 1);
    // @ts-expect-error: nobody has subscribed to messages
    if (event.event === 'message') console.log(event);
  }
  const watch = await peer.watch({ kinds: ['shown', 'truth'] });
  const pose: ObjectPose | null = watch.pose('CAR', 'truth');
  // @ts-expect-error: the pose may not be known
  console.log(pose.position_m);
  // @ts-expect-error: no request has this name
  await peer.ask({ do: 'dance' });
  // @ts-expect-error: a path is missing
  await peer.ask({ do: 'set', field: 'scale', value: '1 1 1' });
  // @ts-expect-error: a place has three numbers
  await peer.pose({ object: 'CAR', position_m: [0, 0] });
  // @ts-expect-error: no kind has this name
  await peer.subscribe('collisions');
  // @ts-expect-error: a Peer is connected, not made
  new Peer(address);
  // @ts-expect-error: internal
  watch.take(null);
}

function takeContact(contact: ContactEvent): EventOf<'contact'>['normal'] {
  return contact.normal;
}

export function failed(error: unknown): boolean {
  return error instanceof PeerdError && !error.answered && Connection.name !== error.request;
}
