import { Vector3 } from 'three';
import type { Outcome } from 'peerd';

import type { RigidFrames } from '../scene/rigid_frames';
import { worldFromSensor } from './sensor_frames';
import { editsOf, keyOf, type EventValue, type SensorExtras } from './sensor_rules';

// The page's viewer in the boxes of the world's ProximitySensors (ISO/IEC 14772-1, 6.38): the camera, which is an avatar's eye while one
// walks. One that the file uses in several places has as its box all of its boxes. It is known again in the next scene, so that
// nobody enters it twice.
export class Proximity {
  private all: readonly SensorExtras[] | null = null;
  private boxes: readonly (readonly SensorExtras[])[] = []; // of each sensor
  private inside: ReadonlySet<string> = new Set();

  constructor(private readonly edit: (request: Record<string, unknown>) => Promise<Outcome>) {}

  update(eye: Vector3, worldTime_s: number, sensors: readonly SensorExtras[], frames: RigidFrames | null): void {
    if (sensors !== this.all) {
      this.all = sensors;
      this.boxes = boxesOf(sensors);
    }
    if (this.boxes.length === 0 && this.inside.size === 0) return;
    const inside = new Set<string>();
    for (const boxes of this.boxes) {
      const key = keyOf(boxes[0]);
      const isInside = boxes.some((box) => isIn(box, eye, frames));
      if (isInside) inside.add(key);
      if (isInside === this.inside.has(key)) continue;
      this.send(boxes[0], 'isActive', isInside);
      this.send(boxes[0], isInside ? 'enterTime' : 'exitTime', worldTime_s);
    }
    this.inside = inside;
  }

  private send(sensor: SensorExtras, event: string, value: EventValue): void {
    for (const edit of editsOf(sensor, event, value)) void this.edit({ ...edit });
  }
}

function boxesOf(sensors: readonly SensorExtras[]): SensorExtras[][] {
  const boxes = new Map<number | undefined, SensorExtras[]>();
  for (const sensor of sensors) if (sensor.type === 'ProximitySensor') boxes.set(sensor.number, [...(boxes.get(sensor.number) ?? []), sensor]);
  return [...boxes.values()];
}

// A box without volume has nobody in it.
function isIn(sensor: SensorExtras, eye: Vector3, frames: RigidFrames | null): boolean {
  const { center = [0, 0, 0], size = [0, 0, 0] } = sensor;
  const world = worldFromSensor(sensor, frames);
  if (world.determinant() === 0) return false;
  const at = eye.clone().applyMatrix4(world.invert()).toArray();
  return at.every((value, axis) => Math.abs(value - center[axis]) < size[axis] / 2);
}
