import { Vector3 } from 'three';

// Where a walk begins that is to begin at `met`, what the middle of the picture shows: there, or, where that is the top of a table or
// of a car, on the ground before it, on the side of the eye. `below`: what is met straight below a place; null: nothing is.
const kSteps = 5;
const kStep_m = 0.8;

export async function walkStart(met: Vector3, eye: Vector3, step_m: number, below: (place: Vector3) => Promise<Vector3 | null>): Promise<Vector3> {
  const back = new Vector3(eye.x - met.x, 0, eye.z - met.z);
  if (back.lengthSq() === 0) return met;
  back.normalize();
  for (let i = 1; i <= kSteps; ++i) {
    const ground = await below(met.clone().addScaledVector(back, i * kStep_m));
    if (ground !== null && met.y - ground.y > step_m) return ground;
  }
  return met;
}
