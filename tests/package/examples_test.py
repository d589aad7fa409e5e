#!/usr/bin/env python3
"""examples_test.py BUILD SCRATCH SOURCE: installs peerd, builds the programs of examples/ against that, by CMake and by pkg-config,
and lets each of them meet another peer: cubes that touch, a swarm that somebody watches, two engines whose balls collide."""
import bisect
import collections
import contextlib
import math
import os
import random
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

STRICT = "-Wall -Wextra -Wpedantic -Wshadow -Werror"
GIVES_UP_S = 60.0
BIRDS = 200


def run(*command, **more):
    return subprocess.run([str(word) for word in command], check=True, **more)


class Programs:
    def __init__(self, folder, scratch, source):
        self.scratch, self.source = scratch, source
        self.prefix = scratch / "prefix"
        run("cmake", "--install", folder, "--prefix", self.prefix, stdout=subprocess.DEVNULL)
        for name in ("cube", "swarm", "bridge"):
            self.build(source / "examples" / name)
        self.build(source / "tests/package/watch")
        package = next(self.prefix.rglob("libpeerd.pc")).parent
        flags = run("pkg-config", "--cflags", "--libs", "libpeerd", text=True, capture_output=True,
                    env=os.environ | {"PKG_CONFIG_PATH": str(package)}).stdout.split()
        run("c++", "-std=c++17", *STRICT.split(), "-o", scratch / "cube_by_pkg_config", source / "examples/cube/cube.cpp", *flags,
            f"-Wl,-rpath,{package.parent}")

    def build(self, folder):
        into = self.scratch / folder.name
        run("cmake", "-S", folder, "-B", into, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}", f"-DCMAKE_CXX_FLAGS=-O1 {STRICT}",
            stdout=subprocess.DEVNULL)
        run("cmake", "--build", into, stdout=subprocess.DEVNULL)

    @contextlib.contextmanager
    def running(self, program, *arguments, user="ada"):
        """A process that reads keys from a pipe and writes to a file; each user has keys of their own."""
        output = self.scratch / f"{random.SystemRandom().randrange(10**9)}.txt"
        with output.open("w") as file:
            process = subprocess.Popen([str(word) for word in (program, *arguments)], stdin=subprocess.PIPE, stdout=file,
                                       stderr=subprocess.STDOUT, env=os.environ | {"XDG_CONFIG_HOME": str(self.scratch / user)})
        process.said = output.read_text
        try:
            yield process
        finally:
            process.kill()
            process.wait()


def wait_for(what, holds, *processes):
    """Waits for as long as it may take; what does not come in a minute does not come. `processes` go on meanwhile."""
    give_up = time.monotonic() + GIVES_UP_S
    while not (found := holds()):
        ended = [process for process in processes if process.poll() not in (None, 0)]
        if ended or time.monotonic() > give_up:
            raise SystemExit(f"{what}: does not happen\n" + "\n".join(f"{p.args}\n{p.said()}" for p in processes))
        time.sleep(0.05)
    return found


def own_options():
    port = random.SystemRandom().randrange(20_000, 30_000)
    return f"example-{port}", ("interface", "lo", "port", port, "take-over", "yes")


def check_cubes(programs):
    """Ada's cube is driven by arrow keys against Bob's, who joins by Ada's invitation, and has no file. Both see it."""
    world, options = own_options()
    file = programs.source / "examples/cube/cube.wrl"
    with programs.running(programs.scratch / "cube/cube", file, "LEFT", *options, "world-name", world) as ada:
        wait_for("Ada drives", lambda: "drives LEFT" in ada.said(), ada)
        said = run(next(programs.prefix.rglob("bin/peerd")), "invite", world, text=True, capture_output=True,
                   env=os.environ | {"XDG_CONFIG_HOME": str(programs.scratch / "ada")}).stdout
        invitation = re.search(r"peerd-invite-\S+", said).group()
        with programs.running(programs.scratch / "cube_by_pkg_config", world, "MIDDLE", "interface", "lo", "invite", invitation,
                              user="bob") as bob:
            wait_for("Bob drives", lambda: "drives MIDDLE" in bob.said(), ada, bob)
            peer_of_bob = re.search(r"peer (\d+) drives", bob.said()).group(1)

            def push():
                ada.stdin.write(b"\033[C")
                ada.stdin.flush()
                contact = re.search(rf"LEFT touches MIDDLE of peer {peer_of_bob} at (\S+) s; peer (\d+)", ada.said())
                return contact and f"MIDDLE touches LEFT of peer {re.search(r'peer (.*) drives', ada.said()).group(1)} at " \
                    f"{contact.group(1)} s; peer {contact.group(2)} has found it" in bob.said()

            wait_for("both see the contact", push, ada, bob)
            ada.stdin.write(b"q")
            ada.stdin.close()
            wait_for("Ada leaves", lambda: ada.poll() == 0, ada)
            print(ada.said(), bob.said(), sep="")


