import { Vector3 } from 'three';
import { type Hit, refusalIn } from 'peerd';

import type { PeerLink } from '../live/peer_link';
import type { SceneView } from '../scene/scene_view';
import { DragPlane } from './drag_plane';
import { HandMotion } from './hand_motion';

// A hand that takes an object, moves it in a plane parallel to the picture, and lets it go with the hand's velocity.
//
//   pointer down -> grab .. (applied) -> a pose for each picture -> pointer up: the last pose, then let_go
export interface HandListener {
  onHolds(path: string | null): void;
  onRefused(sentence: string): void;
  onStays(path: string): void; // it was let go at rest, and nothing pulls it down
}

interface Held {
  readonly path: string;
  readonly plane: DragPlane;
  readonly motion: HandMotion;
  given: boolean; // the daemon lets it be moved
  released_s: number | null; // null: the pointer is down
  place: Vector3;
  since_s: number; // when it began to be held
  taken: number; // poses that the daemon has taken
  refused: boolean; // and the page has said so
}

const kPatience_s = 0.5; // right after a grab the first poses may be refused
const kAgainAfter_s = 0.05;

export class Hand {
  private held: Held | null = null;

  constructor(private readonly view: SceneView, private readonly link: PeerLink, private readonly listener: HandListener) {}

  get path(): string | null {
    return this.held?.path ?? null;
  }

  // Takes what the daemon's pick has met; `place` is where the object's frame is drawn.
  async take(hit: Hit, place: Vector3): Promise<void> {
    const ahead = this.view.rig.camera.getWorldDirection(new Vector3());
    const plane = new DragPlane(new Vector3(...hit.position_m), place, ahead);
    const held: Held = { path: hit.path, plane, motion: new HandMotion(), given: false, released_s: null, place: place.clone(), since_s: Infinity, taken: 0, refused: false };
    this.held = held;
    this.listener.onHolds(hit.path);
    const outcome = await this.link.edit({ do: 'grab', path: hit.path });
    if (!outcome.done) {
      this.listener.onRefused(outcome.sentence);
      this.drop(held);
      return;
    }
    held.given = true;
    if (held.released_s !== null) await this.letGo(held, held.released_s); // the pointer went up before the object was given
  }

  // The pointer was at that place of the window at_s, which may be some time ago.
  moveTo(x: number, y: number, at_s: number): void {
    const ray = this.view.ray(x, y);
    const place = this.held?.plane.placeOn(ray.origin, ray.direction) ?? null;
    if (this.held === null || place === null) return;
    this.held.place = place;
    this.held.motion.add(at_s, [place.x, place.y, place.z]);
  }

  push(distance_m: number): void {
    this.held?.plane.push(this.view.rig.camera.getWorldDirection(new Vector3()), distance_m);
  }

  // Once a picture: one pose, unless earlier ones still wait to be sent.
  update(now_s: number): void {
    const held = this.held;
    if (held === null || !held.given || held.released_s !== null || this.link.connection.congested) return;
    held.since_s = Math.min(held.since_s, now_s);
    void this.send(held, now_s).then((why) => this.complain(held, why, now_s));
  }

  // The pointer went up at_s, which may be some time ago.
  release(at_s: number): void {
    const held = this.held;
    if (held === null || held.released_s !== null) return;
    held.released_s = at_s;
    if (held.given) void this.letGo(held, at_s);
  }

  // One pose. Why the daemon has refused it; null: it has taken it.
  private async send(held: Held, now_s: number): Promise<string | null> {
    const pose = { object: held.path, position_m: held.place.toArray(), velocity_m_s: held.motion.velocityAt(now_s) };
    const reply = await this.link.ask({ do: 'pose', ...pose });
    held.taken += Number(reply['taken'] ?? 0);
    const rows = reply['refused'] as { why: string }[] | undefined;
    return (Array.isArray(rows) ? rows[0]?.why : refusalIn(reply)) ?? null;
  }

  private complain(held: Held, why: string | null, now_s: number): void {
    if (why === null || held.refused || now_s < held.since_s + kPatience_s) return;
    held.refused = true; // one sentence for one hold
    this.listener.onRefused(`pose ${held.path}: ${why}`);
  }

  // The last pose, as often as it takes for one to be taken; then the object flies on. What no pose has moved needs no letting go.
  private async letGo(held: Held, at_s: number): Promise<void> {
    let why = await this.send(held, at_s);
    for (let waited_s = 0; held.taken === 0 && waited_s < kPatience_s; waited_s += kAgainAfter_s) {
      await new Promise((over) => setTimeout(over, 1000 * kAgainAfter_s));
      why = await this.send(held, at_s);
    }
    if (held.taken > 0) {
      const reply = await this.link.ask({ do: 'let_go', path: held.path });
      const refusal = refusalIn(reply);
      if (refusal !== null) this.listener.onRefused(`let_go ${held.path}: ${refusal}`);
      else if (reply['stays'] === true) this.listener.onStays(held.path);
    } else if (why !== null && !held.refused) {
      this.listener.onRefused(`pose ${held.path}: ${why}`);
    }
    this.drop(held);
  }

  private drop(held: Held): void {
    if (this.held !== held) return;
    this.held = null;
    this.listener.onHolds(null);
  }
}
