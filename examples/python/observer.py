# %% [markdown]
# # An observer that plots errors
#
# This peer joins a swarm (`swarm.py`, in another terminal or on another computer) without its file, owns nothing and
# watches. The swarm says in the world's data how it flies, so the observer knows where each object truly is at each
# session time, and compares that with what it would show.
#
#     python3 observer.py [--quick] [--seconds 10] [--interface lo] [--port 47800] [--name swarm] [--out observer.png]
#
# `--quick` starts a small swarm itself. It needs the packages python3-peerd, python3-matplotlib and python3-numpy.

# %% Options
import argparse
import json
import subprocess
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # a picture in a file, also where there is no screen; in a notebook leave this out
import matplotlib.pyplot as plt
import numpy as np

import peerd
from flight import Flight

parser = argparse.ArgumentParser(description="How far a swarm is from where it is shown.")
parser.add_argument("--quick", action="store_true", help="start a small swarm, and watch it for 3 s")
parser.add_argument("--seconds", type=float, default=10.0)
parser.add_argument("--interface", default="lo", help="of the network; lo: this computer alone")
parser.add_argument("--port", type=int, help="of the session that --quick starts (default: peerd's)")
parser.add_argument("--name", default="swarm", help="of the world")
parser.add_argument("--out", default="observer.png")
options = parser.parse_args()
HZ = 60

# %% [markdown]
# ## Joining

# %%
swarm = None
if options.quick:
    options.seconds = 3.0
    command = [sys.executable, str(Path(__file__).with_name("swarm.py")), "--count", "40", "--seconds", "20", "--name", options.name,
               "--interface", options.interface, "--out", str(Path(options.out).with_suffix(".swarm.png"))]
    swarm = subprocess.Popen(command + ([] if options.port is None else ["--port", str(options.port)]))
for attempt in range(10):
    try:
        peer = peerd.Peer(join=options.name, name="observer", interface=options.interface)
        break
    except peerd.Error as error:
        print(f"not yet: {error}")
else:
    sys.exit(f"there is no world {options.name} here")
peer.wait_until(lambda: peer.in_session and peer.data("SWARM", "flight") is not None, 20)
said = json.loads(peer.data("SWARM", "flight"))
flight = Flight(said["count"], said["seed"])
objects = np.array([peer.find(f"BIRD_{i}") for i in range(flight.count)], dtype=np.uint64)

# %% [markdown]
# ## Watching
# Each frame's poses are written into the next row of one array.

# %%
frames = int(options.seconds * HZ)
times, seen = np.full(frames, np.nan), np.full((frames, flight.count, 7), np.nan)
peer.wait_until(lambda: len(peer.owned_objects()) == flight.count and (peer.poses(objects)[:, 1] > 0.5).all(), 20)  # all fly
first = peer.session_time
for frame in range(frames):
    while peer.session_time < first + frame / HZ and peer.poll(0.002):
        pass
    times[frame] = peer.session_time
    peer.poses(objects, out=seen[frame])
peer.close()
if swarm is not None:
    swarm.terminate()
    swarm.wait()

# %% [markdown]
# ## Errors and jumps
# An error is the distance of an object from where it truly is then. A jump is how far it is from where it would be if it
# had gone on as it was shown in the two frames before: what the eye sees of an update.

# %%
truth = np.array([flight.at(t)[0] for t in times])
error_m = np.linalg.norm(seen[:, :, :3] - truth[:, :, :3], axis=2)
step_s = np.diff(times)[:, None, None]
speed_m_s = np.diff(seen[:, :, :3], axis=0) / step_s
jump_m = np.linalg.norm(np.diff(speed_m_s, axis=0), axis=2) * step_s[1:, :, 0]

figure, (course, spread) = plt.subplots(1, 2, figsize=(11, 4.4), layout="constrained")
t = times - first
for percent, style in ((50, "-"), (90, "--"), (100, ":")):
    name = "largest" if percent == 100 else "median" if percent == 50 else f"{percent} % are below"
    course.plot(t, 1e3 * np.percentile(error_m, percent, axis=1), style, color="tab:blue", label=name)
course.axhline(1e3 * said["threshold_m"], color="0.4", linewidth=1, label="threshold of an update")
course.set(xlabel="session time since the first frame [s]", ylabel="error [mm]", yscale="log", title=f"errors of {flight.count} objects")
course.grid(True, which="both", alpha=0.3)
course.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=2, frameon=False)
for name, samples_m, colour in (("error", error_m, "tab:blue"), ("jump from frame to frame", jump_m, "tab:red")):
    sorted_mm = 1e3 * np.sort(samples_m.ravel())
    spread.plot(sorted_mm, np.linspace(0, 100, len(sorted_mm)), color=colour, label=f"{name}, median {np.median(sorted_mm):.2g} mm")
spread.axvline(1e3 * said["threshold_m"], color="0.4", linewidth=1)
spread.set(xlabel="error, or jump [mm]", ylabel="share of all samples below [%]", xscale="log", ylim=(0, 101),
           title=f"all samples of {frames} frames")
spread.grid(True, which="both", alpha=0.3)
spread.legend(loc="upper center", bbox_to_anchor=(0.5, -0.14), ncol=1, frameon=False)
figure.savefig(options.out, dpi=120)
print(f"{options.out}: error median {1e3 * np.median(error_m):.2f} mm, 99 % below {1e3 * np.percentile(error_m, 99):.1f} mm, "
      f"largest {1e3 * error_m.max():.1f} mm")
