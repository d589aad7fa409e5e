"""Runs of scenarios over netem, and their tables: what scripts/unicast_scenarios.py and island_scenarios.py share."""
import json
import pathlib
import subprocess
import sys

SCENARIOS = pathlib.Path(__file__).parent.parent / "configs/scenarios"
TRIES = 3


def run_steadily(peerd, name, sets, folder):
    """(the summary or None, whether the computer kept time in one of a few tries, the last words of what failed)"""
    command = [peerd, "scenario", str(SCENARIOS / f"{name}.toml"), "--netem", "--json", "--out", str(folder)]
    for s in sets:
        command += ["--set", s]
    for _ in range(TRIES):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        words = done.stderr.strip().splitlines()
        if done.returncode == 3 and "no network by netem here" in done.stderr:
            sys.exit("\n".join(words))
        if done.returncode > 1:
            return None, True, words[-6:]
        summary = json.loads(done.stdout)
        if summary["runs"][0]["network"]["steady"]:
            return summary, True, []
    return summary, False, []


def mean_ghost_error_m(run):
    objects = run["objects"]
    return round(sum(o["ghost_error_m"]["mean"] for o in objects) / max(len(objects), 1), 4)


def write_table(rows, file):
    """Writes the rows as a table; the longest one has its head."""
    head = list(max(rows, key=len))
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(str(r.get(k, "")) for k in head) + " |" for r in rows]
    file.write_text("\n".join(lines) + "\n")
