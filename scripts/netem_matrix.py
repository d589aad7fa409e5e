#!/usr/bin/env python3
"""The cells of scripts/netem-matrix: what they are, one after the other, and what came of them.

    netem_matrix.py run OUT PEERD SCENARIO SIZE PART PARTS   cells that are not finished, every PARTS-th; as root
    netem_matrix.py count SIZE                               how many cells there are
    netem_matrix.py report OUT SIZE                          matrix.csv, matrix.md and matrix.svg. 1: peers disagreed, a cell
        failed, or a network was not what it should have been; 3: no cell counts, or some were not run
    netem_matrix.py compare REAL.json SIM.json               two summaries of one sweep side by side

A cell is finished when its cell.json says so. Nothing here reads a clock: a cell's own measurements say whether it counts.
"""
import csv
import html
import itertools
import json
import math
import pathlib
import subprocess
import sys

OUTCOMES = 5  # that the scenario has on a good network
BURST = 5  # datagrams lost in a row, on average
CHANCE = 1e-6  # what is rarer than this is not put down to chance
LOSSES = {"0": 0.0, "1": 0.01, "5": 0.05, "20": 0.2, "5b": 0.05}
TRIES = 3
IMPAIRED_ONE_SIDED = [("a", "b"), ("a", "c")]


def all_cells():
    """Delay [ms], loss, jitter (share of the delay, on top of it), reordering, and whether only what `a` sends suffers."""
    for delay, loss, jitter, reorder, side in itertools.product(
            (0, 100, 200, 500), LOSSES, (0.0, 0.1, 0.5), (0.0, 0.25), ("both", "one")):
        if delay == 0 and (jitter or reorder):
            continue
        if delay == 0 and LOSSES[loss] == 0.0 and side == "one":
            continue  # nothing is one-sided there
        name = f"d{delay}-l{loss}-j{round(100 * jitter)}-r{round(100 * reorder)}-{side}"
        yield {"name": name, "delay_ms": delay, "loss": loss, "jitter_ms": delay * jitter, "reordering": reorder, "side": side}


def cells(size):
    everything = list(all_cells())
    few = {"test": ["d0-l0-j0-r0-both", "d100-l5-j10-r25-both", "d200-l5b-j50-r0-one"]}
    few["quick"] = few["test"] + [
        "d0-l20-j0-r0-one", "d100-l0-j0-r0-one", "d100-l20-j50-r25-both", "d200-l1-j10-r0-both", "d200-l20-j0-r25-one",
        "d500-l0-j0-r0-both", "d500-l1-j50-r25-one", "d500-l5b-j10-r25-both", "d500-l20-j50-r25-both"]
    if size == "full":
        return everything
    by_name = {c["name"]: c for c in everything}
    return [by_name[n] for n in few[size]]


def settings(cell):
    values = {"latency_ms": cell["delay_ms"], "jitter_ms": cell["jitter_ms"], "reordering": cell["reordering"],
              "loss": LOSSES[cell["loss"]]}
    if cell["loss"].endswith("b"):
        values["loss_burst"] = BURST
    if cell["side"] == "both":
        return [f"network.{k}={v}" for k, v in values.items()]
    return ["network.latency_ms=0"] + [f"network.link.{f}.{t}.{k}={v}" for f, t in IMPAIRED_ONE_SIDED for k, v in values.items()]


def wanted_delay_ms(cell):
    return cell["delay_ms"] + cell["jitter_ms"] / 2 + cell["reordering"] * (cell["delay_ms"] + cell["jitter_ms"])


def probability_of_at_most(lost, packets, loss, burst):
    """That so many packets or fewer are lost of those that netem loses in bursts of that mean (Gilbert's two states)."""
    leave = 1 / burst
    enter = leave * loss / (1 - loss)
    good, bad = [1.0] + [0.0] * lost, [0.0] * (lost + 1)  # by state, the probability of 0, 1, .. lost so far
    for _ in range(packets):
        now_bad = [g * enter + b * (1 - leave) for g, b in zip(good, bad)]
        good = [g * (1 - enter) + b * leave for g, b in zip(good, bad)]
        bad = [0.0] + now_bad[:-1]
    return sum(good) + sum(bad)


def loss_is_off(lost, packets, loss, burst):
    as_few = probability_of_at_most(lost, packets, loss, burst)
    as_many = 1 - (probability_of_at_most(lost - 1, packets, loss, burst) if lost else 0)
    return min(as_few, as_many) < CHANCE


def network_is_off(row):
    """Whether a cell's network was not what was asked for, beyond what chance and a steady computer's lateness explain."""
    delay, jitter, held = row["delay_ms"], row["jitter_ms"], row["reordering"]
    spread = math.sqrt(jitter ** 2 / 12 + held * (1 - held) * (delay + jitter) ** 2)
    tolerance_ms = 5 + 5 * spread / math.sqrt(row["probes"])
    loss = LOSSES[row["loss"]]
    burst = BURST if row["loss"].endswith("b") else 1 / (1 - loss)  # losses that know nothing of each other
    return abs(row["measured_delay_ms"] - row["wanted_delay_ms"]) > tolerance_ms or \
        loss_is_off(row["packets_lost"], row["packets"], loss, burst)


