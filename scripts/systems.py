"""What scripts/systems does once there is a program."""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
HZ = 60

# ---- worlds to find collisions in ----


def indexed_face_set(points, faces):
    coordinates = ", ".join(" ".join(f"{c:.7g}" for c in p) for p in points)
    indices = ", ".join(" ".join(str(i) for i in face) + " -1" for face in faces)
    return f"geometry IndexedFaceSet {{ solid FALSE coord Coordinate {{ point [ {coordinates} ] }} coordIndex [ {indices} ] }}"


def grid(rows, columns, point):
    """A closed surface of rows by columns quadrilaterals, cut to triangles: point(u, v) with u, v in [0, 1)."""
    points = [point(i / rows, j / columns) for i in range(rows) for j in range(columns)]
    faces = []
    for i in range(rows):
        for j in range(columns):
            a, b = i * columns + j, i * columns + (j + 1) % columns
            c, d = (i + 1) % rows * columns + (j + 1) % columns, (i + 1) % rows * columns + j
            faces += [(a, b, c), (a, c, d)]
    return points, faces


def torus(u, v):
    r = 1.0 + 0.35 * math.cos(2 * math.pi * v)
    return r * math.cos(2 * math.pi * u), 0.35 * math.sin(2 * math.pi * v), r * math.sin(2 * math.pi * u)


def gear(u, v):
    """A torus with twelve teeth: not convex in either direction."""
    teeth = 0.12 * math.copysign(1.0, math.sin(2 * math.pi * 12 * u))
    r = 1.0 + (0.3 + max(0.0, teeth) * max(0.0, math.cos(2 * math.pi * v))) * math.cos(2 * math.pi * v)
    return r * math.cos(2 * math.pi * u), 0.3 * math.sin(2 * math.pi * v), r * math.sin(2 * math.pi * u)


def knot(u, v):
    """A tube along a trefoil: close to itself, and far from its box and sphere."""
    t = 2 * math.pi * u
    place = lambda t: ((2 + math.cos(3 * t)) * math.cos(2 * t) / 3, (2 + math.cos(3 * t)) * math.sin(2 * t) / 3, math.sin(3 * t) / 3)
    x, ahead = place(t), place(t + 1e-4)
    way = [b - a for a, b in zip(x, ahead)]
    length = math.sqrt(sum(w * w for w in way))
    way = [w / length for w in way]
    side = (way[1], -way[0], 0.0)
    norm = math.hypot(*side) or 1.0
    side = [s / norm for s in side]
    up = [way[1] * side[2] - way[2] * side[1], way[2] * side[0] - way[0] * side[2], way[0] * side[1] - way[1] * side[0]]
    c, s = 0.15 * math.cos(2 * math.pi * v), 0.15 * math.sin(2 * math.pi * v)
    return tuple(p + c * a + s * b for p, a, b in zip(x, side, up))


MESHES = {"torus": (torus, 40, 24), "gear": (gear, 96, 24), "knot": (knot, 160, 16)}


def mesh_world(name):
    """A mesh turns, and passes through another one of its kind and out again."""
    point, rows, columns = MESHES[name]
    shape = indexed_face_set(*grid(rows, columns, point))
    return f"""#VRML V2.0 utf8
DEF STANDS Transform {{ children DEF MESH Shape {{ {shape} }} }}
DEF PASSES Transform {{ translation 3 0.4 0.3 children USE MESH }}
DEF CLOCK TimeSensor {{ cycleInterval 10 loop TRUE startTime 0 }}
DEF WAY PositionInterpolator {{ key [ 0 0.5 1 ] keyValue [ 3 0.4 0.3, -3 0.2 -0.3, 3 0.4 0.3 ] }}
DEF TURN OrientationInterpolator {{ key [ 0 0.33 0.67 1 ] keyValue [ 0 0.6 0.8 0, 0 0.6 0.8 2.1, 0 0.6 0.8 4.2, 0 0.6 0.8 6.28 ] }}
ROUTE CLOCK.fraction_changed TO WAY.set_fraction
ROUTE CLOCK.fraction_changed TO TURN.set_fraction
ROUTE WAY.value_changed TO PASSES.set_translation
ROUTE TURN.value_changed TO PASSES.set_rotation
CollisionInterest {{ objectPath "PASSES" interests [ "STANDS" ] collisionType 1 }}
"""


