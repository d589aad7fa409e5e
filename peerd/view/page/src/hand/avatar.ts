import { Euler, Quaternion, Vector3, type PerspectiveCamera } from 'three';
import { refusalIn, type Reply } from 'peerd';

import type { PeerLink } from '../live/peer_link';
import type { SceneExtras } from '../scene/scene_file';

// Somebody who walks through the world with this page's camera as eye: an object of this peer's like any other, which all
// peers see, and from whose eye this peer looks while it is there. The daemon says how far a step goes, by what collides.
//
//   enter: add -> grab -> avatar, viewpoint .. for each picture: walk -> pose .. leave: viewpoint, avatar, remove
export interface AvatarListener {
  onChange(path: string | null): void;
  onRefused(sentence: string): void;
}

interface Sizes {
  readonly radius_m: number;
  readonly height_m: number;
  readonly step_m: number;
}
interface Walking {
  readonly path: string;
  readonly eye: Vector3;
  readonly drawn: Vector3; // the camera, which follows the eye evenly
  state: 'entering' | 'walking' | 'left';
  added: boolean; // to the scene
  fall_m_s: number;
  asked_s: number; // when it last asked
  asks: boolean;
}

const kFollow_per_s = 18;
const kLongest_s = 0.1; // a page that was asleep does not make up for it

export class Avatar {
  private walking: Walking | null = null;

  constructor(private readonly link: PeerLink, private readonly camera: PerspectiveCamera, private readonly listener: AvatarListener) {}

  get path(): string | null {
    return this.walking?.state === 'walking' ? this.walking.path : null;
  }
  get eye_m(): readonly [number, number, number] | null {
    return this.walking?.state === 'walking' ? this.walking.eye.toArray() : null;
  }

  async enter(eye: Vector3, extras: SceneExtras): Promise<void> {
    if (this.walking !== null) return;
    const path = `AVATAR_${this.link.ownId}_${Math.floor(Math.random() * 0xffffffff).toString(36).toUpperCase()}`;
    const walking: Walking = { path, eye: eye.clone(), drawn: eye.clone(), state: 'entering', added: false, fall_m_s: 0, asked_s: NaN, asks: false };
    this.walking = walking;
    const refusal = await this.join(walking, sizesOf(extras));
    if (this.walking !== walking) return; // the connection has ended
    if (refusal !== null) this.listener.onRefused(refusal);
    if (refusal !== null || walking.state === 'left') {
      await this.takeAway(walking);
    } else {
      walking.state = 'walking';
      this.listener.onChange(path);
    }
  }

  private async join(walking: Walking, sizes: Sizes): Promise<string | null> {
    const { path } = walking;
    const added = await this.link.edit({ do: 'add', text: figure(path, walking.eye, sizes) });
    if (!added.done) return added.sentence;
    walking.added = true;
    const owned = refusalIn(await this.link.ask({ do: 'avatar', path }));
    if (owned !== null) return owned;
    const grabbed = await this.link.edit({ do: 'grab', path });
    if (!grabbed.done) return grabbed.sentence;
    const { aspect } = this.camera;
    return refusalIn(await this.link.ask({ do: 'viewpoint', object: path, position_m: [0, 0, 0], field_of_view_rad: smallerAngle_rad(this.camera), aspect }));
  }

  async leave(): Promise<void> {
    const { walking } = this;
    if (walking === null || walking.state === 'left') return;
    const isThere = walking.state === 'walking'; // else whoever lets it in takes it away
    walking.state = 'left';
    if (isThere) await this.takeAway(walking);
  }

  private async takeAway(walking: Walking): Promise<void> {
    walking.state = 'left';
    this.listener.onChange(null);
    if (walking.added) {
      const sentences = [refusalIn(await this.link.ask({ do: 'viewpoint' })), refusalIn(await this.link.ask({ do: 'avatar' }))];
      const removed = await this.link.edit({ do: 'remove', path: walking.path });
      if (!removed.done) sentences.push(removed.sentence);
      for (const sentence of sentences) if (sentence !== null) this.listener.onRefused(sentence);
    }
    if (this.walking === walking) this.walking = null;
  }

  // The connection has ended, and with it the avatar: the daemon removes it.
  forget(): void {
    if (this.walking === null) return;
    this.walking = null;
    this.listener.onChange(null);
  }

