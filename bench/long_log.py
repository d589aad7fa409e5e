#!/usr/bin/env python3
"""Question: what do many operations in the log of a world cost: an edit, the memory, a start from the store, a join?

long_log.py [--quick] [--out DIR] [--commit NAME] [--program PEERD] [--operations N]: one peer with a store on lo sets fields of a
hundred boxes by its control socket, N times in all; at each tenth of that the program reads the memory of the peer and the time
that an edit took. Then a second peer without a file joins, the first one begins again from its store, and both are asked for
their scene.

Exit code 1: a scene was another one. Writes DIR/long_log.json and .csv.
"""
import argparse
import csv
import json
import os
import re
import signal
import socket
import sys
import tempfile
import time
from pathlib import Path

BOXES = 100
WINDOW = 50  # edits that are asked for before the first reply is read


class Peer:
    def __init__(self, program, folder, name, words):
        self.socket, self.log = folder / f"{name}.sock", folder / f"{name}.log"
        self.command = [program, *words, "--name", name, "--interface", "lo", "--control", str(self.socket), "--store",
                        str(folder / f"{name}.store")]
        self.pid = None

    def start(self):
        """Seconds until it has joined a session."""
        output = os.open(self.log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        begun = time.monotonic()
        self.pid = os.posix_spawn(self.command[0], self.command, os.environ,
                                  file_actions=[(os.POSIX_SPAWN_DUP2, output, 1), (os.POSIX_SPAWN_DUP2, output, 2)])
        os.close(output)
        while time.monotonic() - begun < 120:
            if os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT):
                break
            try:
                if self.ask({"do": "status"})["session"]["joined"]:
                    return time.monotonic() - begun
            except (OSError, ValueError):
                pass
            time.sleep(0.005)
        raise OSError("it does not begin: " + self.log.read_text()[-400:])

    def ask(self, *requests):
        """The last reply."""
        with socket.socket(socket.AF_UNIX) as s:
            s.settimeout(60)
            s.connect(str(self.socket))
            replies = s.makefile()
            waiting = 0
            for request in requests:
                s.sendall(json.dumps(request).encode() + b"\n")
                waiting += 1
                if waiting == WINDOW:
                    json.loads(replies.readline())
                    waiting -= 1
            reply = None
            for _ in range(waiting):
                reply = json.loads(replies.readline())
            return reply

    def memory_mib(self):
        status = dict(line.split(":", 1) for line in Path(f"/proc/{self.pid}/status").read_text().splitlines())
        return (int(status["VmRSS"].split()[0]) - int(status["RssFile"].split()[0])) / 1024

    def stop(self, how=signal.SIGTERM):
        if self.pid is not None:
            os.kill(self.pid, how)
            os.wait4(self.pid, 0)
            self.pid = None


def edits(begin, end):
    for i in range(begin, end):
        value = f"{i % 37 - 18} {i % 5} {i * 7 % 41 - 20}"
        yield {"do": "set", "path": f"B{i % BOXES}", "field": "translation", "value": value}


def digest_of(peer):
    return peer.ask({"do": "world"})["world"]


def run(options, folder):
    (folder / "w.wrl").write_text("#VRML V2.0 utf8\n" + "\n".join(
        f"DEF B{i} Transform {{ translation {i % 10} 0 {i // 10} children Shape {{ geometry Box {{ size 0.2 0.2 0.2 }} }} }}"
        for i in range(BOXES)) + "\n")
    name = f"long-log-{os.getpid()}"
    port = str(20000 + os.getpid() * 37 % 12000)
    words = ["run", "--world", str(folder / "w.wrl"), "--port", port, "--world-name", name]
    first, second = Peer(options.program, folder, "first", words), Peer(options.program, folder, "second", ["join", name])
    rows, wrong = [], []
    try:
        first.start()
        rows.append((0, round(first.memory_mib(), 2), 0.0))
        step = max(1, options.operations // 10)
        for begin in range(0, options.operations, step):
            begun = time.monotonic()
            reply = first.ask(*edits(begin, min(options.operations, begin + step)))
            took = time.monotonic() - begun
            if not reply.get("done"):
                raise OSError(f"an edit was refused: {reply}")
            rows.append((begin + step, round(first.memory_mib(), 2), round(took / step * 1e6, 1)))
        while not first.ask({"do": "operation", **reply["operation"]})["applied"]:
            time.sleep(0.01)
        world = digest_of(first)
        joined_s = second.start()
        got = re.search(r"in ([0-9.]+) s", second.log.read_text())
        time.sleep(1)
        if digest_of(second) != world:
            wrong.append("the peer that joined has another scene")
        first.stop()
        again_s = first.start()
        if digest_of(first) != world:
            wrong.append("the peer that began again has another scene")
        store = sum(f.stat().st_size for f in (folder / "first.store").iterdir())
        figures = {"operations": options.operations, "memory [MiB]": rows[-1][1], "an edit [us]": rows[-1][2],
                   "bytes of an operation in memory": round((rows[-1][1] - rows[0][1]) * 2**20 / options.operations),
                   "store [MiB]": round(store / 2**20, 2), "join until in the session [s]": round(joined_s, 2),
                   "of that getting the logs [s]": float(got[1]) if got else None,
                   "start from the store until in the session [s]": round(again_s, 2),
                   "memory after the start [MiB]": round(first.memory_mib(), 2)}
    finally:
        for peer in (first, second):
            peer.stop(signal.SIGKILL)
    return wrong, figures, rows


def main():
    root = Path(__file__).resolve().parents[1]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path, default=root / "out/bench")
    parser.add_argument("--commit", default="unknown")
    parser.add_argument("--program", default=str(root / "build/release/bin/peerd"))
    parser.add_argument("--operations", type=int, default=100_000)
    options = parser.parse_args()
    if options.quick:
        options.operations = min(options.operations, 1000)
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="peerd-long-log-") as made:
        wrong, figures, rows = run(options, Path(made))
    for name, value in figures.items():
        print(f"{name}: {value}")
    for what in wrong:
        print("WRONG:", what)
    (options.out / "long_log.json").write_text(json.dumps({"commit": options.commit, "wrong": wrong, **figures}, indent=1) + "\n")
    with open(options.out / "long_log.csv", "w", newline="") as out:
        csv.writer(out).writerows([("operations", "MiB", "us an edit"), *rows])
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