def crowd_world(count=100):
    """Boxes and tori that go to and fro on a square, each interested in all others."""
    small = indexed_face_set(*grid(12, 8, torus))
    bodies, routes, names = [], [], [f"BODY_{i}" for i in range(count)]
    for i in range(count):
        x, z = 4.0 * (i % 10) - 18.0, 4.0 * (i // 10) - 18.0
        shape = "USE SMALL" if i > 1 and i % 2 else "DEF SMALL Shape { " + small + " }" if i == 1 else "Shape { geometry Box { size 1.2 1.8 0.8 } }"
        dx, dz = 3.5 * math.cos(2.4 * i), 3.5 * math.sin(2.4 * i)
        bodies.append(f"DEF BODY_{i} Transform {{ translation {x:g} 0 {z:g} children {shape} }}")
        routes.append(f"DEF CLOCK_{i} TimeSensor {{ cycleInterval {6 + i % 7} loop TRUE startTime 0 }}\n"
                      f"DEF WAY_{i} PositionInterpolator {{ key [ 0 0.5 1 ] keyValue [ {x:g} 0 {z:g}, {x + dx:.4g} 0 {z + dz:.4g}, {x:g} 0 {z:g} ] }}\n"
                      f"ROUTE CLOCK_{i}.fraction_changed TO WAY_{i}.set_fraction\nROUTE WAY_{i}.value_changed TO BODY_{i}.set_translation")
    interests = [f'CollisionInterest {{ objectPath "{name}" interests [ {", ".join(json.dumps(n) for n in names[i + 1:])} ] collisionType 1 }}'
                 for i, name in enumerate(names[:-1])]
    return "#VRML V2.0 utf8\n" + "\n".join(bodies + routes + interests) + "\n"


# ---- the systems ----

COLLISION = [  # (engine, name, what it is)
    ("ours", "peerd", "wide trees of eight children by vector instructions; exact"),
    ("kdop", "Ohlenburg 2003, chapter 3", "binary trees of 18-DOPs by the rules that the thesis compares; exact here"),
    ("quickcd", "QuickCD", "Klosowski's trees of 18-DOPs, a triangle in each leaf; exact here"),
    ("obb", "RAPID", "trees of oriented boxes, 15 separating axes; exact here"),
    ("aabb", "SOLID's boxes", "trees of boxes along each object's axes; exact here"),
    ("sphere", "Hubbard", "sphere trees that answer alone, with space-time bounds: near is taken for a touch"),
    ("rapid-world", "V-COLLIDE", "sweep and prune over all objects, then RAPID; exact here"),
    ("i-collide", "I-COLLIDE", "convex pieces (here mostly single triangles: these meshes are not convex), sweep and prune, closest features from the last tick; exact here"),
    ("cylinders", "NPSNET", "heights and upright cylinders: volumes only"),
]
REPLICATION = [
    ("best", "peerd", "dead reckoning by the model that fits, remote collision prediction, close proximity (`configs/best.toml`)"),
    ("thesis", "Ohlenburg 2003, chapter 4", "second-order dead reckoning, remote collision prediction, adaptive tracking in close proximity"),
    ("dis", "DIS", "second-order dead reckoning by the standard's thresholds; no collision is predicted"),
    ("npsnet", "NPSNET", "first-order dead reckoning by the same thresholds, heights and cylinders at ticks"),
    ("position-history", "position history", "Singhal and Cheriton: positions alone travel; tracking and convergence by the last three"),
    ("dive", "DIVE", "every change goes out, to the group of its region"),
    ("lockstep", "Doom", "inputs of all to all; a tick waits for the slowest"),
    ("server-bare", "Quake", "a server simulates inputs; clients show its snapshots"),
    ("server", "Half-Life", "the same with client prediction, interpolation and lag compensation"),
    ("central", "a central authority (4.3)", "the server finds all collisions; clients show its state of each tick"),
]


def engine_part(peerd, folder, quick):
    """Rows of (engine, what, {world: result or None})."""
    worlds = {name: mesh_world(name) for name in MESHES} | {"hundred bodies": crowd_world()}
    known = {e["name"] for e in json.loads(run([peerd, "collide", "--engines", "--json"]))}
    until_s = 1.0 if quick else 10.0
    rows = []
    for world, text in worlds.items():
        (folder / f"{world.replace(' ', '-')}.wrl").write_text(text)
    for engine, name, what in COLLISION:
        if engine not in known:
            raise SystemExit(f"peerd knows no engine {engine}")
        results = {}
        for world in worlds:
            file = folder / f"{world.replace(' ', '-')}.wrl"
            results[world] = json.loads(run([peerd, "collide", file, "--until", str(until_s), "--hz", str(HZ), "--engine", engine,
                                             "--against", "ours", "--json"]))
        rows.append((engine, name, what, results))
    return rows


def replication_part(peerd, folder, quick):
    configs = [ROOT / "configs/best.toml"] + [ROOT / "configs/baselines" / f"{name}.toml" for name, _, _ in REPLICATION[1:]]
    results = {}
    for scenario in ("eq47", "crowd", "head-on"):
        command = [peerd, "compare", ROOT / f"configs/scenarios/{scenario}.toml", "--set", "network.latency_ms=100", "--json",
                   "--out", folder / scenario]
        if quick:
            command += ["--set", "duration_s=4"]
        for config in configs:
            command += ["--with", config]
        results[scenario] = {row["system"]: row for row in json.loads(run(command))["systems"]}
    return results


def run(command):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(str(w) for w in command)} ended with {done.returncode}:\n{done.stderr}")
    return done.stdout


