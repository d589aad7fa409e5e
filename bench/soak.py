#!/usr/bin/env python3
"""Question: does a world stay whole, and do its peers stay small, while they come, go, crash and edit for an hour?

soak.py [--quick] [--out DIR] [--commit NAME] [--program PEERD] [--hours H] [--peers N]: N peers with stores over multicast on
lo. Four of them stay; of the others one each few seconds leaves, is killed, or comes back. Peers add boxes that move, set, take,
release and remove them, one edit in two seconds, so that some thirty are there.

Memory is what is private to each peer that stays (VmRSS less RssFile and RssShmem), read every 10 s; its growth is the slope of
a line through the last three quarters (Theil and Sen). Descriptors are counted in /proc/PID/fd. At the end all peers must have
one scene; then all are killed, and every store must have every edit that any peer had acknowledged.

Exit code 1: that was not so, or the number of descriptors grew. Writes DIR/soak.json
and .csv.
"""
import argparse
import csv
import json
import os
import random
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STAY = 4
BOXES = 30
EDITS_PER_S = 0.5
SAMPLE_S = 10.0
WORLD = """#VRML V2.0 utf8
DEF GROUND Transform { translation 0 -2 0 children Shape { geometry Box { size 60 1 60 } } }
"""


class Peer:
    """One peerd process after the other, of one name and store."""

    def __init__(self, program, folder, number, port):
        self.program, self.folder, self.number, self.port = program, folder, number, port
        self.name = f"p{number}"
        self.socket = folder / f"{self.name}.sock"
        self.log, self.store = folder / f"{self.name}.log", folder / f"{self.name}.store"
        self.pid = None
        self.starts = 0

    def start(self):
        self.starts += 1
        command = [self.program, "run", "--config", str(self.folder / "s.toml"), "--peer", self.name, "--interface", "lo",
                   "--port", str(self.port), "--control", str(self.socket), "--store", str(self.store)]
        output = os.open(self.log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)
        self.pid = os.posix_spawn(self.program, command, os.environ,
                                  file_actions=[(os.POSIX_SPAWN_DUP2, output, 1), (os.POSIX_SPAWN_DUP2, output, 2)])
        os.close(output)

    def ends(self, how):
        os.kill(self.pid, how)
        _, status, _ = os.wait4(self.pid, 0)
        self.pid = None
        return status

    def has_ended(self):
        if self.pid is None:
            return False
        return os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None

    def ask(self, request, timeout_s=5):
        with socket.socket(socket.AF_UNIX) as s:
            s.settimeout(timeout_s)
            s.connect(str(self.socket))
            s.sendall(json.dumps(request).encode() + b"\n")
            return json.loads(s.makefile().readline())

    def is_up(self):
        try:
            return self.pid is not None and self.ask({"do": "status"})["session"]["joined"]
        except (OSError, ValueError):
            return False

    def private_kib(self):
        status = dict(line.split(":", 1) for line in Path(f"/proc/{self.pid}/status").read_text().splitlines())
        kib = {key: int(status[key].split()[0]) for key in ("VmRSS", "RssFile", "RssShmem")}
        return kib["VmRSS"] - kib["RssFile"] - kib["RssShmem"]

    def descriptors(self):
        return len(os.listdir(f"/proc/{self.pid}/fd"))


