import { expect, it } from 'vitest';

import { anchorAround, anchorTarget } from '../src/page/anchor_offer';
import type { Viewpoint } from '../src/scene/scene_file';
import type { GroupExtras } from '../src/scene/view_groups';

const kDoor: Viewpoint = { def: 'DOOR', description: 'The door', position_m: [0, 0, 0], orientation_xyzw: [0, 0, 0, 1], field_of_view_rad: 0.8 };

it.each([
  ['a viewpoint of the world', ['#DOOR'], 'viewpoint'],
  ['the first that can be followed', ['other.wrl', '#NONE', 'https://example.org/'], 'link'],
  ['a file beside the world', ['other.wrl'], 'none'],
  ['a script', ['javascript:alert(1)'], 'none'],
  ['nothing', [], 'none'],
] as const)('%s', (_name, urls, kind) => expect(anchorTarget(urls, [kDoor]).kind).toBe(kind));

it('the innermost Anchor counts, and no neighbour of a like name', () => {
  const anchor = (path: string): GroupExtras => ({ kind: 'anchor', path, node: 0, node_from_group: [] });
  const groups = [anchor('A'), anchor('A/B'), { ...anchor('A/B/C'), kind: 'billboard' as const }];
  expect(anchorAround('A/B/C/0', groups)?.path).toBe('A/B');
  expect(anchorAround('A/BB/0', groups)?.path).toBe('A');
  expect(anchorAround('AB/0', groups)).toBeNull();
});
