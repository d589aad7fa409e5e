#!/usr/bin/env python3
"""Writes a world of many boxes and a scenario for `peerd sim`: does its memory stay bounded?

many_objects.py DIR [--objects N] [--walking M] [--duration S]: N boxes (default 100,000) stand on a grid. Peer a runs them
all and peer b observes them. The first M (default 1,000) walk about, the others fly apart at a constant velocity, so that
every box has an error to measure. Then, for example,

    /usr/bin/time -v peerd sim DIR/many.toml --out DIR/out

and "Maximum resident set size" is what is asked for. No box is tested for collisions.
"""
import argparse
import math
from pathlib import Path

SCENARIO = """world = "many.wrl"
duration_s = {duration}

[network]
latency_ms = 50

[peer.a]
id = 1
owns = ["WALKER_*", "FLYER_*"]

[peer.b]
id = 2

[motion."WALKER_*".walk]
speed_m_s = 1.3
within_m = [-{half}, -{half}, {half}, {half}]

[motion."FLYER_*".physics]
velocity = [0.5, 0, 0.25]
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dir", type=Path)
    parser.add_argument("--objects", type=int, default=100_000)
    parser.add_argument("--walking", type=int, default=1_000)
    parser.add_argument("--duration", type=float, default=60.0)
    options = parser.parse_args()
    options.dir.mkdir(parents=True, exist_ok=True)
    side = math.ceil(math.sqrt(options.objects))
    with open(options.dir / "many.wrl", "w", encoding="utf-8") as world:
        world.write("#VRML V2.0 utf8\n")
        world.write("DEF FIRST Transform { children DEF BOX Shape { geometry Box { size 0.5 0.5 0.5 } } }\n")
        for i in range(options.objects):
            kind = "WALKER" if i < options.walking else "FLYER"
            x, z = i % side - side // 2, i // side - side // 2
            world.write(f"DEF {kind}_{i} Transform {{ translation {x} 0.25 {z} children USE BOX }}\n")
    (options.dir / "many.toml").write_text(SCENARIO.format(duration=options.duration, half=side // 2 + 10), encoding="utf-8")


if __name__ == "__main__":
    main()
