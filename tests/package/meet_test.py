#!/usr/bin/env python3
"""meet_test.py BUILD SCRATCH EXAMPLE: installs peerd, builds the programs of EXAMPLE against that by CMake and by pkg-config, and
lets each pair of them meet: both drive a ball of their own, and both must see the contact."""
import itertools
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

STRICT = "-Wall -Wextra -Wpedantic -Werror"


def run(*command, **more):
    return subprocess.run([str(word) for word in command], check=True, **more)


def build(folder, scratch, example):
    prefix = scratch / "prefix"
    run("cmake", "--install", folder, "--prefix", prefix, stdout=subprocess.DEVNULL)
    run("cmake", "-S", example, "-B", scratch / "build", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}",
        f"-DCMAKE_C_FLAGS=-std=c99 {STRICT}", f"-DCMAKE_CXX_FLAGS={STRICT}", stdout=subprocess.DEVNULL)
    run("cmake", "--build", scratch / "build", stdout=subprocess.DEVNULL)
    package = next(prefix.rglob("libpeerd.pc")).parent
    flags = run("pkg-config", "--cflags", "--libs", "libpeerd", text=True, capture_output=True,
                env=os.environ | {"PKG_CONFIG_PATH": str(package)}).stdout.split()
    by_pkg_config = scratch / "meet_by_pkg_config"
    run("cc", "-std=c99", *STRICT.split(), "-o", by_pkg_config, example / "meet.c", *flags, "-lm",
        f"-Wl,-rpath,{package.parent}")
    return [scratch / "build/meet_c", scratch / "build/meet_cpp", by_pkg_config]


def meet(left, right, example):
    """What the two say."""
    port = random.SystemRandom().randrange(20_000, 30_000)
    peers = []
    for program, ball in ((left, "LEFT"), (right, "RIGHT")):
        command = [program, example / "meet.wrl", ball, "interface", "lo", "port", port, "take-over", "yes"]
        peers.append(subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE,
                                      stderr=subprocess.STDOUT, text=True))
    said = []
    try:
        for peer in peers:
            said.append(peer.communicate(timeout=30)[0])
    finally:
        for peer in peers:
            peer.kill()
    for peer, ball, text in zip(peers, ("LEFT", "RIGHT"), said):
        if peer.returncode != 0 or f"{ball} met the other ball at x = " not in text:
            raise SystemExit(f"{ball} of {left.name} and {right.name} ended with {peer.returncode}: {text}")
    if ("this peer has decided it" in said[0]) == ("this peer has decided it" in said[1]):
        raise SystemExit(f"not one peer has decided it: {said}")
    return said


def main():
    folder, scratch, example = (Path(word).resolve() for word in sys.argv[1:])
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    os.environ["XDG_CONFIG_HOME"] = str(scratch / "settings")
    for left, right in itertools.pairwise(programs := build(folder, scratch, example)):
        print(*meet(left, right, example), sep="")
    print(f"{len(programs)} programs have met")


if __name__ == "__main__":
    main()
