import { expect, it } from 'vitest';

import { colourAt } from '../src/scene/backdrop';

// ISO/IEC 14772-1, 6.5: the first colour at angle 0, the others at their angles, the last one from there on.
it.each([
  [0, [0, 0, 0]],
  [0.5, [0.5, 0, 0]],
  [1, [1, 0, 0]],
  [1.25, [1, 0.5, 0]],
  [3, [1, 1, 0]],
])('the sky at %d rad', (angle, expected) => {
  const colours = [[0, 0, 0], [1, 0, 0], [1, 1, 0]] as const;
  expect(colourAt(angle, colours, [1, 1.5])).toEqual(expected);
});

it('a sky of one colour has it everywhere', () => {
  expect(colourAt(1, [[0.2, 0.3, 0.4]], [])).toEqual([0.2, 0.3, 0.4]);
});
