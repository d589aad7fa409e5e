#!/usr/bin/env python3
"""Question: what does a world cost in which nothing happens, by the number of its peers?

many_peers.py [--quick] [--out DIR] [--commit NAME] [--program PEERD]: `peerd sim` with 2 to 64 peers that own a resting box
each, for 30 s, over links of 1 ms.

Exit code 1: a peer did not have all boxes at their places, or the peers' states differed; or what a peer sends grew faster than the
number of peers.
Writes DIR/many_peers.json and .csv.
"""
import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DURATION_S = 30


def simulate(program, peers, folder):
    """What is wrong, and the row of the table."""
    world = ["#VRML V2.0 utf8"] + [
        f"DEF B{i} Transform {{ translation {3 * i} 0 0 children Shape {{ geometry Box {{ size 1 1 1 }} }} }}" for i in range(peers)]
    scenario = ['world = "w.wrl"', f"duration_s = {DURATION_S}", "[network]", "latency_ms = 1"]
    for i in range(peers):
        scenario += [f"[peer.p{i}]", f"id = {i + 1}", f'owns = ["B{i}"]']
    (folder / "w.wrl").write_text("\n".join(world) + "\n")
    (folder / "s.toml").write_text("\n".join(scenario) + "\n")
    out = folder / "out"
    subprocess.run([program, "sim", str(folder / "s.toml"), "--out", str(out)], check=True, stdout=subprocess.DEVNULL)
    run = json.loads((out / "summary.json").read_text())["runs"][0]
    wrong = [] if run["state_roots_equal"] else [f"{peers} peers have not one state"]
    seen = [row for row in run["objects"] if row["owner"] != row["observer"] and row["samples"] > 0]
    wrong += [f"{r['observer']} has {r['path']} off by {r['ghost_error_m']['max']} m" for r in seen if r["ghost_error_m"]["max"] > 0]
    if len(seen) != peers * (peers - 1):
        wrong.append(f"{peers} peers see {len(seen)} boxes of others")
    sent = run["traffic"]["bytes_per_s"] / peers
    return wrong, {"peers": peers, "datagrams a second and peer": round(run["traffic"]["packets"] / DURATION_S / peers, 3),
                   "bytes/s that a peer sends": round(sent, 1), "bytes/s that it receives": round(sent * (peers - 1), 1)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path, default=ROOT / "out/bench")
    parser.add_argument("--commit", default="unknown")
    parser.add_argument("--program", default=str(ROOT / "build/release/bin/peerd"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    rows, wrong = [], []
    for peers in (2, 4) if options.quick else (2, 4, 8, 16, 32, 64):
        with tempfile.TemporaryDirectory(prefix="peerd-many-peers-") as made:
            found, row = simulate(options.program, peers, Path(made))
        wrong += found
        if rows and row["bytes/s that a peer sends"] > 2 * rows[-1]["bytes/s that a peer sends"]:
            wrong.append(f"each of {peers} peers sends {row['bytes/s that a peer sends']} bytes/s, after "
                         f"{rows[-1]['bytes/s that a peer sends']}")
        rows.append(row)
        print(", ".join(f"{name}: {value}" for name, value in row.items()), flush=True)
    for what in wrong[:20]:
        print("WRONG:", what)
    (options.out / "many_peers.json").write_text(json.dumps({"commit": options.commit, "wrong": wrong, "rows": rows}, indent=1) + "\n")
    with open(options.out / "many_peers.csv", "w", newline="") as out:
        table = csv.DictWriter(out, rows[0].keys())
        table.writeheader()
        table.writerows(rows)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
