import { Ray, type Matrix4, type Vector3 } from 'three';
import type { Outcome } from 'peerd';

import type { SceneView } from '../scene/scene_view';
import { dragOf, type SensorDrag } from './sensor_drag';
import { previewsOf, worldFromSensor } from './sensor_frames';
import { editsOf, isDragged, keyOf, sensorsAround, type EventValue, type SensorExtras } from './sensor_rules';

// The pointer on the geometry of the world's sensors. It meets what is drawn, as the standard has it, and not what collides. A
// TouchSensor is pressed and released where the pointer has not been dragged, so that a drag stays the camera's; a
// PlaneSensor, CylinderSensor or SphereSensor is dragged, and the world has what comes of it when it is let go.
export interface SensorHost {
  edit(request: Record<string, unknown>): Promise<Outcome>;
  mayEdit(): boolean;
  isLive(): boolean;
  worldTime_s(): number; // NaN: there is none yet
  onRefused(sentence: string): void;
  onPreview(): void;
}

const kClick_px = 5;

interface Drag {
  sensor: SensorExtras; // of the scene that is shown
  readonly sensorFromWorld: Matrix4; // of the instant at which it began
  readonly motion: SensorDrag;
  hasMoved: boolean;
}

export class Sensors {
  private pressed: { sensors: readonly SensorExtras[]; x: number; y: number; active: boolean } | null = null;
  private drags: readonly Drag[] = [];
  private readonly offsets = new Map<string, readonly number[]>(); // where one with autoOffset was let go that no edit can name

  constructor(private readonly surface: HTMLElement, private readonly view: SceneView, private readonly host: SensorHost) {
    // Before the camera and the tools, which do not see what is dragged.
    surface.addEventListener('pointerdown', (event) => this.onDown(event), { capture: true });
    surface.addEventListener('pointermove', (event) => this.onMove(event), { capture: true });
    surface.addEventListener('pointerup', (event) => this.onUp(event), { capture: true });
    surface.addEventListener('pointercancel', () => this.cancel(), { capture: true });
  }

  // The view shows another scene, because somebody has edited the world. It draws what is being dragged where the pointer has it.
  onScene(): void {
    if (this.drags.length === 0) return;
    const sensors = new Map(this.view.file?.extras.sensors?.map((sensor) => [keyOf(sensor), sensor]));
    this.drags = this.drags.filter((drag) => {
      const found = sensors.get(keyOf(drag.sensor));
      if (found !== undefined) drag.sensor = found;
      return found !== undefined;
    });
    this.showWhereDragged();
  }

  // Whether the pointer is on the geometry of a sensor.
  isOver(x: number, y: number): boolean {
    return this.sensorsUnder(x, y).length > 0;
  }

  private sensorsUnder(x: number, y: number): readonly SensorExtras[] {
    const all = this.view.file?.extras.sensors ?? [];
    const under = all.length === 0 ? null : this.view.shapeUnder(x, y);
    return under === null ? [] : sensorsAround(under.path, all);
  }

  private onDown(event: PointerEvent): void {
    if (event.button !== 0 || !event.isPrimary || !this.host.isLive()) return;
    const sensors = this.sensorsUnder(event.clientX, event.clientY);
    if (sensors.length === 0) return;
    if (!this.host.mayEdit()) {
      this.host.onRefused('this page is read-only: it has no token, so it cannot work the world’s sensors');
      return;
    }
    const under = this.view.shapeUnder(event.clientX, event.clientY);
    const dragged = sensors.filter(isDragged);
    if (dragged.length > 0 && under !== null) {
      const ray = this.rayAt(event.clientX, event.clientY);
      this.drags = dragged.map((sensor) => this.begin(sensor, under.point, ray));
      this.surface.setPointerCapture(event.pointerId);
      event.stopImmediatePropagation();
    }
    this.pressed = { sensors, x: event.clientX, y: event.clientY, active: true };
    void this.send(sensors, 'isActive', true);
  }

