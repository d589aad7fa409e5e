#!/usr/bin/env python3
"""The runs of scripts/unicast-scenarios, one after the other, and their table; as root.

    unicast_scenarios.py OUT PEERD [SCENARIO...]
"""
import pathlib
import sys

from netem_runs import SCENARIOS, mean_ghost_error_m, run_steadily, write_table

# One run of each: at one latency, by one policy and approach.
ONE_RUN = {
    "crowd": ["duration_s=15"],
    "eq47": ["replication.approach=dr+rcp+acpt", "replication.order=2"],
    "flock": ["duration_s=15"],
    "flock-regions": ["duration_s=15"],
    "head-on": ["decisions.policy=expected-error", "network.loss=0"],
    "orbit": ["duration_s=15"],
    "traffic": ["decisions.policy=expected-error", "duration_s=15"],
}
WITHOUT_SWEEP = {"keys", "netem", "snooker"}
NOT_HERE = {"comings", "outside"}  # partitions are for a simulated network; one waits for a program
WAYS = {"multicast": "always", "unicast": "never"}
# By unicast ghosts may be off by so many times what they are by multicast, and a millimetre. What differs from run to run
# is when contacts fall.
ERROR_MOST, ERROR_FREE_M = 1.5, 0.001


def names():
    return sorted(f.stem for f in SCENARIOS.glob("*.toml") if f.stem not in NOT_HERE)


def run_once(name, way, out, peerd):
    """(summary's run or None, whether the computer kept time, what of the expectations does not hold or the last words)"""
    sets = ONE_RUN.get(name, []) + [f"transport.multicast={WAYS[way]}"]
    if name not in WITHOUT_SWEEP:
        sets.append("network.latency_ms=100")
    summary, steady, words = run_steadily(peerd, name, sets, out / f"{name}-{way}")
    if summary is None:
        return None, steady, words[-1:]
    # A number that only a simulation has (collisions.wrong) is none that fails here.
    failed = [e["name"] for e in summary.get("expectations", []) if any(f["found"] is not None for f in e["failures"])]
    return summary["runs"][0], steady, failed


def measures(run):
    shared = run["collisions"]["shared"]
    return {"mean ghost error [m]": mean_ghost_error_m(run), "updates": run["counters"]["updates_out"],
            "decided": shared["decided"], "disagreed": shared["disagreed"], "missed": shared["missed"],
            "sent [kB]": round(run["counters"]["bytes_out"] / 1000, 1)}


def is_farther_off(by_unicast, by_multicast):
    if not by_multicast:
        return False
    error = "mean ghost error [m]"
    return by_unicast[error] > ERROR_MOST * by_multicast[error] + ERROR_FREE_M


def main(out, peerd, wanted):
    rows, code = [], 0
    for name in wanted or names():
        by_multicast = None  # what counts of it
        for way in WAYS:
            run, steady, words = run_once(name, way, out, peerd)
            measured = measures(run) if run else {}
            if run and way == "unicast" and is_farther_off(measured, by_multicast):
                words = words + ["farther-off-than-by-multicast"]
            if steady and way == "multicast":
                by_multicast = measured
            said = "failed" if run is None else "did not keep time" if not steady else "does not hold" if words else "holds"
            row = {"scenario": name, "by": way, "what is expected": said, **measured}
            rows.append(row)
            bad = run is None or (steady and (bool(words) or row["disagreed"] > 0))
            if way == "unicast" and bad:
                code = 1
            print(f"{name}, {way}: {said} {' '.join(words)}".rstrip(), file=sys.stderr, flush=True)
    write_table(rows, out / "unicast.md")
    print((out / "unicast.md").read_text(), end="")
    return code


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3:]))