class Soak:
    def __init__(self, peers, seed):
        self.peers, self.random = peers, random.Random(seed)
        self.boxes = {}  # name -> whether its last edit was acknowledged
        self.made = 0
        self.edits = {"asked": 0, "done": 0, "refused": 0, "unanswered": 0}
        self.acknowledged = []  # (author, number, what)

    def edit(self):
        up = [p for p in self.peers if p.pid is not None]
        peer = self.random.choice(up)
        kind = self.random.random()
        if len(self.boxes) < BOXES / 2 or (kind < 0.3 and len(self.boxes) < BOXES):
            self.made += 1
            box = f"B{self.made}"
            x, z = (self.random.uniform(-25, 25) for _ in range(2))
            text = (f"DEF {box} Transform {{ translation {x:.2f} 0 {z:.2f} velocityVector {x / 10:.2f} 0 {z / 10:.2f} children "
                    f"Shape {{ geometry Box {{ size 1 1 1 }} }} }}")
            self.do(peer, {"do": "add", "text": text}, box)
            return
        box = self.random.choice(sorted(self.boxes))
        if kind < 0.55:
            value = " ".join(f"{self.random.uniform(-25, 25):.2f}" if i != 1 else "0" for i in range(3))
            self.do(peer, {"do": "set", "path": box, "field": "translation", "value": value}, box)
        elif kind < 0.7:
            self.do(peer, {"do": "own", "path": box}, box)
        elif kind < 0.8:
            self.do(peer, {"do": "release", "path": box}, box)
        else:
            self.do(peer, {"do": "remove", "path": box}, box)

    def do(self, peer, request, box):
        self.edits["asked"] += 1
        try:
            reply = peer.ask(request)
        except (OSError, ValueError):
            self.edits["unanswered"] += 1
            return
        if not reply.get("ok") or "operation" not in reply:
            self.edits["refused"] += 1
            return
        self.edits["done"] += 1
        if request["do"] == "add":
            self.boxes[box] = True
        elif request["do"] == "remove":
            self.boxes.pop(box, None)
        state = self.acknowledgement(peer, reply["operation"])
        if state is not None:
            self.acknowledged.append((reply["operation"]["author"], reply["operation"]["number"], request["do"], box))

    @staticmethod
    def acknowledgement(peer, operation):
        """The reply that says that it outlives this process; None: that was not said in time."""
        for _ in range(20):
            try:
                state = peer.ask({"do": "operation", **operation})
            except (OSError, ValueError):
                return None
            if state.get("stored") or state.get("held"):
                return state
            time.sleep(0.02)
        return None

    def flap(self):
        peer = self.random.choice(self.peers[STAY:])
        if peer.pid is None:
            peer.start()
        else:
            peer.ends(self.random.choice([signal.SIGKILL, signal.SIGTERM]))


