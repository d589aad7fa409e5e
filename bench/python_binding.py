#!/usr/bin/python3
"""Question: what does the Python package add to the calls of libpeerd that it makes: the poses of 10,000 objects, and their motions?

python_binding.py [--quick] [--out DIR] [--commit NAME] [--package DIR]: one real peer on lo owns 10,000 boxes and moves them. In each round
the function of C (peerd_poses, peerd_move, by ctypes, on arrays that are there already) and the method of Python (Peer.poses, Peer.move)
do the same to the same peer, in turns, each after a tick (of twenty a second, so that none falls into it); figures are medians of the rounds, those named "added" of the rounds' differences. Beside them: the
same poses one object at a time.

Exit code 1: Python's poses are not those of C, a motion was refused, or the boxes are not where they were moved.
Writes DIR/python.json and .csv.
"""
import argparse
import csv
import ctypes
import json
import os
import platform
import random
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
ADDED_MAX_MS = 0.2  # of poses and motions together
LIFT_M = 5.0        # above their places in the world's file
# A pose without a time has that of its arrival, from which a box goes on until the next one.
OFF_MAX_M = 0.2
GIVES_UP_S = 120.0


class Boxes:
    """A peer with boxes that it moves, each at a velocity of its own."""

    MOTION = np.dtype([("object", "u8"), ("pose", "f8", 7), ("velocity", "f8", 3), ("jumps", "i4"), ("reserved", "i4")])  # peerd_motion

    def __init__(self, peerd, count, folder):
        self.places = np.zeros((count, 7))
        self.places[:, 0], self.places[:, 2], self.places[:, 6] = 3.0 * (np.arange(count) % 100), 3.0 * (np.arange(count) // 100), 1.0
        names = [f"B{i}" for i in range(count)]
        (folder / "w.wrl").write_text("#VRML V2.0 utf8\n" + "".join(
            f"DEF {name} Transform {{ translation {x:g} 0 {z:g} children Shape {{ geometry Box {{ size 1 1 1 }} }} }}\n"
            for name, x, z in zip(names, self.places[:, 0], self.places[:, 2])))
        (folder / "s.toml").write_text(f'world = "w.wrl"\n[peer.bench]\nid = 1\nowns = {json.dumps(names)}\n[peer.bench.motion]\n' +
                                       "".join(f"{name} = {{ outside = true }}\n" for name in names))
        self.peer = peerd.Peer(config=folder / "s.toml", peer="bench", interface="lo", port=random.SystemRandom().randrange(20_000, 30_000),
                               open=True, take_over=True, set=["replication.tick_hz=20"])
        self.wait("the session", lambda: self.peer.in_session)
        self.objects = np.array([self.peer.find(name) for name in names], dtype=np.uint64)
        self.velocities = np.zeros((count, 3))
        self.velocities[:, 2] = 0.05 + 0.025 * (np.arange(count) % 11)
        self.began = self.peer.session_time
        self.poses, self.motions = self.places.copy(), np.zeros(count, self.MOTION)
        self.motions["object"], self.motions["velocity"] = self.objects, self.velocities
        self.advance()
        self.wait("the first motions", lambda: self.peer.move(self.objects, self.poses, self.velocities) == count)

    def wait(self, what, holds):
        give_up = time.monotonic() + GIVES_UP_S
        while not holds():
            if time.monotonic() > give_up or not self.peer.poll(0.005):
                sys.exit(f"error: not after {GIVES_UP_S} s: {what}")

    def rest(self):
        """Does what is due, so that no tick falls into what is timed."""
        ticks = self.peer.ask(do="status")["counters"]["ticks"]
        self.wait("a tick", lambda: self.peer.ask(do="status")["counters"]["ticks"] != ticks)

    def advance(self):
        self.poses[:, :3] = self.places[:, :3] + (self.peer.session_time - self.began) * self.velocities
        self.poses[:, 1] += LIFT_M
        self.motions["pose"] = self.poses

    def off_m(self, seen):
        return float(np.abs(seen[:, :3] - self.poses[:, :3]).max())


def library_of(package):
    """The library that the package is linked to, which is loaded already."""
    with open("/proc/self/maps") as maps:
        path = next(line.split()[-1] for line in maps if "/libpeerd.so" in line)
    library = ctypes.CDLL(path)
    library.peerd_poses.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p]
    library.peerd_move.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]
    library.peerd_poses.restype = library.peerd_move.restype = ctypes.c_size_t
    return library


