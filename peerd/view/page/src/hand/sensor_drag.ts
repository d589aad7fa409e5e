import { Plane, Quaternion, Vector3, type Ray } from 'three';

import { clamped, type SensorExtras } from './sensor_rules';

// What a drag says by the pointer's ray in the sensor's own frame, of the instant at which the drag began (ISO/IEC 14772-1,
// 6.15, 6.34 and 6.44). A ray that misses the cylinder or the sphere counts where it comes nearest to it.
export interface SensorDrag {
  follow(ray: Ray): void;
  values(): Readonly<Record<string, readonly number[]>>; // of the events, by name; "offset": what the next drag begins with
}

export type Rotation = readonly [number, number, number, number]; // VRML's: an axis and an angle [rad]

export function dragOf(sensor: SensorExtras, begin: Vector3, ray: Ray, offset: readonly number[]): SensorDrag {
  if (sensor.type === 'CylinderSensor') return new CylinderDrag(sensor, begin, ray, offset);
  if (sensor.type === 'SphereSensor') return new SphereDrag(begin, ray, offset);
  return new PlaneDrag(sensor, begin, offset);
}

export function turnOf([x, y, z, angle]: readonly number[]): Quaternion {
  const axis = new Vector3(x, y, z);
  return axis.lengthSq() > 0 ? new Quaternion().setFromAxisAngle(axis.normalize(), angle) : new Quaternion();
}

export function rotationOf(turn: Quaternion): Rotation {
  const { x, y, z, w } = turn;
  const sine = Math.hypot(x, y, z);
  return sine > 0 ? [x / sine, y / sine, z / sine, 2 * Math.atan2(sine, w)] : [0, 1, 0, 0];
}

// On the plane z = z of where the drag began.
class PlaneDrag implements SensorDrag {
  private readonly plane: Plane;
  private readonly now: Vector3;

  constructor(private readonly sensor: Pick<SensorExtras, 'min' | 'max'>, private readonly begin: Vector3, private readonly offset: readonly number[]) {
    this.plane = new Plane(new Vector3(0, 0, 1), -begin.z);
    this.now = begin.clone();
  }

  follow(ray: Ray): void {
    ray.intersectPlane(this.plane, this.now);
  }

  values(): Readonly<Record<string, readonly number[]>> {
    const { min = [0, 0], max = [-1, -1] } = this.sensor;
    const gone = this.now.clone().sub(this.begin);
    const translation = [clamped(gone.x + this.offset[0], min[0], max[0]), clamped(gone.y + this.offset[1], min[1], max[1]), this.offset[2]];
    return { translation_changed: translation, trackPoint_changed: this.now.toArray(), offset: translation };
  }
}

// Around the y-axis: on a disk where one looks along the axis, and else on a cylinder.
class CylinderDrag implements SensorDrag {
  private readonly surface: Plane | RoundSurface;
  private readonly now: Vector3;
  private angle_rad: number;
  private turned_rad = 0; // more than once around counts

  constructor(private readonly sensor: Pick<SensorExtras, 'min' | 'max' | 'disk_angle_rad'>, begin: Vector3, ray: Ray, private readonly offset: readonly number[]) {
    const toAxis_rad = Math.acos(Math.min(1, Math.abs(ray.direction.y) / ray.direction.length()));
    const isDisk = toAxis_rad < (sensor.disk_angle_rad?.[0] ?? 0.262);
    this.surface = isDisk ? new Plane(new Vector3(0, 1, 0), -begin.y) : new RoundSurface(begin, ray, 0);
    this.now = begin.clone();
    this.angle_rad = Math.atan2(begin.x, begin.z);
  }

  follow(ray: Ray): void {
    const at = this.surface instanceof Plane ? ray.intersectPlane(this.surface, new Vector3()) : this.surface.meet(ray);
    if (at === null || Math.hypot(at.x, at.z) === 0) return; // nothing says which way that lies
    const angle_rad = Math.atan2(at.x, at.z);
    const step_rad = angle_rad - this.angle_rad;
    this.turned_rad += step_rad - 2 * Math.PI * Math.round(step_rad / (2 * Math.PI));
    this.angle_rad = angle_rad;
    this.now.copy(at);
  }

  values(): Readonly<Record<string, readonly number[]>> {
    const angle_rad = clamped(this.turned_rad + this.offset[0], this.sensor.min?.[0] ?? 0, this.sensor.max?.[0] ?? -1);
    return { rotation_changed: [0, 1, 0, angle_rad], trackPoint_changed: this.now.toArray(), offset: [angle_rad] };
  }
}

class SphereDrag implements SensorDrag {
  private readonly surface: RoundSurface;
  private readonly now: Vector3;

  constructor(private readonly begin: Vector3, ray: Ray, private readonly offset: readonly number[]) {
    this.surface = new RoundSurface(begin, ray, 1);
    this.now = begin.clone();
  }

  follow(ray: Ray): void {
    const at = this.surface.meet(ray);
    if (at !== null) this.now.copy(at);
  }

  values(): Readonly<Record<string, readonly number[]>> {
    const turn = turnOf(this.offset);
    if (this.begin.length() > 0) turn.premultiply(new Quaternion().setFromUnitVectors(this.begin.clone().normalize(), this.now.clone().normalize()));
    const rotation = rotationOf(turn);
    return { rotation_changed: rotation, trackPoint_changed: this.now.toArray(), offset: rotation };
  }
}

// The cylinder about the y-axis, or the sphere about the origin, through a point that a ray meets.
class RoundSurface {
  private readonly radius_m: number;
  private readonly isFar: boolean; // the ray meets the point where it leaves the surface

  // `up`: 0 for a cylinder, 1 for a sphere.
  constructor(begin: Vector3, ray: Ray, private readonly up: 0 | 1) {
    this.radius_m = Math.hypot(begin.x, up * begin.y, begin.z);
    const { origin: o, direction: d } = ray;
    this.isFar = d.x * (begin.x - o.x) + up * d.y * (begin.y - o.y) + d.z * (begin.z - o.z) > -this.alongAxis(ray);
  }

  meet(ray: Ray): Vector3 | null {
    const { origin: o, direction: d } = ray;
    const speed = d.x * d.x + this.up * d.y * d.y + d.z * d.z;
    if (!(speed > 0)) return null;
    const nearest = -this.alongAxis(ray) / speed;
    const place = o.clone().addScaledVector(d, nearest);
    const distance_m = Math.hypot(place.x, this.up * place.y, place.z);
    if (distance_m > this.radius_m) return nearest > 0 ? this.drawnIn(place, this.radius_m / distance_m) : null;
    const half = Math.sqrt((this.radius_m * this.radius_m - distance_m * distance_m) / speed);
    const t = this.isFar || nearest - half < 0 ? nearest + half : nearest - half;
    return t > 0 ? o.clone().addScaledVector(d, t) : null;
  }

  // How fast the ray goes away from the axis, or the centre, at its origin.
  private alongAxis({ origin: o, direction: d }: Ray): number {
    return d.x * o.x + this.up * d.y * o.y + d.z * o.z;
  }

  private drawnIn(place: Vector3, share: number): Vector3 {
    return place.set(place.x * share, this.up === 1 ? place.y * share : place.y, place.z * share);
  }
}
