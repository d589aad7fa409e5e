// The rules of VRML's pointing-device sensors (ISO/IEC 14772-1, 4.6.7, 6.34 and 6.52) that need no page. What a sensor does to
// the world goes to the daemon as edits, so that all peers have it from one instant on.
export interface SensorTarget {
  readonly event: string; // the sensor's eventOut
  readonly path: string; // of the node, or its DEF name
  readonly field: string;
}

export interface SensorExtras {
  readonly type: 'TouchSensor' | 'PlaneSensor';
  readonly path: string; // of the node that it stands in; empty: the top level
  readonly node: number; // of the file: it moves with that one
  readonly node_from_sensor: readonly number[]; // three rows of four
  readonly targets: readonly SensorTarget[];
  readonly min?: readonly [number, number];
  readonly max?: readonly [number, number];
  readonly offset?: readonly [number, number, number];
  readonly auto_offset?: boolean;
  readonly description?: string;
}

export type Place = readonly [number, number, number];

// Those that a pointer on the geometry at `path` works: of all around it the ones that stand lowest.
export function sensorsAround(path: string, sensors: readonly SensorExtras[]): readonly SensorExtras[] {
  const around = sensors.filter((sensor) => sensor.path === '' || path === sensor.path || path.startsWith(`${sensor.path}/`));
  const lowest = Math.max(-1, ...around.map((sensor) => sensor.path.length));
  return around.filter((sensor) => sensor.path.length === lowest);
}

// translation_changed: how far the pointer has gone on the plane z = z of where it began, with the offset, within the bounds. A
// bound counts on an axis where its minimum is not above its maximum.
export function planeTranslation(begin: Place, now: Place, { min = [0, 0], max = [-1, -1] }: Pick<SensorExtras, 'min' | 'max'>, offset: Place): Place {
  const along = (axis: 0 | 1): number => {
    const value = now[axis] - begin[axis] + offset[axis];
    return min[axis] <= max[axis] ? Math.min(max[axis], Math.max(min[axis], value)) : value;
  };
  return [along(0), along(1), offset[2]];
}

export interface FieldEdit {
  readonly do: 'set';
  readonly path: string;
  readonly field: string;
  readonly value: string;
}

// The edits by which an event reaches all that ROUTEs lead to from it.
export function editsOf(sensor: SensorExtras, event: string, value: boolean | number | Place): readonly FieldEdit[] {
  const text = typeof value === 'boolean' ? (value ? 'TRUE' : 'FALSE') : typeof value === 'number' ? String(value) : value.map((part) => String(Math.fround(part))).join(' ');
  return sensor.targets.filter((target) => target.event === event).map(({ path, field }) => ({ do: 'set', path, field, value: text }));
}
