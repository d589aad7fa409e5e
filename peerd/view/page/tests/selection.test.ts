import { describe, expect, it } from 'vitest';

import type { PeerLink } from '../src/live/peer_link';
import type { InspectorPanel } from '../src/panels/inspector_panel';
import type { SceneFile } from '../src/scene/scene_file';
import { Selection } from '../src/selection';

// A file of one house, which stands, and of some nodes that can move; its standing node comes behind them.
function fileOf(moving: readonly string[]): SceneFile {
  const byPath = new Map(moving.map((path, index) => [path, { index, path }]));
  return { byPath, standingNode: moving.length, standingPaths: ['HOUSE'] } as unknown as SceneFile;
}

function selection(): Selection {
  const link = { ask: () => Promise.resolve({ ok: true }) } as unknown as PeerLink;
  const inspector = new Proxy({}, { get: () => () => undefined }) as InspectorPanel;
  return new Selection(link, inspector);
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
});