  private onMove(event: PointerEvent): void {
    const { pressed, drags } = this;
    if (drags.length > 0) {
      event.stopImmediatePropagation();
      this.follow(event.clientX, event.clientY);
    } else if (pressed?.active === true && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > kClick_px) {
      pressed.active = false; // the camera turns
      void this.send(pressed.sensors, 'isActive', false);
    }
  }

  private onUp(event: PointerEvent): void {
    const { pressed, drags } = this;
    if (drags.length > 0) {
      event.stopImmediatePropagation();
      this.follow(event.clientX, event.clientY);
    }
    this.pressed = null;
    this.drags = [];
    for (const drag of drags) if (drag.hasMoved) void this.letGo(drag);
    if (pressed?.active !== true) return;
    void this.send(pressed.sensors, 'isActive', false);
    const touched = pressed.sensors.filter(({ type }) => type === 'TouchSensor');
    const time_s = this.host.worldTime_s();
    const stays = this.sensorsUnder(event.clientX, event.clientY).some((sensor) => pressed.sensors.some(({ path }) => path === sensor.path));
    if (touched.length > 0 && stays && !Number.isNaN(time_s)) void this.send(touched, 'touchTime', time_s);
  }

  // What is dragged is drawn where it is let go until the scene has it there.
  private async letGo({ sensor, motion }: Drag): Promise<void> {
    const values = motion.values();
    if (sensor.auto_offset !== false) this.offsets.set(keyOf(sensor), values['offset']);
    const sent = Object.entries(values).filter(([event]) => event !== 'offset' || sensor.auto_offset !== false);
    const done = await Promise.all(sent.map(([event, value]) => this.send([sensor], event, value)));
    if (!done.every(Boolean)) this.showWhereItIs();
  }

  private cancel(): void {
    if (this.pressed?.active === true) void this.send(this.pressed.sensors, 'isActive', false);
    if (this.drags.length > 0) this.showWhereItIs();
    this.pressed = null;
    this.drags = [];
  }

  private showWhereItIs(): void {
    this.view.preview([]);
    this.host.onPreview();
  }

  private begin(sensor: SensorExtras, point: Vector3, ray: Ray): Drag {
    const sensorFromWorld = worldFromSensor(sensor, this.view.frames).invert();
    const offset = (this.isKept(sensor) ? undefined : this.offsets.get(keyOf(sensor))) ?? sensor.offset ?? [0, 0, 0, 0];
    const motion = dragOf(sensor, point.clone().applyMatrix4(sensorFromWorld), ray.clone().applyMatrix4(sensorFromWorld), offset);
    return { sensor, sensorFromWorld, motion, hasMoved: false };
  }

  private follow(x: number, y: number): void {
    const hasMoved = this.pressed !== null && (x !== this.pressed.x || y !== this.pressed.y);
    for (const drag of this.drags) {
      drag.hasMoved ||= hasMoved;
      if (drag.hasMoved) drag.motion.follow(this.rayAt(x, y).applyMatrix4(drag.sensorFromWorld));
    }
    this.showWhereDragged();
  }

  private showWhereDragged(): void {
    this.view.preview(this.drags.filter((drag) => drag.hasMoved).flatMap(({ sensor, motion }) => previewsOf(sensor, motion.values())));
    this.host.onPreview();
  }

  private rayAt(x: number, y: number): Ray {
    const { origin, direction } = this.view.ray(x, y);
    return new Ray(origin, direction);
  }

  // The world keeps its offset, for all pages.
  private isKept({ targets }: SensorExtras): boolean {
    return targets.some(({ event, field }) => event === 'offset' && field === 'offset');
  }

  // Whether all edits that come of an event were done.
  private async send(sensors: readonly SensorExtras[], event: string, value: EventValue): Promise<boolean> {
    const edits = sensors.flatMap((sensor) => editsOf(sensor, event, value));
    const outcomes = await Promise.all(edits.map((edit) => this.host.edit({ ...edit })));
    return outcomes.every(({ done }) => done);
  }
}