def outcome(cell, run):
    """One row of the table, of one run of summary.json."""
    links = [l for l in run["network"]["links"] if cell["side"] == "both" or (l["from"], l["to"]) in IMPAIRED_ONE_SIDED]
    shared = run["collisions"]["shared"]
    packets, lost = sum(l["packets"] for l in links), sum(l["packets_lost"] for l in links)
    objects = run["objects"]
    return {
        **cell,
        "steady": run["network"]["steady"],
        "wanted_delay_ms": round(wanted_delay_ms(cell), 2),
        "measured_delay_ms": round(sum(l["delay_ms"]["mean"] for l in links) / len(links), 2),
        "wanted_loss": LOSSES[cell["loss"]],
        "measured_loss": round(lost / max(packets + lost, 1), 4),
        "packets": packets + lost,
        "packets_lost": lost,
        "probes": sum(l["probes"]["sent"] - l["probes"]["lost"] for l in links),
        "oversleep_p99_ms": round(run["network"]["oversleep_ms"]["during"]["p99"], 2),
        "ticks_late": round(run["counters"]["ticks_missed"] / run["counters"]["ticks"], 4),
        **{k: shared[k] for k in ("decided", "agreed", "disagreed", "missed", "spurious")},
        "mean_ghost_error_m": round(sum(o["ghost_error_m"]["mean"] for o in objects) / len(objects), 4),
        "updates": run["counters"]["updates_out"],
    }


def run_cell(cell, folder, peerd, scenario):
    command = [peerd, "scenario", scenario, "--netem", "--json", "--out", str(folder)]
    for s in settings(cell):
        command += ["--set", s]
    for tried in range(1, TRIES + 1):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if done.returncode != 0:
            row = {**cell, "failed": done.stderr.strip().splitlines()[-1:], "exit_code": done.returncode}
            if done.returncode == 3 and "no network by netem here" in done.stderr:
                print(done.stderr, end="", file=sys.stderr)
                sys.exit(3)
            continue
        row = outcome(cell, json.loads(done.stdout)["runs"][0])
        if row["steady"]:
            break
    row["tries"] = tried
    if row.get("disagreed", 1) == 0:  # what only an inquiry needs
        for big in ("*.rows", "errors.csv", "traffic.csv"):
            for file in folder.glob(big):
                file.unlink()
    (folder / "cell.json").write_text(json.dumps(row) + "\n")
    return row


def verdict(row):
    return "failed" if "failed" in row else "good" if row["steady"] else "stalled"


def load(out, cell):
    try:
        return json.loads((out / "cells" / cell["name"] / "cell.json").read_text())
    except FileNotFoundError:
        return None


def run(out, peerd, scenario, size, part, parts):
    todo = cells(size)[part::parts]
    for number, cell in enumerate(todo, 1):
        row = load(out, cell)
        if row is None or verdict(row) != "good":
            folder = out / "cells" / cell["name"]
            folder.mkdir(parents=True, exist_ok=True)
            row = run_cell(cell, folder, peerd, scenario)
        said = row.get("failed") or (f"{row['measured_delay_ms']} ms, {100 * row['measured_loss']:.1f} % lost, "
                                     f"{row['agreed']} agreed, {row['disagreed']} disagreed, {row['missed']} missed")
        print(f"{number}/{len(todo)} {cell['name']}: {verdict(row)}: {said}", file=sys.stderr, flush=True)


COLUMNS = ["name", "wanted_delay_ms", "measured_delay_ms", "wanted_loss", "measured_loss", "packets", "decided", "agreed",
           "disagreed", "missed", "spurious", "mean_ghost_error_m", "updates", "ticks_late", "oversleep_p99_ms", "tries"]


