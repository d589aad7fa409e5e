import { Matrix4, Vector3 } from 'three';

import type { Preview } from '../scene/instance_batch';
import type { RigidFrames } from '../scene/rigid_frames';
import { turnOf } from './sensor_drag';
import type { PreviewExtras, SensorExtras } from './sensor_rules';

// Where a sensor is in the world now; before any pose of its node has come, where the file has it in the node.
export function worldFromSensor({ node, node_from_sensor }: Pick<SensorExtras, 'node' | 'node_from_sensor'>, frames: RigidFrames | null): Matrix4 {
  const world = matrixOf(node_from_sensor);
  return frames?.known[node] === 1 ? world.premultiply(frames.matrix(node, new Matrix4())) : world;
}

// Where a sensor's targets are to be drawn for values of its events.
export function previewsOf({ targets, previews }: Pick<SensorExtras, 'targets' | 'previews'>, values: Readonly<Record<string, readonly number[]>>): readonly Preview[] {
  return (previews ?? []).flatMap((preview) => {
    const to = values[targets[preview.target].event];
    return to?.length === preview.from.length ? [{ path: preview.path, node: preview.node, motion: motionTo(to, preview) }] : [];
  });
}

function motionTo(to: readonly number[], { from, node_from_frame }: PreviewExtras): Matrix4 {
  const frame = matrixOf(node_from_frame);
  if (frame.determinant() === 0) return new Matrix4(); // it is flat: nothing of it is seen
  const motion =
    to.length === 4
      ? new Matrix4().makeRotationFromQuaternion(turnOf(to).multiply(turnOf(from).invert()))
      : new Matrix4().makeTranslation(new Vector3(to[0] - from[0], to[1] - from[1], to[2] - from[2]));
  return motion.premultiply(frame).multiply(frame.clone().invert());
}

function matrixOf(rows: readonly number[]): Matrix4 {
  const [a, b, c, d, e, f, g, h, i, j, k, l] = rows;
  return new Matrix4().set(a, b, c, d, e, f, g, h, i, j, k, l, 0, 0, 0, 1);
}
