import { expect, it } from 'vitest';

import { sentenceOf } from '../src/insight';
import { triangles } from '../src/scene/hierarchy_marks';

const kSquare = [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0];

it('a face of four corners is two triangles and four edges, in its volume’s colour', () => {
  const { corners, cornerColours, edges } = triangles([[kSquare], [kSquare]]);
  expect(corners.length).toBe(2 * 2 * 9);
  expect(edges.length).toBe(2 * 4 * 6);
  expect(cornerColours.slice(0, 3)).toEqual(cornerColours.slice(15, 18));
  expect(cornerColours.slice(0, 3)).not.toEqual(cornerColours.slice(18, 21));
});

it('says what is shown', () => {
  const reply = { path: 'A', level: 2, is_last: true, left_out: 0, triangles: 12, node: 0, position_m: [0, 0, 0], orientation_xyzw: [0, 0, 0, 1], volumes: [[kSquare]] } as const;
  expect(sentenceOf(reply)).toBe('level 2: 1 volume for 12 triangles; the last one');
  expect(sentenceOf({ ...reply, is_last: false, left_out: 3 })).toBe('level 2: 4 volumes, 3 not shown for 12 triangles');
});
