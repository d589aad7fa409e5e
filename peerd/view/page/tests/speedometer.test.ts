import { expect, it } from 'vitest';

import { Speedometer } from '../src/panels/speedometer';

it('reads the speed of one subject at a time', () => {
  const meter = new Speedometer();
  expect(meter.read(1, 10, [0, 0, 0])).toBeNaN();
  expect(meter.read(1, 10.5, [3, 0, 4])).toBe(10);
  expect(meter.read(1, 10.5, [3, 0, 4])).toBe(10);
  expect(meter.read(2, 11, [0, 0, 0])).toBeNaN();
  expect(meter.read(2, 12, null)).toBeNaN();
  expect(meter.read(2, 13, [0, 1, 0])).toBe(0.5);
  expect(meter.read(2, 9, [0, 1, 0])).toBeNaN();
});
