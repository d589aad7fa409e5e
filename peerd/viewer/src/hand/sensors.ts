import { Matrix4, Plane, Ray, Vector3 } from 'three';

import type { Outcome } from '../live/edits';
import type { SceneView } from '../scene/scene_view';
import { editsOf, planeTranslation, sensorsAround, type Place, type SensorExtras } from './sensor_rules';

// The pointer on the geometry of TouchSensors and PlaneSensors. It meets what is drawn, as the standard has it, and not what
// collides. A TouchSensor is pressed and released where the pointer has not been dragged, so that a drag stays the camera's; a
// PlaneSensor is dragged, and the world has its translation when it is let go.
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
  readonly sensor: SensorExtras;
  readonly plane: Plane; // in the world
  readonly sensorFromWorld: Matrix4;
  readonly begin: Place;
  readonly offset: Place;
  now: Place;
}

export class Sensors {
  private pressed: { sensors: readonly SensorExtras[]; x: number; y: number; active: boolean } | null = null;
  private drag: Drag | null = null;
  private readonly offsets = new Map<string, Place>(); // where one with autoOffset was let go that no edit can name

  constructor(private readonly surface: HTMLElement, private readonly view: SceneView, private readonly host: SensorHost) {
    // Before the camera and the tools, which do not see what a PlaneSensor takes.
    surface.addEventListener('pointerdown', (event) => this.onDown(event), { capture: true });
    surface.addEventListener('pointermove', (event) => this.onMove(event), { capture: true });
    surface.addEventListener('pointerup', (event) => this.onUp(event), { capture: true });
    surface.addEventListener('pointercancel', () => this.cancel(), { capture: true });
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
    const plane = sensors.find(({ type }) => type === 'PlaneSensor');
    const under = this.view.shapeUnder(event.clientX, event.clientY);
    if (plane !== undefined && under !== null) {
      this.beginDrag(plane, under.point);
      this.surface.setPointerCapture(event.pointerId);
      event.stopImmediatePropagation();
    }
    this.pressed = { sensors, x: event.clientX, y: event.clientY, active: true };
    this.send(sensors, 'isActive', true);
  }

  private onMove(event: PointerEvent): void {
    const { pressed, drag } = this;
    if (drag !== null) {
      event.stopImmediatePropagation();
      this.follow(drag, event.clientX, event.clientY);
    } else if (pressed?.active === true && Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > kClick_px) {
      pressed.active = false; // the camera turns
      this.send(pressed.sensors, 'isActive', false);
    }
  }

  private onUp(event: PointerEvent): void {
    const { pressed, drag } = this;
    this.pressed = this.drag = null;
    if (drag !== null) {
      event.stopImmediatePropagation();
      this.follow(drag, event.clientX, event.clientY);
      this.view.previewShift(drag.sensor.targets.map(({ path }) => path), null);
      const translation = this.translationOf(drag);
      if (drag.sensor.auto_offset !== false) this.offsets.set(keyOf(drag.sensor), translation);
      this.send([drag.sensor], 'translation_changed', translation);
    }
    if (pressed?.active !== true) return;
    this.send(pressed.sensors, 'isActive', false);
    const touched = pressed.sensors.filter(({ type }) => type === 'TouchSensor');
    const time_s = this.host.worldTime_s();
    const stays = this.sensorsUnder(event.clientX, event.clientY).some((sensor) => pressed.sensors.some(({ path }) => path === sensor.path));
    if (touched.length > 0 && stays && !Number.isNaN(time_s)) this.send(touched, 'touchTime', time_s);
  }

  private cancel(): void {
    if (this.pressed?.active === true) this.send(this.pressed.sensors, 'isActive', false);
    this.pressed = this.drag = null;
  }

  private beginDrag(sensor: SensorExtras, point: Vector3): void {
    const m = sensor.node_from_sensor;
    const world = new Matrix4().set(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], 0, 0, 0, 1);
    const { frames } = this.view;
    if (frames?.known[sensor.node] === 1) world.premultiply(frames.matrix(sensor.node, new Matrix4()));
    const sensorFromWorld = world.clone().invert();
    const normal = new Vector3(0, 0, 1).transformDirection(world);
    const begin = point.clone().applyMatrix4(sensorFromWorld).toArray();
    const offset = (this.isKept(sensor) ? undefined : this.offsets.get(keyOf(sensor))) ?? sensor.offset ?? [0, 0, 0];
    this.drag = { sensor, plane: new Plane().setFromNormalAndCoplanarPoint(normal, point), sensorFromWorld, begin, offset, now: begin };
  }

  private follow(drag: Drag, x: number, y: number): void {
    const { origin, direction } = this.view.ray(x, y);
    const at = new Ray(origin, direction).intersectPlane(drag.plane, new Vector3());
    if (at === null) return;
    drag.now = at.applyMatrix4(drag.sensorFromWorld).toArray();
    const to = this.translationOf(drag);
    const shift = new Vector3(to[0] - drag.offset[0], to[1] - drag.offset[1], to[2] - drag.offset[2]);
    const world = drag.sensorFromWorld.clone().invert();
    shift.applyMatrix4(world.setPosition(0, 0, 0));
    this.view.previewShift(drag.sensor.targets.map(({ path }) => path), shift);
    this.host.onPreview();
  }

  // The world keeps its offset, for all pages.
  private isKept({ targets }: SensorExtras): boolean {
    return targets.some(({ field }) => field === 'offset');
  }

  private translationOf({ begin, now, sensor, offset }: Drag): Place {
    return planeTranslation(begin, now, sensor, offset);
  }

  private send(sensors: readonly SensorExtras[], event: string, value: boolean | number | Place): void {
    for (const sensor of sensors) {
      for (const edit of editsOf(sensor, event, value)) void this.host.edit({ ...edit });
    }
  }
}

function keyOf({ path, targets }: SensorExtras): string {
  return `${path} ${targets.map((target) => target.path).join(' ')}`;
}