# ---- the page ----


def number(value, digits=3):
    return "-" if value is None else f"{value:.{digits}g}" if abs(value) < 1e3 else f"{value:,.0f}"


def engine_table(rows):
    worlds = list(rows[0][3])
    lines = ["| system | `--engine` | what it is | " + " | ".join(worlds) + " | wrong answers |",
             "|---|---|---|" + "---|" * (len(worlds) + 1)]
    for engine, name, what, results in rows:
        cells = []
        for world in worlds:
            r, counters = results[world], results[world]["counters"]
            micros = r["tick_micros"]["median"]
            tests = (counters["bv_tests"] + counters["polygon_tests"]) / r["tick_micros"]["ticks"]
            cells.append(f"{number(micros)} us, {number(tests)} {'test' if tests == 1 else 'tests'}" if tests else f"{number(micros)} us")
        against = [results[world]["against"] for world in worlds]
        wrong = sum(a["false_touches"] + a["missed"] for a in against)
        asked = sum(a["questions"] for a in against)
        missed = sum(a["missed"] for a in against)
        verdict = f"0 of {asked:,}" if wrong == 0 else f"{wrong:,} of {asked:,}" + (f", {missed:,} missed" if missed else "")
        lines.append(f"| {name} | `{engine}` | {what} | " + " | ".join(cells) + f" | {verdict} |")
    return lines


def replication_table(results):
    lines = []
    for scenario, systems in results.items():
        lines += [f"### {scenario}, 100 ms each way", "",
                  "| system | `--with` | what it is | CPU [s] | bytes/s | error [m] | p99 [m] | views differ [m] | late: own [ms] | late: others [ms] | collisions: true, missed, false |",
                  "|---|---|---|---|---|---|---|---|---|---|---|"]
        for key, name, what in REPLICATION:
            r = systems[key]
            c = r["collisions"]
            lines.append(f"| {name} | `{key}` | {what} | {r['cpu_s']:.2f} | {r['bytes_per_s']:,.0f} | {number(r['shown_error_m'])} | "
                         f"{number(r['worst_p99_m'])} | {number(r['view_difference_m'])} | {number(r['own_delay_ms'], 4)} | "
                         f"{number(r['others_delay_ms'], 4)} | {c['truth']}, {c['missing']}, {c['spurious']} |")
        lines.append("")
    return lines


def page(engines, replication):
    lines = ["# The systems of the thesis, by name", "",
             "`scripts/systems` writes this page from one run. Chapter 2 of *Ohlenburg 2003* compares ways to find collisions and ways to share a world;",
             "each is here under a name, on the same worlds, with the same measures.", "",
             "## Ways to find collisions", "",
             "`peerd collide WORLD --until 10 --hz 60 --engine NAME --against ours`, on three meshes of which one turns and passes through another of its kind",
             f"({', '.join(f'{name}: {2 * rows * columns:,} triangles' for name, (_, rows, columns) in MESHES.items())}), and on a hundred bodies of which each is interested in all others. Times are of",
             "one shared machine, the median of the ticks at which some pair is asked about; tests are of volumes and of pairs of polygons, the mean of those ticks. A wrong answer",
             "is one that differs from ours, of all interests at all ticks.", ""]
    lines += engine_table(engines)
    lines += ["", "RAPID, QuickCD and SOLID answer in floating-point numbers; here their trees lead to the exact test of triangles, so that what is",
              "compared is the way there. `collision/engines/README.md` says what each leaves out.", "",
              "## Ways to share a world", "",
              "`peerd compare SCENARIO --set network.latency_ms=100 --with NAME`. *Error* is between what an observer shows and the truth of",
              "that instant, the mean over all views; *p99* is the worst view's. *Views differ*: between what an observer and the owner see. *Late* is how much",
              "later than true a picture is, at the least distance ([measures](reference/measures.md#systems-side-by-side)). *Collisions* are between objects of two peers, against the run without",
              "latency. CPU is of all computers of the run together, on one shared machine.", ""]
    lines += replication_table(replication)
    lines += ["## Special cases (sections 2.3 and 4.2.4)", "",
              "| system | here |", "|---|---|",
              "| distributed snooker (Sandoz and Sharkey) | balls follow strict rules, so all peers predict them: `peerd sim snooker` |",
              "| virtual tennis | a ball that is struck is a function of time until it is struck again: `peerd sim tennis` |",
              "| dead reckoning and position history for all else | the systems above |", ""]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--program", required=True)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        engines = engine_part(arguments.program, pathlib.Path(folder), arguments.quick)
        replication = replication_part(arguments.program, pathlib.Path(folder), arguments.quick)
    arguments.out.parent.mkdir(parents=True, exist_ok=True)
    arguments.out.write_text(page(engines, replication))
    print(arguments.out)


main()