def in_turns(rounds, before, by_c, by_python):
    """Milliseconds of both, one row a round."""
    took = np.zeros((rounds, 2))
    for number in range(rounds):
        for way in ((0, 1), (1, 0))[number % 2]:
            before()
            call = (by_c, by_python)[way]
            begin = time.perf_counter_ns()
            call()
            took[number, way] = (time.perf_counter_ns() - begin) / 1e6
    return took


class Figures:
    def __init__(self):
        self.rows = []

    def add(self, name, samples, against="", ratio=None):
        low, median, high = np.percentile(samples, (25, 50, 75))
        self.rows.append({"name": name, "value": median, "unit": "ms", "against": against, "ratio": ratio, "low": low, "high": high})
        print(f"{name:24} {median:9.4f} ms  ({low:.4f} to {high:.4f})")
        return float(median)

    def write(self, folder, commit, quick):
        folder.mkdir(parents=True, exist_ok=True)
        machine = {"cpu": cpu_model(), "cores": os.cpu_count(), "python": platform.python_version(), "numpy": np.__version__,
                   "commit": commit, "quick": quick}
        figures = {row["name"]: {key: row[key] for key in ("value", "unit", "against", "ratio")} for row in self.rows}
        (folder / "python.json").write_text(json.dumps({"machine": machine, "figures": figures}, indent=2) + "\n")
        with open(folder / "python.csv", "w", newline="") as out:
            table = csv.DictWriter(out, self.rows[0].keys())
            table.writeheader()
            table.writerows(self.rows)


def cpu_model():
    with open("/proc/cpuinfo") as info:
        return next((line.split(":", 1)[1].strip() for line in info if line.startswith("model name")), "unknown")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--commit", default="unknown")
    parser.add_argument("--package", type=Path, default=ROOT / "build/release/python")
    options = parser.parse_args()
    sys.path.insert(0, str(options.package))
    import peerd

    count, rounds = (200, 5) if options.quick else (10_000, 201)
    wrong = []
    with tempfile.TemporaryDirectory(prefix="peerd-python-") as made:
        boxes = Boxes(peerd, count, Path(made))
    peer, objects, library, handle = boxes.peer, boxes.objects, library_of(peerd), boxes.peer.handle
    by_c, by_python = np.zeros((count, 7)), np.zeros((count, 7))

    def expect(what, found):
        if found != count:
            wrong.append(f"{what}: {found} of {count}")

    figures = Figures()
    took = in_turns(rounds, boxes.rest,
                    lambda: expect("peerd_poses", library.peerd_poses(handle, objects.ctypes.data, count, by_c.ctypes.data)),
                    lambda: peer.poses(objects, out=by_python))
    figures.add("poses.c", took[:, 0])
    figures.add("poses.python", took[:, 1], "poses.c", float(np.median(took[:, 1]) / np.median(took[:, 0])))
    added = figures.add("poses.added", took[:, 1] - took[:, 0])
    one_by_one = in_turns(min(rounds, 5), boxes.rest, lambda: None, lambda: [peer.pose(each) for each in objects.tolist()])
    figures.add("poses.one_by_one", one_by_one[:, 1], "poses.c", float(np.median(one_by_one[:, 1]) / np.median(took[:, 0])))

    def before_motions():
        boxes.rest()
        boxes.advance()

    took = in_turns(rounds, before_motions,
                    lambda: expect("peerd_move", library.peerd_move(handle, boxes.motions.ctypes.data, count)),
                    lambda: expect("Peer.move", peer.move(objects, boxes.poses, boxes.velocities)))
    figures.add("move.c", took[:, 0])
    figures.add("move.python", took[:, 1], "move.c", float(np.median(took[:, 1]) / np.median(took[:, 0])))
    added += figures.add("move.added", took[:, 1] - took[:, 0])
    figures.add("added", [added], "" if options.quick else f"target: {ADDED_MAX_MS} ms", None if options.quick else added / ADDED_MAX_MS)

    time.sleep(0.1)  # a picture is not later than the tick that is due, so that both are of that instant
    library.peerd_poses(handle, objects.ctypes.data, count, by_c.ctypes.data)
    peer.poses(objects, out=by_python)
    if not np.array_equal(by_c, by_python):
        wrong.append("Python's poses are not those of C")
    if not boxes.off_m(by_python) < OFF_MAX_M:
        wrong.append(f"boxes are off by {boxes.off_m(by_python)} m")
    for what in wrong[:20]:
        print("WRONG:", what)
    if options.out:
        figures.write(options.out, options.commit, options.quick)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
