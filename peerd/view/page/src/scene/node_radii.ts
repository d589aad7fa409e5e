import { Sphere } from 'three';

import type { SceneFile } from './scene_file';

// How far each moving node's shapes reach from the node's own place [m]; a node without shapes has a small one, so that a
// camera can look at it.
const kWithoutShapes_m = 0.1;

export function nodeRadii(file: Pick<SceneFile, 'nodeCount' | 'shapes'>): Float64Array {
  const radii_m = new Float64Array(file.nodeCount).fill(kWithoutShapes_m);
  const sphere = new Sphere();
  for (const { node, geometry, nodeFromShape } of file.shapes) {
    if (geometry.boundingSphere === null) geometry.computeBoundingSphere();
    if (geometry.boundingSphere === null) continue;
    sphere.copy(geometry.boundingSphere).applyMatrix4(nodeFromShape);
    radii_m[node] = Math.max(radii_m[node], sphere.center.length() + sphere.radius);
  }
  return radii_m;
}
