import { Box3, type Matrix4, PerspectiveCamera, Quaternion, Vector3, type Object3D } from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

import type { Viewpoint } from './scene_file';

// The camera: around a point (orbit), through the world (fly), or where an avatar's eye is (walk); and at the world's Viewpoints.
export type CameraMode = 'orbit' | 'fly' | 'walk';
const kTravel_s = 0.5; // from one viewpoint to the next
const kLookPerPixel_rad = 0.004;

export class CameraRig {
  readonly camera = new PerspectiveCamera(50, 1, 0.05, 5000);
  readonly orbit: OrbitControls;
  private mode_: CameraMode = 'orbit';
  private readonly held = new Set<string>();
  private travel: { from: Vector3; fromQ: Quaternion; to: Vector3; toQ: Quaternion; centre: Vector3; share: number } | null = null;
  private worldRadius_m = 10;
  private readonly worldCentre = new Vector3();
  private readonly step = new Vector3();

  constructor(surface: HTMLElement) {
    this.orbit = new OrbitControls(this.camera, surface);
    this.orbit.enableDamping = true;
    this.orbit.dampingFactor = 0.12;
    this.orbit.zoomToCursor = true;
    this.orbit.addEventListener('start', () => (this.travel = null));
    surface.addEventListener('pointermove', (event) => this.look(event));
  }

  get mode(): CameraMode {
    return this.mode_;
  }
  set mode(mode: CameraMode) {
    this.mode_ = mode;
    if (mode === 'orbit') this.aimAhead();
    this.orbit.enabled = mode === 'orbit';
  }

  // While a hand holds an object, dragging moves the object and not the camera.
  set frozen(frozen: boolean) {
    this.orbit.enabled = !frozen && this.mode_ === 'orbit';
  }

  // Whether the camera is on its way to a viewpoint.
  get travels(): boolean {
    return this.travel !== null;
  }

  resize(width: number, height: number): void {
    this.camera.aspect = width / Math.max(1, height);
    this.camera.updateProjectionMatrix();
  }

  // All of a world in the picture, from above and ahead.
  fit(box: Box3): void {
    if (box.isEmpty()) return;
    const centre = box.getCenter(new Vector3());
    this.worldRadius_m = Math.max(0.5, box.getSize(new Vector3()).length() / 2);
    this.worldCentre.copy(centre);
    const distance = (this.worldRadius_m * 1.05) / Math.tan((this.camera.fov * Math.PI) / 360);
    const eye = new Vector3(0.45, 0.5, 0.75).normalize().multiplyScalar(distance).add(centre);
    this.setRange();
    this.goTo(eye, lookRotation(eye, centre), centre);
  }

  measure(box: Box3): void {
    if (!box.isEmpty()) {
      this.worldRadius_m = Math.max(0.5, box.getSize(new Vector3()).length() / 2);
      box.getCenter(this.worldCentre);
    }
    this.setRange();
  }

  visit(viewpoint: Viewpoint): void {
    const eye = new Vector3(...viewpoint.position_m);
    const turn = new Quaternion(...viewpoint.orientation_xyzw);
    this.camera.fov = Math.min(120, Math.max(10, (viewpoint.field_of_view_rad * 180) / Math.PI));
    this.camera.updateProjectionMatrix();
    const distance = Math.max(2, Math.min(eye.length(), this.worldRadius_m));
    this.goTo(eye, turn, turningPoint(eye, turn, distance));
  }

  // Moves the camera and what it turns around by a rigid motion of the world.
  carry(motion: Matrix4): void {
    const turn = new Quaternion().setFromRotationMatrix(motion);
    this.camera.position.applyMatrix4(motion);
    this.camera.quaternion.premultiply(turn);
    this.orbit.target.applyMatrix4(motion);
    if (this.travel === null) return;
    this.travel.to.applyMatrix4(motion);
    this.travel.toQ.premultiply(turn);
    this.travel.centre.applyMatrix4(motion);
  }

  lookAt(point: Vector3, radius_m: number): void {
    const back = this.camera.position.clone().sub(point).normalize();
    const distance = Math.max(radius_m, 0.2) * 4;
    const eye = back.multiplyScalar(distance).add(point);
    this.goTo(eye, lookRotation(eye, point), point);
  }

  key(event: KeyboardEvent, down: boolean): boolean {
    if (!/^(Key[WASDQE]|Arrow(Up|Down|Left|Right)|PageUp|PageDown)$/.test(event.code)) return false;
    if (down) this.held.add(event.code);
    else this.held.delete(event.code);
    return true;
  }

  releaseKeys(): void {
    this.held.clear();
  }

