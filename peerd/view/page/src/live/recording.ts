import { type DaemonEvent, readPoseFrame } from 'peerd';

import type { KeptFrame } from '../time/frames';

// What the gateway of `peerd view` serves in place of a peer (docs/reference/gateway.md): what each peer of a run, or the
// peer of a capture, had in view, over the whole time. Times are in seconds from the recording's begin.
export interface RecordedView {
  readonly peer: number;
  readonly name: string;
  readonly scenes: readonly { readonly revision: number; readonly from_s: number; readonly why_not?: string }[];
  readonly stretches: readonly (readonly [from_s: number, until_s: number, revision: number])[];
}

export interface Recording {
  readonly kind: 'run' | 'capture';
  readonly name: string;
  readonly title: string;
  readonly world: string;
  readonly end_s: number;
  readonly hz: number;
  readonly notes: readonly string[];
  readonly peers: readonly { readonly id: number; readonly name: string }[];
  readonly happenings: readonly (readonly [t_s: number, name: string])[];
  readonly views: readonly RecordedView[];
}

const kPlace = 'api/v1/recording';

// null: it is the page of a running peer.
export async function askForRecording(): Promise<Recording | null> {
  const reply = (await (await fetched(kPlace)).json()) as { recording: Recording | null };
  return reply.recording;
}

export function sceneAddress(view: number, revision: number): string {
  return `${kPlace}/${view}/scene-${revision}`;
}

export async function fetchStretch(view: number, stretch: number): Promise<KeptFrame[]> {
  return splitFrames(await (await fetched(`${kPlace}/${view}/poses-${stretch}`)).arrayBuffer());
}

export async function fetchEvents(view: number): Promise<(readonly [t_s: number, event: DaemonEvent])[]> {
  return (await (await fetched(`${kPlace}/${view}/events`)).json()) as [number, DaemonEvent][];
}

// The mean error of each instant, and the largest one, by turns [m].
export async function fetchErrors(view: number): Promise<Float32Array> {
  return new Float32Array(await (await fetched(`${kPlace}/${view}/errors`)).arrayBuffer());
}

// Of one object; nothing where its ghost or its truth is never known.
export async function fetchErrorsOf(view: number, id: string): Promise<Float32Array> {
  return new Float32Array(await (await fetched(`${kPlace}/${view}/errors-${id}`)).arrayBuffer());
}

// Frames stand one after the other.
export function splitFrames(all: ArrayBuffer): KeptFrame[] {
  const frames: KeptFrame[] = [];
  const head = new DataView(all);
  for (let at = 0; at + 40 <= all.byteLength; ) {
    const length = 40 + head.getUint32(at + 4, true) * head.getUint32(at + 36, true);
    const frame = readPoseFrame(all.slice(at, at + length));
    if (typeof frame === 'string') throw new Error(frame);
    frames.push({ time_s: frame.sessionTime_s, frame });
    at += length;
  }
  return frames;
}

async function fetched(address: string): Promise<Response> {
  const reply = await fetch(address);
  if (!reply.ok) throw new Error(`${address}: ${reply.status}`);
  return reply;
}