def markdown(rows, todo, stalled, failed):
    good_sum = lambda key: sum(r[key] for r in rows)
    lines = [f"{len(rows)} of {todo} cells count; discarded because the computer did not keep time: {len(stalled)}; failed: {len(failed)}.",
             f"Decided {good_sum('decided')}; agreed {good_sum('agreed')}, disagreed {good_sum('disagreed')}, "
             f"missed {good_sum('missed')}, spurious {good_sum('spurious')}; {sum(r['decided'] < OUTCOMES for r in rows)} cells "
             f"where nobody decided one of {OUTCOMES} outcomes.", "",
             "| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(str(r[c]) for c in COLUMNS) + " |" for r in rows]
    for title, some in (("Discarded", stalled), ("Failed", failed)):
        if some:
            lines += ["", f"{title}: " + ", ".join(r["name"] for r in some)]
    return "\n".join(lines) + "\n"


def svg(rows):
    """A square a cell: the redder, the further ghosts were off; a black frame where a decision was missed."""
    across = sorted({(r["delay_ms"], r["jitter_ms"], r["reordering"]) for r in rows})
    down = sorted({(r["side"], list(LOSSES).index(r["loss"]), r["loss"]) for r in rows})
    most = max((r["mean_ghost_error_m"] for r in rows), default=0) or 1
    w, h, left, top = 44, 24, 140, 80
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + w * len(across) + 20}" height="{top + h * len(down) + 50}" '
             'font-family="sans-serif" font-size="11"><rect width="100%" height="100%" fill="white"/>',
             f'<text x="10" y="16" font-size="13">Mean ghost error [m] under netem; framed: an outcome that somebody missed or nobody decided; '
             'b: losses in bursts</text>']
    for i, (delay, jitter, reorder) in enumerate(across):
        x = left + w * i + w / 2
        for line, words in enumerate((f"{delay} ms", f"+{jitter:g}" if jitter else "", f"r {reorder:g}" if reorder else "")):
            parts.append(f'<text x="{x}" y="{top - 40 + 13 * line}" text-anchor="middle">{words}</text>')
    for j, (side, _, loss) in enumerate(down):
        label = html.escape(f"{loss} % lost, {'both ways' if side == 'both' else 'a only'}")
        parts.append(f'<text x="{left - 6}" y="{top + h * j + 16}" text-anchor="end">{label}</text>')
    for r in rows:
        x = left + w * across.index((r["delay_ms"], r["jitter_ms"], r["reordering"]))
        y = top + h * down.index((r["side"], list(LOSSES).index(r["loss"]), r["loss"]))
        other = round(255 * (1 - r["mean_ghost_error_m"] / most))
        frame = "black" if r["missed"] or r["disagreed"] or r["decided"] < OUTCOMES else "white"
        parts.append(f'<rect x="{x + 1}" y="{y + 1}" width="{w - 3}" height="{h - 3}" fill="rgb(255,{other},{other})" stroke="{frame}"/>'
                     f'<text x="{x + w / 2}" y="{y + 16}" text-anchor="middle">{r["mean_ghost_error_m"]:.2f}</text>')
    return "\n".join(parts) + "\n</svg>\n"


def report(out, size):
    todo = cells(size)
    by_verdict = {"good": [], "stalled": [], "failed": []}
    for cell in todo:
        row = load(out, cell)
        if row is not None:
            by_verdict[verdict(row)].append(row)
    rows = by_verdict["good"]
    with open(out / "matrix.csv", "w", newline="") as f:
        table = csv.DictWriter(f, list(rows[0]) if rows else COLUMNS, extrasaction="ignore")
        table.writeheader()
        table.writerows(rows)
    text = markdown(rows, len(todo), by_verdict["stalled"], by_verdict["failed"])
    (out / "matrix.md").write_text(text)
    (out / "matrix.svg").write_text(svg(rows))
    print("\n".join(text.splitlines()[:2]))
    wrong = {"disagreed": [r for r in rows + by_verdict["stalled"] if r["disagreed"]], "failed": by_verdict["failed"],
             "another network than asked for": [r for r in rows if network_is_off(r)]}
    for what, some in wrong.items():
        if some:
            print(f"{what}: " + ", ".join(r["name"] for r in some))
    not_run = [c["name"] for c in todo if load(out, c) is None]
    if not_run:
        print("not run: " + ", ".join(not_run))
    if any(wrong.values()):
        return 1
    return 0 if rows and not not_run else 3


def compare(real, sim):
    runs = [json.loads(pathlib.Path(p).read_text())["runs"] for p in (real, sim)]
    worst = lambda run: max(run["objects"], key=lambda o: o["ghost_error_m"]["mean"])
    print("| run | updates real | sim | | mean ghost error real [m] | sim | | late ticks |\n|---|---|---|---|---|---|---|---|")
    for a, b in zip(*runs, strict=True):
        assert a["params"] == b["params"], f"not of one sweep: {a['params']} and {b['params']}"
        path = worst(b)["path"]
        of = lambda run, key: [key(o) for o in run["objects"] if o["path"] == path]
        updates = [of(r, lambda o: o["updates_sent"])[0] for r in (a, b)]
        errors = [sum(e) / len(e) for e in (of(r, lambda o: o["ghost_error_m"]["mean"]) for r in (a, b))]
        percent = lambda x, y: f"{100 * (x / y - 1):+.0f} %"
        late = a["counters"]["ticks_missed"] / a["counters"]["ticks"]
        steady = "" if a["network"]["steady"] else " (did not keep time)"
        print(f"| {' '.join(str(v) for v in a['params'].values())} | {updates[0]} | {updates[1]} | {percent(*updates)} "
              f"| {errors[0]:.3f} | {errors[1]:.3f} | {percent(*errors)} | {100 * late:.1f} %{steady} |")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["run", out, peerd, scenario, size, part, parts]:
            run(pathlib.Path(out), peerd, scenario, size, int(part), int(parts))
        case ["count", size]:
            print(len(cells(size)))
        case ["report", out, size]:
            sys.exit(report(pathlib.Path(out), size))
        case ["compare", real, sim]:
            compare(real, sim)
        case _:
            sys.exit(__doc__)
