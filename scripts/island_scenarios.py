#!/usr/bin/env python3
"""The runs of scripts/island-scenarios, one after the other, and their table; as root.

    island_scenarios.py OUT PEERD [--latency MS]... [--loss SHARE] [--by WAY]... [SCENARIO...]
"""
import argparse
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).parent.parent / "configs/scenarios"
# One run of each: by one policy and approach.
ONE_RUN = {
    "eq47": ["replication.approach=dr+rcp+acpt", "replication.order=2"],
    "head-on": ["decisions.policy=expected-error", "network.jitter_ms=0", "network.reordering=0"],
    "traffic": ["decisions.policy=expected-error", "duration_s=15"],
}
# What network.via is, by the words of --by. A relay and leaf nodes are a star, whose middle is the first peer's island:
# `star` is multicast over links that are as long and as lossy as the ways through that.
WAYS = {"multicast": "nothing", "star": "nothing", "relay": "relay", "leaf-nodes": "nats", "cluster": "nats-cluster"}
TRIES = 3


def run_once(name, latency_ms, loss, way, out, peerd):
    """(summary's run or None, whether the computer kept time, the last words)"""
    sets = ONE_RUN.get(name, []) + [f"network.latency_ms={latency_ms}", f"network.loss={loss}", f"network.via={WAYS[way]}"]
    if way == "star":
        for link in ("b.c", "c.b"):
            sets += [f"network.link.{link}.latency_ms={2 * latency_ms}", f"network.link.{link}.loss={1 - (1 - loss) ** 2}"]
    folder = out / f"{name}-{latency_ms}-{way}"
    command = [peerd, "scenario", str(HERE / f"{name}.toml"), "--netem", "--json", "--out", str(folder)]
    for s in sets:
        command += ["--set", s]
    for _ in range(TRIES):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        words = done.stderr.strip().splitlines()
        if done.returncode == 3 and "no network by netem here" in done.stderr:
            sys.exit("\n".join(words))
        if done.returncode > 1:
            return None, True, words[-6:]
        run = json.loads(done.stdout)["runs"][0]
        if run["network"]["steady"]:
            break
    return run, run["network"]["steady"], []


def measures(run):
    objects, shared = run["objects"], run["collisions"]["shared"]
    errors = [o["ghost_error_m"] for o in objects]
    return {"mean ghost error [m]": round(sum(e["mean"] for e in errors) / max(len(errors), 1), 4),
            "worst p99 [m]": round(max((e["p99"] for e in errors), default=0), 4),
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
    rows, code = [], 0
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
                if WAYS[way] != "nothing" and (run is None or (steady and row["disagreed"] > 0)):
                    code = 1
                print(" ".join(f"{v}" for v in row.values()), *words, sep="\n" if words else "", file=sys.stderr, flush=True)
    head = max(rows, key=len)
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(str(r.get(k, "")) for k in head) + " |" for r in rows]
    (a.out / "islands.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return code


if __name__ == "__main__":
    sys.exit(main())