def slope_per_hour(samples):
    """(seconds, KiB) -> MiB an hour, of the last three quarters: the median of the slopes of all pairs."""
    rest = samples[len(samples) // 4:]
    step = max(1, len(rest) // 120)
    rest = rest[::step]
    slopes = [(b[1] - a[1]) / (b[0] - a[0]) for i, a in enumerate(rest) for b in rest[i + 1:] if b[0] > a[0]]
    return statistics.median(slopes) * 3600 / 1024 if slopes else 0.0


def end_state(peers, soak):
    """What is wrong with the scenes and the logs at the end."""
    wrong = []
    until = time.monotonic() + 15
    while time.monotonic() < until:
        worlds = [p.ask({"do": "world"}).get("world") for p in peers]
        if all(w == worlds[0] for w in worlds):
            break
        time.sleep(0.25)
    else:
        wrong.append("the peers have not one scene")
    time.sleep(0.5)  # stores have what others wrote within 100 ms
    for peer in peers:
        peer.ends(signal.SIGKILL)
        check = subprocess.run([peer.program, "store", "check", str(peer.store), "--json"], capture_output=True, text=True)
        if check.returncode != 0:
            wrong.append(f"the store of {peer.name}: {check.stderr.strip()}")
            continue
        has = {log["author"]: log["operations"] for log in json.loads(check.stdout)["logs"]}
        for author, number, what, box in soak.acknowledged:
            if has.get(author, 0) < number:
                wrong.append(f"the store of {peer.name} lacks {what} {box}, operation {author}:{number}")
    return wrong


def run(options, folder):
    (folder / "w.wrl").write_text(WORLD)
    lines = ['world = "w.wrl"'] + [f"[peer.p{i + 1}]\nid = {i + 1}" for i in range(options.peers)]
    (folder / "s.toml").write_text("\n".join(lines) + "\n")
    port = 20000 + os.getpid() * 37 % 12000
    peers = [Peer(options.program, folder, i + 1, port) for i in range(options.peers)]
    soak = Soak(peers, options.seed)
    memory, descriptors = {p.name: [] for p in peers[:STAY]}, {p.name: [] for p in peers[:STAY]}
    wrong = []
    try:
        for peer in peers:
            peer.start()
        while not all(p.is_up() for p in peers):
            if any(p.has_ended() for p in peers):
                raise OSError("a peer has ended: " + peers[0].log.read_text()[-400:])
            time.sleep(0.1)
        begun = time.monotonic()
        next_edit, next_flap, next_sample = begun, begun + 5, begun
        while time.monotonic() - begun < options.hours * 3600:
            now = time.monotonic()
            if now >= next_edit:
                soak.edit()
                next_edit += 1 / EDITS_PER_S
            if now >= next_flap:
                soak.flap()
                next_flap += soak.random.uniform(2, 8)
            if now >= next_sample:
                for peer in peers[:STAY]:
                    memory[peer.name].append((now - begun, peer.private_kib()))
                    descriptors[peer.name].append(peer.descriptors())
                next_sample += SAMPLE_S
            if any(p.has_ended() for p in peers):
                raise OSError("a peer has ended by itself")
            time.sleep(max(0.0, min(next_edit, next_flap, next_sample) - time.monotonic()))
        for peer in peers:
            if peer.pid is None:
                peer.start()
        until = time.monotonic() + 10
        while not all(p.is_up() for p in peers) and time.monotonic() < until:
            time.sleep(0.1)
        time.sleep(3)
        wrong += end_state(peers, soak)
    except OSError as error:
        wrong.append(repr(error))
    finally:
        logs = sum((p.log.read_text().count("\n") for p in peers if p.log.exists()))
        for peer in peers:
            if peer.pid is not None:
                peer.ends(signal.SIGKILL)
    grown = {name: slope_per_hour(samples) for name, samples in memory.items()}
    for name, counts in descriptors.items():
        if counts and max(counts[len(counts) // 2:]) > max(counts[:max(1, len(counts) // 2)]):
            wrong.append(f"{name} has had {max(counts)} descriptors, and {max(counts[:len(counts) // 2 or 1])} in the first half")
    figures = {"hours": options.hours, "peers": options.peers, "starts": sum(p.starts for p in peers), **soak.edits,
               "acknowledged": len(soak.acknowledged), "log lines": logs,
               "memory at the end [MiB]": {n: round(s[-1][1] / 1024, 2) for n, s in memory.items() if s},
               "growth [MiB/h]": {n: round(g, 2) for n, g in grown.items()},
               "descriptors at most": {n: max(c) for n, c in descriptors.items() if c}}
    return wrong, figures, memory


def main():
    root = Path(__file__).resolve().parents[1]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path, default=root / "out/bench")
    parser.add_argument("--commit", default="unknown")
    parser.add_argument("--program", default=str(root / "build/release/bin/peerd"))
    parser.add_argument("--hours", type=float, default=1.0)
    parser.add_argument("--peers", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.quick:
        options.hours = min(options.hours, 20 / 3600)
    if options.peers <= STAY:
        parser.error(f"--peers must be more than {STAY}, which stay")
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="peerd-soak-") as made:
        wrong, figures, memory = run(options, Path(made))
    for name, value in figures.items():
        print(f"{name}: {value}")
    for what in wrong[:20]:
        print("WRONG:", what)
    (options.out / "soak.json").write_text(json.dumps({"commit": options.commit, "wrong": wrong, **figures}, indent=1) + "\n")
    with open(options.out / "soak.csv", "w", newline="") as out:
        table = csv.writer(out)
        table.writerow(["seconds", *memory])
        for row in zip(*memory.values()):
            table.writerow([round(row[0][0]), *(kib for _, kib in row)])
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
