import { Plane, Ray, Vector3 } from 'three';

// The plane parallel to the picture in which a held object follows the pointer, and the object's place in it.
export class DragPlane {
  private readonly plane = new Plane();
  private readonly offset: Vector3; // from where the hand holds the object to the object's own place

  constructor(grip: Vector3, place: Vector3, ahead: Vector3) {
    this.plane.setFromNormalAndCoplanarPoint(ahead, grip);
    this.offset = place.clone().sub(grip);
  }

  // Where the object is to be for a pointer on that ray; null where the ray runs away from the plane.
  placeOn(origin: Vector3, direction: Vector3): Vector3 | null {
    const grip = new Ray(origin, direction).intersectPlane(this.plane, new Vector3());
    return grip === null ? null : grip.add(this.offset);
  }

  push(ahead: Vector3, distance_m: number): void {
    this.plane.constant -= this.plane.normal.dot(ahead) * distance_m;
  }
}
