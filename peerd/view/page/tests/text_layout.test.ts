import { describe, expect, it } from 'vitest';

import { extentOf, fontOf, layOut, type TextExtras } from '../src/scene/text_layout';

// A font whose letters are all half as wide as they are high.
const widthOf = (line: string): number => line.length / 2;
const kText: TextExtras = {
  lines: ['ab', 'abcd'], family: ['SANS'], style: 'PLAIN', justify: ['BEGIN'], length_m: [], max_extent_m: 0, size_m: 2, spacing: 1.5,
  horizontal: true, left_to_right: true, top_to_bottom: true, color: [1, 1, 1], emissive: [0, 0, 0], transparency: 0, lit: true,
};
const places = (text: Partial<TextExtras>): (readonly [number, number])[] => layOut({ ...kText, ...text }, widthOf).map(({ x, y }) => [x, y] as const);

describe('layOut', () => {
  it('begins at the origin and goes down by size times spacing', () => expect(places({})).toEqual([[0, 0], [0, -3]]));
  it('goes up from the bottom', () => expect(places({ top_to_bottom: false })).toEqual([[0, 0], [0, 3]]));
  it('centres each line', () => expect(places({ justify: ['MIDDLE'] }).map(([x]) => x)).toEqual([-1, -2]));
  it('ends at the origin', () => expect(places({ justify: ['END'] }).map(([x]) => x)).toEqual([-2, -4]));
  it('lets END of a line from right to left be its left end', () => expect(places({ justify: ['END'], left_to_right: false }).map(([x]) => x)).toEqual([0, 0]));
  it('puts the block below, around and above the origin', () => {
    const heights = (minor: string): readonly [number, number] => {
      const { top, bottom } = extentOf(layOut({ ...kText, justify: ['BEGIN', minor] }, widthOf), kText.size_m, widthOf);
      return [bottom, top];
    };
    expect(heights('BEGIN')).toEqual([-5, 0]);
    expect(heights('END')).toEqual([0, 5]);
    expect(heights('MIDDLE')).toEqual([-2.5, 2.5]);
  });
  it('stretches a line to its length', () => {
    const [first, second] = layOut({ ...kText, length_m: [6] }, widthOf);
    expect([first.stretch, second.stretch]).toEqual([3, 1]);
  });
  it('narrows all lines where the longest is beyond maxExtent', () => {
    const [first, second] = layOut({ ...kText, max_extent_m: 2 }, widthOf);
    expect([first.stretch, second.stretch]).toEqual([0.5, 0.5]);
  });
  it('sets a vertical line character by character, downwards', () => {
    const placed = layOut({ ...kText, lines: ['abc'], horizontal: false }, widthOf);
    expect(placed.map(({ text }) => text)).toEqual(['a', 'b', 'c']);
    expect(placed[0].y).toBeGreaterThan(placed[1].y);
    expect(placed[0].x).toBeCloseTo(placed[2].x, 12);
    expect(extentOf(placed, 2, widthOf).top).toBeCloseTo(0, 12);
  });
});

it('the extent holds all pieces', () => {
  expect(extentOf(layOut(kText, widthOf), kText.size_m, widthOf)).toEqual({ left: 0, right: 4, bottom: -3.4, top: 1.6 });
});

it('fonts are those that the standard names, else a serif one', () => {
  expect(fontOf({ family: ['Nonesuch', 'TYPEWRITER'], style: 'BOLDITALIC' }, 20)).toBe('italic bold 20px monospace');
  expect(fontOf({ family: [], style: 'PLAIN' }, 20)).toBe('20px serif');
  expect(fontOf({ family: ['SANS'], style: 'ITALIC' }, 20)).toBe('italic 20px sans-serif');
});
