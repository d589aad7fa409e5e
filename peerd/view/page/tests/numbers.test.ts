import { expect, it } from 'vitest';

import { bytesText, clockText, metresText, millisecondsText, shareText } from '../src/panels/numbers';

it.each([
  [millisecondsText(null), '–'],
  [millisecondsText(0.421), '0.42 ms'],
  [millisecondsText(81.24), '81.2 ms'],
  [millisecondsText(2500), '2.5 s'],
  [shareText(0.0131), '1.3 %'],
  [bytesText(999), '999 B'],
  [bytesText(220110), '220.1 kB'],
  [metresText(NaN), '–'],
  [metresText(0.00004), '40 µm'],
  [metresText(0.0321), '32.1 mm'],
  [metresText(12.345), '12.35 m'],
  [clockText(-3.21), '−0:03.2'],
  [clockText(75), '1:15.0'],
])('%s', (text, expected) => {
  expect(text).toBe(expected);
});
