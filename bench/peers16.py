#!/usr/bin/env python3
"""Question: do sixteen peers of 200 objects each share a world on one computer, and what does it cost?

peers16.py [--quick] [--out DIR] [--commit NAME] [--program PEERD]: sixteen `peerd run` over multicast on lo, each with 200
walkers, for 60 s; once with the defaults (second order), once with configs/best.toml. No regions, no interest: everybody
hears of all 3,200. Shortly before the end each peer is asked by its control socket what it believes.

Exit code 1: a peer did not know all others, or all objects and who runs them, or had one farther from where its owner has
it than its threshold and the time between two answers explain; a datagram was dropped, by a peer that had joined or for want
of room in the kernel. Writes DIR/peers16.json and .csv.
"""
import argparse
import csv
import json
import os
import re
import socket
import statistics
import sys
import tempfile
import time
from pathlib import Path

PEERS = 16
SPEED_M_S = 1.3
THRESHOLD_M = 0.25
ROOT = Path(__file__).resolve().parents[1]
# What a peer hears before it knows the session's time, or who speaks, is of no use to it yet.
JOINING = ("not_yet_in_session", "stranger")
# What a transport counts besides drops. Stamps that the wall clock spoilt are not drops.
NO_DROPS = ("net.calls_", "net.in_unstamped", "net.in_stamp_refused", "net.greetings_")


def name(peer):
    return f"p{peer:02}"


def write_scenario(folder, objects, duration_s):
    side_m = 5 + 0.75 * (PEERS * objects) ** 0.5  # a person on each 2 m^2 or so
    world = ["#VRML V2.0 utf8"]
    scenario = ['world = "w.wrl"', f"duration_s = {duration_s}"]
    for peer in range(PEERS):
        scenario += [f"[peer.{name(peer)}]", f"id = {peer + 1}", f'owns = ["{name(peer)}_*"]']
        for i in range(objects):
            x = (side_m - 2) * (2 * ((peer * objects + i) * 0.618034 % 1) - 1)
            z = (side_m - 2) * (2 * (peer * objects + i) / (PEERS * objects) - 1)
            world.append(f"DEF {name(peer)}_{i:03} Transform {{ translation {x:.2f} 0 {z:.2f} "
                         f"distanceThreshold {THRESHOLD_M} children Shape {{ geometry Box {{ size 0.5 1.7 0.3 }} }} }}")
    scenario += ['[motion."*".walk]', f"speed_m_s = {SPEED_M_S}",
                 f"within_m = [{-side_m:.1f}, {-side_m:.1f}, {side_m:.1f}, {side_m:.1f}]"]
    (folder / "w.wrl").write_text("\n".join(world) + "\n")
    (folder / "s.toml").write_text("\n".join(scenario) + "\n")


