// The rules of VRML's sensors that a page works (ISO/IEC 14772-1, 4.6.7, 6.34, 6.38 and 6.51) and that need no page. What a sensor
// does to the world goes to the daemon as edits, so that all peers have it from one instant on.
export interface SensorTarget {
  readonly event: string; // the sensor's eventOut
  readonly path: string; // of the node, or its DEF name
  readonly field: string;
}

// What a target draws elsewhere while the sensor is dragged.
export interface PreviewExtras {
  readonly target: number; // into the sensor's targets
  readonly path: string; // what is at it and below it moves
  readonly node: number; // of the file: it moves with that one
  readonly node_from_frame: readonly number[]; // three rows of four; about what it turns is at the frame's origin
  readonly from: readonly number[]; // the field's value now: a translation, or a rotation
}

export interface SensorExtras {
  readonly type: 'TouchSensor' | 'PlaneSensor' | 'CylinderSensor' | 'SphereSensor' | 'ProximitySensor';
  readonly path: string; // of the node that it stands in; empty: the top level
  readonly number?: number; // of the node itself: one that the file uses in several places has one number
  readonly node: number; // of the file: it moves with that one
  readonly node_from_sensor: readonly number[]; // three rows of four
  readonly targets: readonly SensorTarget[];
  readonly previews?: readonly PreviewExtras[];
  readonly min?: readonly number[]; // of a PlaneSensor two numbers, of a CylinderSensor one
  readonly max?: readonly number[];
  readonly disk_angle_rad?: readonly number[];
  readonly offset?: readonly number[]; // a translation, an angle, or a rotation
  readonly auto_offset?: boolean;
  readonly center?: readonly number[];
  readonly size?: readonly number[];
}

export type EventValue = boolean | number | readonly number[];

// Those that a pointer on the geometry at `path` works: of all around it the ones that stand lowest.
export function sensorsAround(path: string, sensors: readonly SensorExtras[]): readonly SensorExtras[] {
  const around = sensors.filter((sensor) => sensor.type !== 'ProximitySensor' && (sensor.path === '' || path === sensor.path || path.startsWith(`${sensor.path}/`)));
  const lowest = Math.max(-1, ...around.map((sensor) => sensor.path.length));
  return around.filter((sensor) => sensor.path.length === lowest);
}

export function isDragged({ type }: SensorExtras): boolean {
  return type === 'PlaneSensor' || type === 'CylinderSensor' || type === 'SphereSensor';
}

// A value within bounds, which count where the lower one is not above the upper one.
export function clamped(value: number, min: number, max: number): number {
  return min <= max ? Math.min(max, Math.max(min, value)) : value;
}

export interface FieldEdit {
  readonly do: 'set';
  readonly path: string;
  readonly field: string;
  readonly value: string;
}

// The edits by which an event reaches all that ROUTEs lead to from it.
export function editsOf(sensor: SensorExtras, event: string, value: EventValue): readonly FieldEdit[] {
  const text = typeof value === 'boolean' ? (value ? 'TRUE' : 'FALSE') : typeof value === 'number' ? String(value) : value.map((part) => String(Math.fround(part))).join(' ');
  return sensor.targets.filter((target) => target.event === event).map(({ path, field }) => ({ do: 'set', path, field, value: text }));
}

// By which a sensor is known again in the next scene.
export function keyOf({ path, targets }: SensorExtras): string {
  return `${path} ${targets.map((target) => `${target.event} ${target.path}`).join(' ')}`;
}
