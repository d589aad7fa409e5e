#!/usr/bin/env python3
"""The runs of scripts/island-scenarios, one after the other, and their table; as root.

    island_scenarios.py OUT PEERD [--latency MS]... [--loss SHARE] [--by WAY]... [SCENARIO...]
"""
import argparse
import json
import pathlib
import sys

from netem_runs import mean_ghost_error_m, run_steadily, write_table

# One run of each: by one policy and approach.
ONE_RUN = {
    "eq47": ["replication.approach=dr+rcp+acpt", "replication.order=2"],
    "head-on": ["decisions.policy=expected-error", "network.jitter_ms=0", "network.reordering=0"],
    "traffic": ["decisions.policy=expected-error", "duration_s=15"],
}
# What network.via is, by the words of --by. A relay and leaf nodes are a star, whose middle is the first peer's island:
# `star` is multicast over links that are as long and as lossy as the ways through that.
WAYS = {"multicast": "nothing", "star": "nothing", "relay": "relay", "leaf-nodes": "nats", "cluster": "nats-cluster"}


def run_once(name, latency_ms, loss, way, out, peerd):
    """(summary's run or None, whether the computer kept time, the last words)"""
    sets = ONE_RUN.get(name, []) + [f"network.latency_ms={latency_ms}", f"network.loss={loss}", f"network.via={WAYS[way]}"]
    if way == "star":
        for link in ("b.c", "c.b"):
            sets += [f"network.link.{link}.latency_ms={2 * latency_ms}", f"network.link.{link}.loss={1 - (1 - loss) ** 2}"]
    summary, steady, words = run_steadily(peerd, name, sets, out / f"{name}-{latency_ms}-{way}")
    return summary and summary["runs"][0], steady, words


def measures(run):
    shared = run["collisions"]["shared"]
    return {"mean ghost error [m]": mean_ghost_error_m(run),
            "worst p99 [m]": round(max((o["ghost_error_m"]["p99"] for o in run["objects"]), default=0), 4),
            "updates": run["counters"]["updates_out"], "decided": shared["decided"], "disagreed": shared["disagreed"],
            "missed": shared["missed"], "one state": run["state_roots_equal"]}


def overhead_of_links(folder):
    """Bytes that left the relays over links between them, greetings included, by those of the datagrams themselves."""
    sent = datagrams = 0
    for log in folder.glob("*.relay.log"):
        reports = [r for r in map(json.loads, log.read_text().splitlines()) if r.get("links")]
        sent += reports[-1]["counters"]["net.bytes_out"]
        datagrams += sum(link["bytes_out"] - 6 * link["datagrams_out"] for link in reports[-1]["links"])
    return round(sent / datagrams, 3) if datagrams else ""


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("peerd")
    parser.add_argument("--latency", action="append", type=float)
    parser.add_argument("--loss", type=float, default=0.01)
    parser.add_argument("--by", action="append", choices=list(WAYS))
    parser.add_argument("scenarios", nargs="*")
    a = parser.parse_intermixed_args()
    rows, code, counts = [], 0, False
    for name in a.scenarios or ONE_RUN:
        for latency_ms in a.latency or [20, 100, 200]:
            for way in a.by or WAYS:
                run, steady, words = run_once(name, latency_ms, a.loss, way, a.out, a.peerd)
                measured = measures(run) if run else {}
                said = "failed" if run is None else "kept time" if steady else "did not keep time"
                row = {"scenario": name, "latency [ms]": latency_ms, "by": way, "run": said, **measured}
                if way == "relay" and run:
                    row["bytes of links"] = overhead_of_links(a.out / f"{name}-{latency_ms}-{way}")
                rows.append(row)
                counts = counts or (WAYS[way] != "nothing" and run is not None and steady)
                write_table(rows, a.out / "islands.md")  # also where the next run is the last
                if WAYS[way] != "nothing" and (run is None or (steady and row["disagreed"] > 0)):
                    code = 1
                print(" ".join(f"{v}" for v in row.values()), *words, sep="\n" if words else "", file=sys.stderr, flush=True)
    print((a.out / "islands.md").read_text(), end="")
    return code or (0 if counts or all(WAYS[way] == "nothing" for way in a.by or WAYS) else 3)


if __name__ == "__main__":
    sys.exit(main())
