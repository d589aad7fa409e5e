import { Quaternion, Vector3 } from 'three';

import type { SceneFile } from './scene_file';

// The outermost place of a node's shapes in a direction of the world, from the node's own place and by its orientation:
// the mean of the corners that lie farthest, so that a face has its middle.
const kAlike = 1e-3; // of the node's size: corners that far behind the farthest one lie on its face

export function supportPlace(file: Pick<SceneFile, 'shapes'>, node: number, turn: Quaternion, direction: Vector3): Vector3 {
  const corners = cornersOf(file, node, turn);
  let farthest = -Infinity;
  let size = 0;
  for (const corner of corners) {
    farthest = Math.max(farthest, corner.dot(direction));
    size = Math.max(size, corner.length());
  }
  const outermost = corners.filter((corner) => corner.dot(direction) >= farthest - kAlike * size);
  const sum = outermost.reduce((total, corner) => total.add(corner), new Vector3());
  return outermost.length > 0 ? sum.divideScalar(outermost.length) : sum;
}

function cornersOf(file: Pick<SceneFile, 'shapes'>, node: number, turn: Quaternion): Vector3[] {
  const corners: Vector3[] = [];
  for (const shape of file.shapes) {
    if (shape.node !== node) continue;
    const places = shape.geometry.getAttribute('position');
    for (let i = 0; i < places.count; ++i) {
      corners.push(new Vector3().fromBufferAttribute(places, i).applyMatrix4(shape.nodeFromShape).applyQuaternion(turn));
    }
  }
  return corners;
}
