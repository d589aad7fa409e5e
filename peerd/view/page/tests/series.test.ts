import { describe, expect, it } from 'vitest';

import { Rate, roundedUp, Series } from '../src/panels/series';

describe('a series', () => {
  it('keeps the newest values', () => {
    const series = new Series('s', '--accent', 4);
    for (let i = 0; i < 10; ++i) series.add(i, i * i);
    expect(Array.from({ length: series.length }, (_, i) => series.valueAt(i))).toEqual([36, 49, 64, 81]);
    expect(series.greatest(0)).toBe(81);
    expect(series.greatest(10)).toBe(0);
    expect(series.nearest(7.4)).toBe(49);
  });
});

describe('a rate', () => {
  it('is the growth of a counter a second, and none where it begins anew', () => {
    const rate = new Rate();
    expect(rate.at(0, 100)).toBeNaN();
    expect(rate.at(2, 140)).toBe(20);
    expect(rate.at(3, 5)).toBeNaN();
    expect(rate.at(4, undefined)).toBeNaN();
    expect(rate.at(5, 25)).toBe(10);
  });
});

it.each([[0, 1], [NaN, 1], [1, 1], [1.2, 2], [3, 5], [7, 10], [0.0123, 0.02], [4200, 5000]])('%d is below the round number %d', (value, round) => {
  expect(roundedUp(value)).toBeCloseTo(round, 12);
});