  update(elapsed_s: number): void {
    if (this.travel !== null) this.continueTravel(elapsed_s);
    this.move(elapsed_s);
    if (this.mode_ === 'orbit' && this.travel === null) this.orbit.update(elapsed_s);
    this.camera.updateMatrixWorld();
    const near_m = nearPlane_m(this.camera.position.distanceTo(this.worldCentre), this.worldRadius_m);
    if (Math.abs(near_m - this.camera.near) > 0.1 * this.camera.near) this.setRange();
  }

  private setRange(): void {
    this.camera.near = nearPlane_m(this.camera.position.distanceTo(this.worldCentre), this.worldRadius_m);
    this.camera.far = this.worldRadius_m * 60;
    this.camera.updateProjectionMatrix();
  }

  private goTo(to: Vector3, toQ: Quaternion, centre: Vector3): void {
    const still = window.matchMedia('(prefers-reduced-motion: reduce)').matches;
    this.travel = { from: this.camera.position.clone(), fromQ: this.camera.quaternion.clone(), to, toQ, centre, share: still ? 1 : 0 };
  }

  private continueTravel(elapsed_s: number): void {
    const t = this.travel;
    if (t === null) return;
    t.share = Math.min(1, t.share + elapsed_s / kTravel_s);
    const smooth = t.share * t.share * (3 - 2 * t.share);
    this.camera.position.lerpVectors(t.from, t.to, smooth);
    this.camera.quaternion.slerpQuaternions(t.fromQ, t.toQ, smooth);
    if (t.share < 1) return;
    this.orbit.target.copy(t.centre);
    this.travel = null;
  }

  private aimAhead(): void {
    const ahead = new Vector3(0, 0, -1).applyQuaternion(this.camera.quaternion);
    this.orbit.target.copy(this.camera.position).addScaledVector(ahead, Math.max(1, this.worldRadius_m / 3));
  }

  private look(event: PointerEvent): void {
    if (this.mode_ === 'orbit' || (event.buttons & 1) === 0) return;
    this.travel = null;
    const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), -event.movementX * kLookPerPixel_rad);
    const nod = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), -event.movementY * kLookPerPixel_rad);
    this.camera.quaternion.premultiply(turn).multiply(nod);
  }

  // Where the held keys point to, in the camera's axes, at most 1 long.
  wish(to: Vector3): Vector3 {
    const has = (...codes: string[]): number => (codes.some((code) => this.held.has(code)) ? 1 : 0);
    to.set(
      has('KeyD', 'ArrowRight') - has('KeyA', 'ArrowLeft'),
      has('KeyE', 'PageUp') - has('KeyQ', 'PageDown'),
      has('KeyS', 'ArrowDown') - has('KeyW', 'ArrowUp'),
    );
    return to.clampLength(0, 1);
  }

  private move(elapsed_s: number): void {
    if (this.held.size === 0 || this.mode_ === 'walk') return;
    this.wish(this.step).applyQuaternion(this.camera.quaternion).multiplyScalar(this.worldRadius_m * 0.5 * elapsed_s);
    this.camera.position.add(this.step);
    this.orbit.target.add(this.step);
  }
}

// The nearest that is drawn. From far off the world begins far away, and depths between there and the camera would be wasted: a
// road two centimetres above the ground would flicker.
export function nearPlane_m(toCentre_m: number, worldRadius_m: number): number {
  return Math.max(0.01, worldRadius_m / 2000, 0.25 * (toCentre_m - worldRadius_m));
}

// The point that a camera turns around. One that looks straight down or up would lose which way its picture's upper edge
// lies, because it turns around the vertical: the point is moved so little that the edge stays where it is.
const kTilt = 1e-3;

export function turningPoint(eye: Vector3, turn: Quaternion, distance: number): Vector3 {
  const ahead = new Vector3(0, 0, -1).applyQuaternion(turn);
  const point = eye.clone().addScaledVector(ahead, distance);
  if (Math.hypot(ahead.x, ahead.z) > kTilt) return point;
  const edge = new Vector3(0, 1, 0).applyQuaternion(turn).setY(0).normalize();
  point.y = eye.y + Math.sign(ahead.y) * distance;
  point.x = eye.x;
  point.z = eye.z;
  return point.addScaledVector(edge, -Math.sign(ahead.y) * kTilt * distance);
}

function lookRotation(eye: Vector3, at: Vector3): Quaternion {
  const probe = new PerspectiveCamera();
  probe.position.copy(eye);
  probe.lookAt(at);
  return probe.quaternion.clone();
}

export function boundsOf(objects: readonly Object3D[]): Box3 {
  const box = new Box3();
  for (const object of objects) box.expandByObject(object);
  return box;
}
