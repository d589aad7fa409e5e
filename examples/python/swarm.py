# %% [markdown]
# # A swarm: hundreds of objects that numpy drives
#
# Each frame computes where all objects are, as one array, and says so in one call. Other peers see them fly;
# `observer.py`, in a second terminal, plots how well:
#
#     python3 swarm.py [--quick] [--count 300] [--seconds 60] [--interface lo] [--port 47800] [--name swarm] [--out swarm.png]
#
# It needs the packages python3-peerd, python3-matplotlib and python3-numpy.

# %% Options
import argparse
import json
import tempfile
import time
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # a picture in a file, also where there is no screen; in a notebook leave this out
import matplotlib.pyplot as plt
import numpy as np

import peerd
from flight import RADIUS_M, Flight

parser = argparse.ArgumentParser(description="Hundreds of objects, driven by numpy at 60 Hz.")
parser.add_argument("--quick", action="store_true", help="few objects, for 4 s")
parser.add_argument("--count", type=int, default=300, help="objects")
parser.add_argument("--seconds", type=float, default=60.0)
parser.add_argument("--threshold", type=float, default=0.05, help="an update goes out where a ghost is off by so much [m]")
parser.add_argument("--seed", type=int, default=1, help="of their ways")
parser.add_argument("--interface", default="lo", help="of the network; lo: this computer alone")
parser.add_argument("--port", type=int, help="of the session (default: peerd's)")
parser.add_argument("--name", default="swarm", help="of the world")
parser.add_argument("--out", default="swarm.png")
options = parser.parse_args()
if options.quick:
    options.count, options.seconds = min(options.count, 40), 4.0
HZ = 60

# %% [markdown]
# ## The world
# A box for each object. How they fly is data of the world, so that an observer can find out.

# %%
names = [f"BIRD_{i}" for i in range(options.count)]
text = "#VRML V2.0 utf8\nDEF SWARM Group { }\n" + "".join(
    f"DEF {name} Transform {{ children Shape {{ appearance Appearance {{ material Material {{ diffuseColor 0.2 0.4 0.8 }} }} "
    f"geometry Box {{ size 0.3 0.1 0.8 }} }} }}\n" for name in names)
flight = Flight(options.count, options.seed)
with tempfile.TemporaryDirectory() as folder:
    world = Path(folder, "swarm.wrl")
    world.write_text(text)
    peer = peerd.Peer(world=world, world_name=options.name, name="swarm", own=names, interface=options.interface, port=options.port,
                      set=[f"replication.error_threshold_m={options.threshold}"])

# %% [markdown]
# ## Taking off
# `take()` asks for each object; from then on it is this program's to move.

# %%
peer.wait_until(lambda: peer.in_session)
objects = np.array([peer.find(name) for name in names], dtype=np.uint64)
peer.wait_until(lambda: len(peer.owned_objects()) == options.count)
for bird in objects.tolist():
    peer.take(bird)
peer.wait_until(lambda: peer.move(objects, flight.at(peer.session_time)[0], jumps=True) == options.count)
peer.set_data("SWARM", "flight", json.dumps({"count": options.count, "seed": options.seed, "threshold_m": options.threshold}))

# %% [markdown]
# ## The frames

# %%
frames = []  # session time; seconds of numpy, of move()
began = peer.session_time
sent_before = peer.ask(do="status")["counters"]
next_frame = time.perf_counter()
while (now := peer.session_time) - began < options.seconds and peer.poll():
    start = time.perf_counter()
    poses, velocities = flight.at(now)
    computed = time.perf_counter()
    peer.move(objects, poses, velocities)
    moved = time.perf_counter()
    next_frame = max(next_frame + 1 / HZ, moved)
    while (left := next_frame - time.perf_counter()) > 0:
        peer.poll(left)
    frames.append((now - began, computed - start, moved - computed))
sent = peer.ask(do="status")["counters"]
updates_per_s = (sent["updates_out"] - sent_before["updates_out"]) / options.seconds
bytes_per_s = (sent["bytes_out"] - sent_before["bytes_out"]) / options.seconds
peer.close()

# %% [markdown]
# ## What it cost

# %%
t, numpy_s, move_s = np.array(frames).T
figure, (ways, cost) = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
times = np.linspace(began + t[-1] - 2.0, began + t[-1], 60)
tracks = np.array([flight.at(at)[0][:, [0, 2]] for at in times])
for bird in range(options.count):
    ways.plot(tracks[:, bird, 0], tracks[:, bird, 1], color=plt.cm.viridis(bird / options.count), linewidth=0.8)
ways.plot(tracks[-1, :, 0], tracks[-1, :, 1], "k.", markersize=3)
ways.set(xlabel="x [m]", ylabel="z [m]", aspect="equal", title=f"the last 2 s of {options.count} objects, from above (dots: now)",
         xlim=(-1.1 * RADIUS_M, 1.1 * RADIUS_M), ylim=(1.1 * RADIUS_M, -1.1 * RADIUS_M))
cost.plot(t, 1e3 * move_s, ".", markersize=3, color="tab:blue", label=f"move(), median {1e3 * np.median(move_s):.2f} ms")
cost.plot(t, 1e3 * numpy_s, ".", markersize=3, color="tab:orange", label=f"numpy, median {1e3 * np.median(numpy_s):.2f} ms")
cost.axhline(1e3 / HZ, color="0.5", linestyle="--", linewidth=1, label=f"a frame at {HZ} Hz")
cost.set(xlabel="time [s]", ylabel="time of a frame [ms]", yscale="log",
         title=f"{updates_per_s:.0f} updates/s, {bytes_per_s / 1e3:.1f} kB/s sent")
cost.grid(True, which="both", alpha=0.3)
cost.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=2, frameon=False)
figure.savefig(options.out, dpi=120)
print(f"{options.out}: {len(t)} frames of {options.count} objects, {updates_per_s:.0f} updates/s, {bytes_per_s:.0f} bytes/s")
