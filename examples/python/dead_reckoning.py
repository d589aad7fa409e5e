# %% [markdown]
# # What the order and the threshold of dead reckoning do
#
# A peer publishes where its object is only when the *ghost*, which all peers predict from the last update, is farther
# from the truth than a threshold. A small threshold costs bytes and saves error; a model that predicts better (of a
# higher *order*: with the acceleration, too) gets the same error for less. Latency adds an error that no threshold
# takes away: an update says where the object was.
#
# This runs the thesis's scenario, a car between two walls (`peerd sim eq47`), once for each threshold, order and
# latency, and plots error against bytes. It is a notebook in a script: each `# %%` is a cell (VS Code, Spyder,
# Jupytext), and
#
#     python3 dead_reckoning.py [--quick] [--scenario eq47] [--object CAR] [--peerd PROGRAM] [--out dead_reckoning.png]
#
# runs all of it. It needs the program `peerd`, and the packages python3-matplotlib and python3-numpy.

# %% Options
import argparse
import json
import subprocess
from pathlib import Path

import matplotlib

matplotlib.use("Agg")  # a picture in a file, also where there is no screen; in a notebook leave this out
import matplotlib.pyplot as plt

parser = argparse.ArgumentParser(description="Error against bytes, by order and threshold of dead reckoning.")
parser.add_argument("--quick", action="store_true", help="few thresholds")
parser.add_argument("--scenario", default="eq47", help="a scenario's file, or the name of an installed one")
parser.add_argument("--object", default="CAR", help="the path of the object")
parser.add_argument("--peerd", default="peerd", help="the program")
parser.add_argument("--out", default="dead_reckoning.png")
options = parser.parse_args()

THRESHOLDS_M = [0.02, 0.2, 2.0] if options.quick else [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0]
LATENCIES_MS = [5, 200]

# %% [markdown]
# ## The runs
# Lists sweep: one run for each combination. `--json` prints all that was measured.

# %%
MODELS = {"first order": ["replication.order=1"], "second order": ["replication.order=2"],
          "the best, as the sender finds": ["replication.model=best"]}


def run(settings):
    """The object's error at other peers [m] and the bytes a second of its updates, for each latency and threshold."""
    command = [options.peerd, "sim", options.scenario, "--json", "--samples", "none"]
    command += [word for setting in settings for word in ("--set", setting)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):  # 1: what the scenario expects of its own settings need not hold for these
        raise SystemExit(done.stderr)
    points = {}
    for one in json.loads(done.stdout)["runs"]:
        others = [row for row in one["objects"] if row["path"] == options.object and row["observer"] != row["owner"]]
        key = one["params"]["network.latency_ms"], one["params"]["replication.error_threshold_m"]
        error_m = sum(row["ghost_error_m"]["mean"] for row in others) / len(others)
        duration_s = one["traffic"]["bytes"] / one["traffic"]["bytes_per_s"]
        points[key] = error_m, others[0]["bytes_sent"] / duration_s
    return points


common = [f"replication.error_threshold_m={json.dumps(THRESHOLDS_M)}", f"network.latency_ms={json.dumps(LATENCIES_MS)}",
          "replication.approach=dr"]
results = {name: run(common + settings) for name, settings in MODELS.items()}

# %% [markdown]
# ## Error against bytes
# Below and to the left is better. Each point is one threshold.

# %%
figure, axes = plt.subplots(1, len(LATENCIES_MS), figsize=(11, 4.6), sharex=True, sharey=True, layout="constrained")
for plot, latency_ms in zip(axes, LATENCIES_MS):
    for (name, points), colour, marker in zip(results.items(), ("tab:red", "tab:blue", "tab:green"), "osD"):
        error_m, bytes_per_s = zip(*(points[latency_ms, threshold] for threshold in THRESHOLDS_M))
        plot.loglog(bytes_per_s, error_m, marker=marker, color=colour, label=name)
        if name == "first order":
            for threshold, x, y in zip(THRESHOLDS_M, bytes_per_s, error_m):
                plot.annotate(f"{threshold:g} m", (x, y), xytext=(6, 4), textcoords="offset points", fontsize=8, color=colour)
    plot.set_title(f"latency {latency_ms} ms")
    plot.set_xlabel("updates of the object [bytes/s]")
    plot.grid(True, which="both", alpha=0.3)
    for axis in (plot.xaxis, plot.yaxis):
        axis.set_major_formatter("{x:g}")
    plot.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if x in (20, 50, 200) else "")
axes[0].set_ylabel("mean error of its ghosts [m]")
axes[-1].legend(title="model (numbers: threshold)", loc="lower right")
figure.suptitle(f"{options.object} in {Path(options.scenario).stem}: what is a byte worth?")
figure.savefig(options.out, dpi=120)
print(f"{options.out}: {len(THRESHOLDS_M) * len(LATENCIES_MS) * len(MODELS)} runs")

# %%
for name, points in results.items():
    for (latency_ms, threshold), (error_m, bytes_per_s) in sorted(points.items()):
        print(f"{name:30} {latency_ms:4} ms  {threshold:5g} m  {bytes_per_s:8.1f} bytes/s  {error_m:8.4f} m")
