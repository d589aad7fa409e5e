import { Object3D } from 'three';
import { describe, expect, it } from 'vitest';
import { PoseKind } from 'peerd';

import type { SceneFile, SceneNode } from '../src/scene/scene_file';
import type { Frames, KeptFrame } from '../src/time/frames';
import { Playhead } from '../src/time/playhead';
import { NodeTree } from '../src/scene/node_tree';
import { frame } from './frames';

// A scene whose nodes stand at x = 100, so that what no frame has moved is seen.
function sceneOf(revision: number, ids: Record<number, string>): SceneFile {
  const nodes: SceneNode[] = Object.entries(ids).map(([index, id]) => ({ index: Number(index), id, path: id, def: id, owner: 0, pose: new Float64Array([100, 0, 0, 0, 0, 0, 1]) }));
  const byPath = new Map(nodes.map((node) => [node.path, node]));
  return { revision, extras: {}, nodeCount: 10, nodes, byPath, tree: new NodeTree(), standingNode: -1, shapes: [], carried: [], hasLights: false, standing: new Object3D() };
}

function xOf(head: Playhead, node: number, now_s: number): number {
  const pose = new Float64Array(7);
  return head.book.shown.sample(node, head.shownAt(now_s), pose) ? pose[0] : NaN;
}

// Node 0 moves by 1 m a second; the page's clock is 500 s behind the session's.
function running(seconds: number): Playhead {
  const head = new Playhead(10);
  head.show(sceneOf(1, { 0: 'a', 2: 'b' }));
  for (let i = 0; i <= seconds * 10; ++i) head.onFrame(frame(500 + i / 10, 1, [{ node: 0, position: [i / 10, 0, 0] }]), i / 10);
  return head;
}

describe('the playhead', () => {
  it('shows now, a little late, and what no frame has as the scene has it', () => {
    const head = running(10);
    expect(head.state).toBe('live');
    expect(xOf(head, 0, 10)).toBeGreaterThan(9.7);
    expect(xOf(head, 0, 10)).toBeLessThan(10);
    expect(xOf(head, 2, 10)).toBe(100);
  });

  it('goes back, stands, plays on, and is live again at the end', () => {
    const head = running(10);
    head.pauseAt(503.25);
    expect(xOf(head, 0, 10)).toBeCloseTo(3.25, 6);
    head.advance(0.1);
    expect(xOf(head, 0, 10)).toBeCloseTo(3.25, 6);
    head.onFrame(frame(510.1, 1, [{ node: 0, position: [10.1, 0, 0] }]), 10.1);
    head.advance(0.1);
    expect(xOf(head, 0, 10.1)).toBeCloseTo(3.25, 6);
    head.play();
    head.advance(1);
    expect(xOf(head, 0, 11.1)).toBeCloseTo(4.25, 6);
    head.advance(20);
    expect(head.state).toBe('live');
    expect(xOf(head, 0, 10.2)).toBeGreaterThan(9.9);
  });

  it('does not leave what it has kept', () => {
    const head = running(5);
    head.pauseAt(0);
    head.advance(0.1);
    expect(head.shownAt(5)).toBe(500);
    head.pauseAt(1e9);
    head.advance(0.1);
    expect(xOf(head, 0, 5)).toBe(5);
  });

  it('keeps the past of what an edit has left, and shows nothing of what was not there', () => {
    const head = running(4);
    head.show(sceneOf(2, { 1: 'new', 3: 'a', 5: 'b' }));
    head.onFrame(frame(504.5, 2, [{ node: 3, position: [4.5, 0, 0] }, { node: 1, position: [7, 0, 0] }]), 4.5);
    head.pauseAt(502);
    head.advance(0.1);
    expect(xOf(head, 3, 4.5)).toBeCloseTo(2, 6);
    expect(xOf(head, 5, 4.5)).toBe(100);
    expect(xOf(head, 1, 4.5)).toBeNaN();
    head.goLive();
    expect(xOf(head, 1, 4.6)).toBe(7);
  });

  it('keeps frames that come before their scene', () => {
    const head = new Playhead(10);
    head.onFrame(frame(500, 4, [{ node: 0, position: [1, 0, 0] }]), 0);
    head.onFrame(frame(500.1, 4, [{ node: 1, position: [2, 0, 0] }]), 0.1);
    head.show(sceneOf(4, { 0: 'a', 1: 'b' }));
    expect([xOf(head, 0, 1), xOf(head, 1, 1)]).toEqual([1, 2]);
  });
});

describe('the playhead of a recording', () => {
  const recording = (frames: readonly KeptFrame[], ready = true): Frames => ({ begin_s: 0, end_s: 2, empty: false, grows: false, ready: () => ready, want: () => undefined, framesFor: () => frames });
  const frames = Array.from({ length: 21 }, (_, i) => ({ time_s: i / 10, frame: frame(i / 10, 1, [{ node: 0, position: [i / 10, 0, 0] }]) }));

  it('stands at the begin, plays at its rate, stops at the end, and begins again', () => {
    const head = new Playhead(10);
    head.showRecorded(recording(frames));
    head.show(sceneOf(1, { 0: 'a' }));
    head.advance(1);
    expect(head.state).toBe('paused');
    expect(xOf(head, 0, 0)).toBe(0);
    head.rate = 0.5;
    head.play();
    head.advance(1);
    expect(xOf(head, 0, 0)).toBeCloseTo(0.5, 6);
    head.advance(0.02);
    expect(xOf(head, 0, 0)).toBeCloseTo(0.51, 6);
    head.pauseAt(0.25);
    head.advance(0);
    expect(xOf(head, 0, 0)).toBeCloseTo(0.25, 6);
    head.play();
    head.advance(10);
    expect(head.state).toBe('paused');
    expect(xOf(head, 0, 0)).toBeCloseTo(2, 6);
    head.play();
    expect(head.shownAt(0)).toBe(0);
    head.goLive();
    expect(head.state).toBe('playing');
  });

  it('stands while its frames are on their way', () => {
    const head = new Playhead(10);
    head.showRecorded(recording([], false));
    head.show(sceneOf(1, { 0: 'a' }));
    head.play();
    head.advance(1);
    expect(head.shownAt(0)).toBe(0);
  });

  it('goes on at its instant in another view, whose scenes are others', () => {
    const head = new Playhead(10);
    head.showRecorded(recording(frames));
    head.show(sceneOf(1, { 0: 'a' }));
    head.pauseAt(1);
    head.showRecorded(recording(frames));
    expect(head.shownAt(0)).toBe(1);
    head.show(sceneOf(1, { 0: 'b' }));
    head.advance(0);
    expect(xOf(head, 0, 0)).toBeCloseTo(1, 6);
  });

  it('forgets a truth that is not known any more', () => {
    const head = new Playhead(10);
    const truth = [1, 0].map((owner, i) => ({ time_s: i, frame: frame(i, 1, [{ node: 0, owner, kind: PoseKind.truth, position: [5, 0, 0] }]) }));
    head.showRecorded(recording(truth));
    head.show(sceneOf(1, { 0: 'a' }));
    head.pauseAt(0);
    expect(head.book.truth.knows(0)).toBe(false); // the frame after the instant is in the book, too
    head.showRecorded(recording(truth.slice(0, 1)));
    head.show(sceneOf(1, { 0: 'a' }));
    head.advance(0);
    expect(head.book.truth.knows(0)).toBe(true);
  });
});
