const kSetBack_ms = 100; // a clock that is as much behind has been set; what is less comes of calls within a microsecond
let offset_ms = NaN; // Unix time minus performance.now()
let last_ms = -Infinity;

/**
 * Unix time of this computer [s], for `time_s` of poses: finer than `Date.now()`, which has whole milliseconds, and never twice the same,
 * because a peer refuses two poses of one instant. It follows the computer's clock where that is set.
 */
export function unixTime_s(): number {
  const before_ms = performance.now();
  const whole_ms = Date.now(); // leaves out what is below a millisecond; a pause may come before it, or after
  const fine_ms = performance.now();
  const [least_ms, most_ms] = [whole_ms - fine_ms, whole_ms + 1 - before_ms];
  offset_ms = Number.isNaN(offset_ms) ? least_ms : Math.min(Math.max(offset_ms, least_ms), most_ms);
  const now_ms = fine_ms + offset_ms;
  last_ms = now_ms <= last_ms && now_ms > last_ms - kSetBack_ms ? last_ms + 0.001 : now_ms;
  return last_ms / 1000;
}
