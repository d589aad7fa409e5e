let offset_ms = NaN; // Unix time minus performance.now()
let last_ms = -Infinity;

/**
 * Unix time of this computer [s], for `time_s` of poses: finer than `Date.now()`, which has whole milliseconds, and never twice the same,
 * because a peer refuses two poses of one instant. It follows the computer's clock where that is set.
 */
export function unixTime_s(): number {
  const fine_ms = performance.now();
  const least_ms = Date.now() - fine_ms; // Date.now() leaves out what is below a millisecond
  offset_ms = Number.isNaN(offset_ms) ? least_ms : Math.min(Math.max(offset_ms, least_ms), least_ms + 1);
  const now_ms = fine_ms + offset_ms;
  last_ms = now_ms <= last_ms && now_ms > last_ms - 1 ? last_ms + 0.001 : now_ms;
  return last_ms / 1000;
}
