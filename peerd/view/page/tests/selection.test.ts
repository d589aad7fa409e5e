import { describe, expect, it } from 'vitest';

import type { PeerLink } from '../src/live/peer_link';
import type { InspectorPanel } from '../src/panels/inspector_panel';
import type { SceneFile } from '../src/scene/scene_file';
import { Selection } from '../src/selection';
import { treeOf } from './trees';

// A file of one house with a Shape, which stands, and of some nodes that can move; its standing node comes behind them.
function fileOf(moving: readonly string[]): SceneFile {
  const byPath = new Map(moving.map((path, index) => [path, { index, path }]));
  const tree = treeOf(['HOUSE', 'HOUSE/0', ...moving, ...moving.map((path) => `${path}/0`)].sort());
  return { byPath, standingNode: moving.length, tree } as unknown as SceneFile;
}

function selection(asked: Record<string, unknown>[] = []): Selection {
  const ask = (request: Record<string, unknown>): Promise<{ ok: boolean }> => {
    asked.push(request);
    return Promise.resolve({ ok: true });
  };
  const inspector = new Proxy({}, { get: () => () => undefined }) as InspectorPanel;
  return new Selection({ ask } as unknown as PeerLink, inspector);
}

describe('a selection', () => {
  it('of what stands has no poses, whatever moves in the next scene by that number', () => {
    const selected = selection();
    selected.choose(1, 'HOUSE', false);
    expect(selected.movingNode).toBeNull();
    selected.follow(fileOf(['BALL', 'AVATAR'])); // whose number the house had
    expect(selected.path).toBe('HOUSE');
    expect(selected.movingNode).toBeNull();
    expect(selected.node).toBe(2);
  });

  it('of what moves has the number that it has in the scene', () => {
    const selected = selection();
    selected.choose(0, 'BALL', true);
    selected.follow(fileOf(['AVATAR', 'BALL']));
    expect(selected.movingNode).toBe(1);
  });

  it('of what stands, or goes with something, is asked for by its path', () => {
    const asked: Record<string, unknown>[] = [];
    selection(asked).choose(1, 'HOUSE/0', false);
    selection(asked).choose(0, 'BALL', true);
    expect(asked).toEqual([{ do: 'inspect', path: 'HOUSE/0' }, { do: 'inspect', node: 0 }]);
  });

  it('of a part goes with what moves around it', () => {
    const selected = selection();
    selected.choose(0, 'BALL/0', false);
    selected.follow(fileOf(['AVATAR', 'BALL']));
    expect([selected.path, selected.node, selected.movingNode]).toEqual(['BALL/0', 1, null]);
  });

  it('ends where its node is gone', () => {
    const selected = selection();
    selected.choose(0, 'BALL', true);
    selected.follow(fileOf([]));
    expect(selected.path).toBeNull();
  });
});