def check_swarm(programs):
    """Another peer sees all birds fly, and where they were at that time."""
    world, options = own_options()
    trace = programs.scratch / "trace.txt"
    with programs.running(programs.scratch / "swarm/swarm", programs.scratch / "swarm.wrl", BIRDS, *options, "world-name", world,
                          "trace", trace) as swarm:
        wait_for("the swarm flies", lambda: "birds: " in swarm.said(), swarm)
        with programs.running(programs.scratch / "watch/watch", world, BIRDS, 60, "interface", "lo") as watch:
            wait_for("somebody watches", lambda: watch.poll() == 0, swarm, watch)
            seen = [line.split() for line in watch.said().splitlines()]
        last = float(seen[-1][0])
        wait_for("the trace is written", lambda: float(trace.read_text().rpartition("\n")[0].rpartition("\n")[2].split()[0]) > last, swarm)
        print(swarm.said().splitlines()[-1])
    frames = collections.defaultdict(list)
    for line in trace.read_text().rpartition("\n")[0].splitlines():
        at, bird, *numbers = line.split()
        frames[f"BIRD_{bird}"].append([float(at), *map(float, numbers)])
    errors, paths = [], collections.defaultdict(list)
    for at, bird, *place in seen:
        known, place = frames[bird], [float(each) for each in place]
        at_s, x, y, z, *velocity = known[max(bisect.bisect(known, [float(at), math.inf]) - 1, 0)]
        errors.append(math.dist(place, [p + v * (float(at) - at_s) for p, v in zip((x, y, z), velocity)]))
        paths[bird].append(place)
    errors.sort()
    middle, most = errors[len(errors) // 2], errors[len(errors) * 95 // 100]
    print(f"{len(paths)} birds seen {len(errors)} times: half of them within {middle:.3f} m, 95 of 100 within {most:.3f} m")
    still = [bird for bird, places in paths.items() if math.dist(places[0], places[-1]) < 0.1]
    if len(paths) != BIRDS or still or middle > 0.1 or most > 0.5:  # in these three seconds they fly six metres and more
        raise SystemExit(f"that is not where they were; {still} have not moved")


def check_bridge(programs):
    """Two engines agree on when their balls met, on who has decided it and on the impulse, and go on by it."""
    _, options = own_options()
    file = programs.source / "examples/bridge/bridge.wrl"
    program = programs.scratch / "bridge/bridge"
    with programs.running(program, file, "BALL", *options) as ball, programs.running(program, file, "TARGET", *options) as target:
        wait_for("both end", lambda: ball.poll() == target.poll() == 0, ball, target)
        said = [ball.said(), target.said()]
    print(*said, sep="")
    contacts = [re.findall(r"contact at .*", each) for each in said]
    if contacts[0] != contacts[1] or len(contacts[0]) != 1:
        raise SystemExit("they do not agree on the contact")
    contact_s = float(re.search(r"at (\S+) s", contacts[0][0]).group(1))
    for text, velocity, sign in zip(said, (-0.8, 1.9), (1, -1)):  # of 1 kg at 3 m/s against 2 kg, with restitution 0.9
        goes, at_s, apart = map(float, re.search(r"with (\S+) m/s; at (\S+) s the other one is (\S+) m", text).groups())
        expected = sign * (1.0 + 2.7 * (at_s - contact_s))
        if abs(goes - velocity) > 0.01 or abs(apart - expected) > 0.2:
            raise SystemExit(f"it goes with {goes} m/s, not {velocity}, or sees the other one {apart} m away, not {expected:.3f}")


def main():
    folder, scratch, source = (Path(word).resolve() for word in sys.argv[1:])
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    programs = Programs(folder, scratch, source)
    for check in (check_cubes, check_swarm, check_bridge):
        check(programs)


if __name__ == "__main__":
    main()
