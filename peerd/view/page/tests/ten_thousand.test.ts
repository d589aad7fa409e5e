import { BoxGeometry, Frustum, Matrix4, MeshBasicMaterial, PerspectiveCamera } from 'three';
import { expect, it } from 'vitest';
import { PoseBook } from 'peerd';

import { MovingScene } from '../src/scene/moving_scene';
import { OwnerColours } from '../src/scene/owner_colours';
import { RigidFrames } from '../src/scene/rigid_frames';
import type { SceneNode } from '../src/scene/scene_file';
import { PoseHistory } from '../src/time/pose_history';
import { frame } from './frames';

// 10,000 moving objects of one geometry and material, 100 by 100 m: they are one draw call, those outside of the picture are
// not drawn, and what our own code costs for a frame that comes and for a picture is printed.
const kCount = 10000;
const kFrames = 40;

function looking(x: number, z: number): Frustum {
  const camera = new PerspectiveCamera(50, 1.5, 0.1, 1000);
  camera.position.set(50, 80, 150);
  camera.lookAt(x, 0, z);
  camera.updateMatrixWorld();
  return new Frustum().setFromProjectionMatrix(new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
}

// A quarter of the values is below it. On a busy computer the upper half measures who else wants the processor.
function lowerQuartile(values: number[]): number {
  return [...values].sort((a, b) => a - b)[values.length >> 2];
}

it('ten thousand objects', () => {
  const nodes: SceneNode[] = Array.from({ length: kCount }, (_, index) => ({ index, id: `${index}`, path: `N${index}`, def: '', owner: 1, pose: new Float64Array(7) }));
  const geometry = new BoxGeometry();
  const material = new MeshBasicMaterial();
  const moving = new MovingScene(nodes.map(({ index }) => ({ node: index, geometry, material, nodeFromShape: new Matrix4() })));
  const [frames, colours, book, history] = [new RigidFrames(kCount), new OwnerColours(kCount), new PoseBook(kCount), new PoseHistory()];
  const [taking_ms, placing_ms]: [number[], number[]] = [[], []];
  const picture = (time_s: number, frustum: Frustum): number => {
    frames.update(nodes, book.shown, time_s);
    colours.update(nodes, book.shown, 'world', null);
    return moving.update(frames, frustum, colours.rgb);
  };
  const all = looking(50, 50);
  let drawn = 0;
  for (let k = 0; k < kFrames; ++k) {
    const came = frame(k * 0.05, 1, nodes.map(({ index }) => ({ node: index, position: [(index % 100) + Math.sin(k / 10), 0, index / 100] as const })));
    const began = performance.now();
    history.add(came, k * 0.05);
    book.take(came, k * 0.05, (k - 1) * 0.05);
    const taken = performance.now();
    drawn += picture(k * 0.05 - 0.03, all);
    taking_ms.push(taken - began);
    placing_ms.push(performance.now() - taken);
  }
  const aside = picture(2, looking(110, 90));
  expect(drawn).toBe(kFrames * kCount);
  expect(moving.batches.length).toBe(1);
  expect(aside).toBeGreaterThan(0);
  expect(aside).toBeLessThan(0.8 * kCount);
  expect(picture(2, looking(50, 400))).toBe(0);
  console.log(`10,000 objects, lower quartiles: ${lowerQuartile(taking_ms).toFixed(2)} ms for a frame that comes, ${lowerQuartile(placing_ms).toFixed(2)} ms for a picture; ${aside} drawn where the camera looks aside`);
});
