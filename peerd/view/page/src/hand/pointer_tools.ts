import { Vector3 } from 'three';
import type { Hit } from 'peerd';

import type { PeerLink } from '../live/peer_link';
import type { SceneView } from '../scene/scene_view';
import type { Hand } from './hand';
import { pick } from './picking';

// What the pointer does on the picture: a click selects; with the hand's tool a drag that begins on an object takes it.
export type Tool = 'orbit' | 'fly' | 'walk' | 'hand';
const kClick_px = 5;

export interface PointerListener {
  onPicked(hit: Hit | null): void;
  onPickedThen(node: number | null): void; // in the past, where the daemon's query of the present says nothing
  onRefused(sentence: string): void;
  mayTake(): boolean;
  isLive(): boolean;
  now_s(): number;
}

export class PointerTools {
  tool: Tool = 'orbit';
  private missed = false; // the hand has met nothing
  private down: { x: number; y: number; id: number } | null = null;

  constructor(
    private readonly surface: HTMLElement,
    private readonly view: SceneView,
    private readonly link: PeerLink,
    private readonly hand: Hand,
    private readonly listener: PointerListener,
  ) {
    surface.addEventListener('pointerdown', (event) => void this.onDown(event));
    surface.addEventListener('pointermove', (event) => this.onMove(event));
    surface.addEventListener('pointerup', (event) => void this.onUp(event));
    surface.addEventListener('pointercancel', (event) => this.letGo(event.timeStamp / 1000));
    surface.addEventListener('wheel', (event) => this.onWheel(event), { passive: true });
  }

  private async onDown(event: PointerEvent): Promise<void> {
    if (event.button !== 0 || !event.isPrimary) return;
    this.down = { x: event.clientX, y: event.clientY, id: event.pointerId };
    if (this.tool !== 'hand' || !this.listener.isLive()) return;
    this.missed = this.view.nodeUnder(event.clientX, event.clientY) === null;
    if (this.missed) return; // the drag turns the camera
    if (!this.listener.mayTake()) {
      this.listener.onRefused('this page is read-only: it has no token, so it cannot take objects');
      return;
    }
    this.view.rig.frozen = true;
    this.surface.setPointerCapture(event.pointerId);
    await this.take(event.clientX, event.clientY);
  }

  private async take(x: number, y: number): Promise<void> {
    const hit = await this.pickAt(x, y);
    const place = new Vector3();
    if (hit === null || hit === undefined || this.view.frames === null || !this.view.frames.position(hit.node, place)) {
      this.view.rig.frozen = false;
      if (hit === null) this.listener.onRefused('what is drawn there cannot be taken: it has no surface that collides');
      else if (hit !== undefined) this.listener.onRefused(`${hit.path} cannot be taken: the picture has no place of it yet`);
      return;
    }
    this.listener.onPicked(hit);
    const taken = this.hand.take(hit, place);
    if (this.down === null) this.hand.release(this.listener.now_s());
    await taken;
  }

  private onMove(event: PointerEvent): void {
    if (this.hand.path === null) return;
    const all = event.getCoalescedEvents(); // browsers give one event a picture; the hand's way is in these
    for (const part of all.length > 0 ? all : [event]) this.hand.moveTo(part.clientX, part.clientY, part.timeStamp / 1000);
  }

  private async onUp(event: PointerEvent): Promise<void> {
    const { down } = this;
    const held = this.hand.path !== null;
    this.letGo(event.timeStamp / 1000);
    if (down === null || held) return;
    if (Math.hypot(event.clientX - down.x, event.clientY - down.y) > kClick_px) return;
    if (this.tool === 'hand' && this.missed) this.listener.onRefused('the hand has met nothing there');
    await this.select(event.clientX, event.clientY);
  }

  private letGo(at_s: number): void {
    this.down = null;
    this.hand.release(at_s);
    this.view.rig.frozen = false;
  }

  private onWheel(event: WheelEvent): void {
    if (this.hand.path !== null) this.hand.push(-event.deltaY * 0.01);
  }

  private async select(x: number, y: number): Promise<void> {
    if (!this.listener.isLive()) {
      this.listener.onPickedThen(this.view.nodeUnder(x, y));
      return;
    }
    const hit = await this.pickAt(x, y);
    if (hit !== undefined) this.listener.onPicked(hit);
  }

  // Undefined: the daemon has refused, and the page has said so.
  private async pickAt(x: number, y: number): Promise<Hit | null | undefined> {
    const ray = this.view.ray(x, y);
    const hit = await pick((request) => this.link.ask(request), ray.origin, ray.direction);
    if (typeof hit !== 'string') return hit;
    this.listener.onRefused(`pick: ${hit}`);
    return undefined;
  }
}
