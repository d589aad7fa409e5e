import { describe, expect, it } from 'vitest';

import { OcclusionState } from '../src/scene/occlusion_state';

// Pictures one after the other, of one object. `answers` come so many pictures after their question; the camera moves in each
// picture, or never.
function drawn(truths: readonly boolean[], latency: number, moves: boolean): string {
  const state = new OcclusionState(1);
  const waiting: { at: number; hidden: boolean }[] = [];
  return truths
    .map((hidden, picture) => {
      state.begin(moves ? picture : 0);
      while (waiting.length > 0 && waiting[0].at <= picture) state.answer(0, waiting.shift()?.hidden ?? false);
      const out = state.isLeftOut(0, 0);
      if (state.shouldAsk(0, 0)) {
        state.ask(0, 0);
        waiting.length = 0; // a question anew is the only one
        waiting.push({ at: picture + latency, hidden });
      }
      return out ? '-' : 'D';
    })
    .join('');
}

const kHidden = new Array<boolean>(8).fill(true);

describe('an object that something hides', () => {
  it('is left out after one answer while nothing moves', () => expect(drawn(kHidden, 1, false)).toBe('D-------'));
  it('also where answers come late', () => expect(drawn(kHidden, 3, false)).toBe('DDD-----'));
  it('is left out after two answers while the camera moves', () => expect(drawn(kHidden, 1, true)).toBe('DD------'));
  it('is drawn where the camera moves and answers come late', () => expect(drawn(kHidden, 2, true)).toBe('DDDDDDDD'));
});

describe('an object that comes into sight', () => {
  it('is missing in one picture at most', () => expect(drawn([true, true, true, false, false, false], 1, true)).toBe('DD--DD'));
  it('stays drawn where it is hidden and seen in turn', () => expect(drawn([true, false, true, false, true, false], 1, true)).toMatch(/^D+$/));
});

it('while nothing moves, nothing is asked twice; what is seen is asked for now and then as the camera moves', () => {
  const still = new OcclusionState(1);
  const moving = new OcclusionState(1);
  let [asked, askedMoving] = [0, 0];
  for (let picture = 0; picture < 60; ++picture) {
    for (const [state, view] of [[still, 0], [moving, picture]] as const) {
      state.begin(view);
      if (state.isAsked(0)) state.answer(0, false);
      if (!state.shouldAsk(0, 0)) continue;
      state.ask(0, 0);
      if (state === still) asked += 1;
      else askedMoving += 1;
    }
  }
  expect(asked).toBe(1);
  expect(askedMoving).toBeGreaterThan(5);
  expect(askedMoving).toBeLessThan(15);
});

it('an object that has moved since is asked for anew', () => {
  const state = new OcclusionState(1);
  state.begin(0);
  state.ask(0, 0);
  state.begin(0);
  state.answer(0, true);
  expect(state.isLeftOut(0, 0)).toBe(true);
  state.begin(0);
  expect(state.isLeftOut(0, 1)).toBe(false);
  expect(state.shouldAsk(0, 1)).toBe(true);
});