class Peer:
    """One peerd process and its control socket."""

    def __init__(self, program, folder, peer, port, overlay):
        self.name = name(peer)
        self.socket = folder / f"{self.name}.sock"
        self.log = folder / f"{self.name}.log"
        command = [program, "run", "--config", str(folder / "s.toml"), "--peer", self.name, "--interface", "lo",
                   "--port", str(port), "--once", "--control", str(self.socket)]
        if overlay:
            command += ["--overlay", str(overlay)]
        output = os.open(self.log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        self.pid = os.posix_spawn(program, command, os.environ,
                                  file_actions=[(os.POSIX_SPAWN_DUP2, output, 1), (os.POSIX_SPAWN_DUP2, output, 2)])
        os.close(output)
        self.begun = time.monotonic()

    def ask(self, request):
        with socket.socket(socket.AF_UNIX) as s:
            s.settimeout(5)
            s.connect(str(self.socket))
            s.sendall(json.dumps(request).encode() + b"\n")
            return json.loads(s.makefile().readline())

    def since_start_s(self):
        try:
            return self.ask({"do": "status"})["since_start_s"]
        except OSError:
            return None  # it does not listen yet

    def wait(self):
        _, self.status, usage = os.wait4(self.pid, 0)
        self.cpu = (usage.ru_utime + usage.ru_stime) / (time.monotonic() - self.begun)
        self.pid = None


def check_beliefs(peers, objects):
    """What is wrong with what each peer believes of all; and how far off it is at most [m]."""
    wrong, worst = [], 0.0
    for peer in peers:
        members = {m["name"] for m in peer.ask({"do": "status"})["members"]}
        if members != {p.name for p in peers} - {peer.name}:
            wrong.append(f"{peer.name} knows {len(members)} other peers")
    seen = {peer.name: 0 for peer in peers}
    start = 0
    while start is not None:
        told = {peer.name: (time.monotonic(), peer.ask({"do": "objects", "from": start})) for peer in peers}
        places = {p["path"]: (at, p["position_m"]) for owner, (at, reply) in told.items() for p in reply["objects"]
                  if p["own"]}
        for who, (at, reply) in told.items():
            for p in reply["objects"]:
                seen[who] += 1
                if name(p["owner"] - 1) != p["path"].split("_")[0]:
                    wrong.append(f"{who} thinks that peer {p['owner']} runs {p['path']}")
                if p["path"] not in places:
                    continue  # its owner's page ends elsewhere; that page's turn comes
                published_at, place = places[p["path"]]
                off = sum((a - b) ** 2 for a, b in zip(p["position_m"], place)) ** 0.5
                worst = max(worst, off)
                # A walker turns in between, so that both may have gone either way; then updates on their way.
                if off > THRESHOLD_M + 2 * SPEED_M_S * (abs(published_at - at) + 0.25):
                    wrong.append(f"{who} has {p['path']} {off:.2f} m off")
        start = next(iter(told.values()))[1]["next"]
    wrong += [f"{who} knows {n} objects" for who, n in seen.items() if n != PEERS * objects]
    return wrong, worst


def run(program, objects, duration_s, overlay):
    """(what is wrong, figures: name -> (values, unit))"""
    with tempfile.TemporaryDirectory(prefix="peerd-peers16-") as made:
        folder = Path(made)
        write_scenario(folder, objects, duration_s)
        port = 20000 + os.getpid() * 37 % 12000
        peers = []
        try:
            for peer in range(PEERS):
                peers.append(Peer(program, folder, peer, port, overlay))
            give_up = time.monotonic() + duration_s + 60
            while (peers[0].since_start_s() or -1) < duration_s - 6:
                if time.monotonic() > give_up or any(os.waitid(os.P_PID, p.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
                                                     for p in peers):
                    raise OSError("the peers do not begin, or one has ended")
                time.sleep(0.2)
            wrong, worst = check_beliefs(peers, objects)
            for peer in peers:
                peer.wait()
        except (OSError, ValueError, KeyError) as error:
            last = "\n".join(p.log.read_text()[-400:] for p in peers[:1] if p.log.exists())
            return [f"{error!r}; {name(0)} says: {last}"], {}
        finally:
            for peer in peers:
                if peer.pid is not None:
                    os.kill(peer.pid, 9)
                    os.waitpid(peer.pid, 0)
        late, missed, out, joining = [], 0, 0, 0
        for peer in peers:
            text = peer.log.read_text()
            if peer.status != 0:
                wrong.append(f"{peer.name} ended with {peer.status}: {text[-300:]}")
                continue
            late.append(float(re.search(r"ticks ran late by ([\d.]+) ms", text)[1]))
            sent, skipped = re.search(r"sent (\d+) datagrams .*; (\d+) of \d+ ticks were late", text).groups()
            missed += int(skipped)
            out += int(sent)
            for count, reason in re.findall(r"dropped (\d+): (\S+)", text):
                if reason in JOINING:
                    joining += int(count)
                else:
                    wrong.append(f"{peer.name} dropped {count}: {reason}")
            for counter, count in re.findall(r"(net\.\S+): (\d+)", text):
                if not counter.startswith(NO_DROPS):
                    wrong.append(f"{peer.name}: {counter} {count}")
        if not late:
            return wrong, {}
        return wrong, {
            "cpu_per_peer": ([p.cpu for p in peers], "of a core"),
            "cpu_all_peers": ([sum(p.cpu for p in peers)], "of a core"),
            "tick_late_p99_ms": (late, "ms"),
            "ticks_missed": ([missed], "ticks of all peers"),
            "dropped_before_joining": ([joining], "datagrams of all peers"),
            "datagrams_per_s": ([out / duration_s / PEERS], "sent by a peer"),
            "farthest_m": ([worst], "m"),
        }


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", default="")
    parser.add_argument("--commit", default="unknown")
    parser.add_argument("--program", default=str(ROOT / "build/release/bin/peerd"))
    options = parser.parse_args()
    objects, duration_s = (10, 10) if options.quick else (200, 60)
    variants = {"order2": None} if options.quick else {"order2": None, "best": ROOT / "configs/best.toml"}
    right, figures = True, {}
    for variant, overlay in variants.items():
        wrong, values = run(options.program, objects, duration_s, overlay)
        for line in wrong[:20]:
            print(f"WRONG: {variant}: {line}")
        if len(wrong) > 20:
            print(f"WRONG: {variant}: and {len(wrong) - 20} more")
        right = right and not wrong and values
        for what, (samples, unit) in values.items():
            low, middle, high = min(samples), statistics.median(samples), max(samples)
            print(f"{variant + '.' + what:<30} {middle:12.4g} {unit:<20} [{low:.4g} {high:.4g}]")
            figures[f"{variant}.{what}"] = {"value": middle, "unit": unit, "against": "", "ratio": None, "low": low,
                                            "high": high}
    if options.out:
        out = Path(options.out)
        out.mkdir(parents=True, exist_ok=True)
        machine = {"cores": os.cpu_count(), "commit": options.commit, "quick": options.quick}
        (out / "peers16.json").write_text(json.dumps({"machine": machine, "figures": figures}, indent=2) + "\n")
        with open(out / "peers16.csv", "w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["name", "value", "unit", "against", "ratio", "low", "high"])
            for figure, f in figures.items():
                table.writerow([figure, f["value"], f["unit"], "", "", f["low"], f["high"]])
    return 0 if right else 1


if __name__ == "__main__":
    sys.exit(main())