  // Once a picture. `wish`: where to, in the camera's own axes, at most 1 long.
  update(now_s: number, elapsed_s: number, wish: Vector3, extras: SceneExtras): void {
    const { walking } = this;
    if (walking?.state !== 'walking') return;
    walking.drawn.lerp(walking.eye, 1 - Math.exp(-kFollow_per_s * elapsed_s));
    this.camera.position.copy(walking.drawn);
    if (!walking.asks && !this.link.connection.congested) void this.step(walking, now_s, wish, extras);
  }

  private async step(walking: Walking, now_s: number, wish: Vector3, extras: SceneExtras): Promise<void> {
    const for_s = Math.min(kLongest_s, Number.isNaN(walking.asked_s) ? 0 : now_s - walking.asked_s);
    walking.asked_s = now_s;
    walking.asks = true;
    const falls = fallsIn(extras);
    const heading = headingOf(this.camera.quaternion);
    const by = wish.clone().applyQuaternion(falls ? heading : this.camera.quaternion).multiplyScalar((extras.navigation?.speed ?? 1) * for_s);
    const reply = await this.link.ask({ do: 'walk', eye_m: walking.eye.toArray(), by_m: by.toArray(), falls, fall_m_s: walking.fall_m_s, for_s, except: walking.path, ...sizesOf(extras) });
    walking.asks = false;
    if (walking.state !== 'walking') return;
    const refusal = refusalIn(reply);
    if (refusal !== null) {
      this.listener.onRefused(`walk: ${refusal}`);
      void this.leave();
      return;
    }
    await this.place(walking, reply, heading, for_s);
  }

  private async place(walking: Walking, reply: Reply, heading: Quaternion, for_s: number): Promise<void> {
    const to = new Vector3(...(reply['eye_m'] as [number, number, number]));
    const velocity = for_s > 0 ? to.clone().sub(walking.eye).divideScalar(for_s) : new Vector3();
    walking.eye.copy(to);
    walking.fall_m_s = Number(reply['fall_m_s'] ?? 0);
    const pose = { object: walking.path, position_m: to.toArray(), velocity_m_s: velocity.toArray(), orientation_xyzw: heading.toArray() };
    const placed = await this.link.ask({ do: 'pose', ...pose });
    if (!placed.ok && walking.state === 'walking') this.listener.onRefused(`pose ${walking.path}: ${placed.error ?? ''}`);
  }
}

// VRML97, 6.29: distance to walls, height of the eye, height of a step.
export function sizesOf(extras: SceneExtras): Sizes {
  const [radius_m = 0.25, height_m = 1.6, step_m = 0.75] = extras.navigation?.avatar_size ?? [];
  return { radius_m, height_m, step_m };
}

// The first type that says how one moves.
export function fallsIn(extras: SceneExtras): boolean {
  const { type } = extras.navigation ?? {};
  const types = typeof type === 'string' ? [type] : (type ?? []);
  return types.find((name) => name === 'WALK' || name === 'FLY' || name === 'NONE') !== 'FLY';
}

// Of the angles of width and height, as the daemon has it; three.js has that of height.
export function smallerAngle_rad({ fov, aspect }: { readonly fov: number; readonly aspect: number }): number {
  return 2 * Math.atan(Math.tan((fov * Math.PI) / 360) * Math.min(1, aspect));
}

// The part of a camera's turn that is about the vertical.
export function headingOf(turn: Quaternion): Quaternion {
  const { y } = new Euler().setFromQuaternion(turn, 'YXZ');
  return new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), y);
}

// A body and a head, whose origin is the eye. From inside it is not seen.
function figure(name: string, eye: Vector3, { radius_m, height_m }: Sizes): string {
  const head_m = Math.min(0.16, height_m / 8);
  const body_m = Math.max(0.1, height_m - 2 * head_m);
  const colour = [0, 1, 2].map((shift) => (0.35 + 0.5 * ((hashOf(name) >> (8 * shift)) % 256) / 255).toFixed(3)).join(' ');
  const look = `appearance Appearance { material Material { diffuseColor ${colour} } }`;
  return `DEF ${name} Transform { translation ${eye.toArray().join(' ')} children [
  Shape { ${look} geometry Sphere { radius ${head_m} } }
  Transform { translation 0 ${-(height_m - body_m / 2)} 0 children Shape { ${look} geometry Cone { bottomRadius ${radius_m} height ${body_m} } } }
] }`;
}

function hashOf(text: string): number {
  return [...text].reduce((hash, letter) => (Math.imul(hash, 31) + letter.charCodeAt(0)) >>> 0, 7);
}
