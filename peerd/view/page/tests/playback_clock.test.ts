import { describe, expect, it } from 'vitest';
import { PlaybackClock } from 'peerd';

describe('the clock of the picture', () => {
  it('stays behind the newest frame and goes on evenly while frames come unevenly', () => {
    const clock = new PlaybackClock(20);
    let newest_s = 0;
    let shown_s = -Infinity;
    for (let i = 0; i < 200; ++i) {
      newest_s = 1000 + i * 0.05;
      const late_s = [0, 0.02, 0.004, 0.03][i % 4];
      clock.onFrame(newest_s, 5 + i * 0.05 + late_s);
      const now_s = 5 + i * 0.05 + 0.04;
      expect(clock.shownAt(now_s)).toBeGreaterThan(shown_s);
      shown_s = clock.shownAt(now_s);
    }
    expect(shown_s).toBeLessThan(newest_s + 0.05);
    expect(shown_s).toBeGreaterThan(newest_s - 0.1);
  });

  it('shows nothing before the first frame', () => {
    expect(new PlaybackClock(20).shownAt(3)).toBeNaN();
  });

  it('starts anew where session time steps', () => {
    const clock = new PlaybackClock(20);
    clock.onFrame(100, 1);
    clock.onFrame(50, 1.05);
    expect(clock.shownAt(1.05)).toBeCloseTo(50, 0);
  });
});
