#!/usr/bin/env python3
"""docs/images/draw_tutorial.py [--check] PEERD: draws the pictures of docs/tutorial/first-experiment.md into this folder.

Each shows a run of the world and the scenario that the page has, made anew by the program. --check draws nothing: exit code 1
where a picture is not what these runs give.
"""
import argparse
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import draw
from draw import BLUE, GREY, INK, ORANGE, PALE_GREY, RED, Picture

PAGE = draw.FOLDER.parent / "tutorial/first-experiment.md"
COLOURS = {1: ORANGE, 2: BLUE}


class Runs:
    """Makes the page's scenario, with some settings."""

    def __init__(self, peerd, folder):
        self.peerd, self.folder = peerd, folder
        for name, text in re.findall(r"^<!-- file: (field\.\w+) -->\n```\w*\n(.*?)^```", PAGE.read_text(), re.M | re.S):
            (folder / name).write_text(text)

    def make(self, *settings):
        words = [word for setting in settings for word in ("--set", setting)]
        subprocess.run([self.peerd, "sim", "field.toml", *words, "--out", "out", "--samples", "all"], cwd=self.folder, check=True, capture_output=True)
        return json.loads((self.folder / "out/summary.json").read_text())["runs"]

    def rows(self, name):
        with open(self.folder / "out" / name, newline="") as file:
            return list(csv.DictReader(file))

    def updates(self):
        return [float(row["t_s"]) for row in self.rows("traffic.csv") if row["kind"] == "update"]


class Chart:
    """A frame with two axes; `log`: both are logarithmic."""

    def __init__(self, picture, left, top, width, height, x_range, y_range, log=False):
        self.p, self.frame, self.ranges, self.log = picture, (left, top, width, height), (x_range, y_range), log
        picture.box(left, top, width, height, "white", GREY, 0, 1)

    def share(self, value, low, high):
        if self.log:
            value, low, high = math.log(value), math.log(low), math.log(high)
        return (value - low) / (high - low)

    def at(self, x, y):
        left, top, width, height = self.frame
        return left + width * self.share(x, *self.ranges[0]), top + height * (1 - self.share(y, *self.ranges[1]))

    def axes(self, x_ticks, y_ticks, x_name, y_name):
        left, top, width, height = self.frame
        for value in x_ticks:
            x, _ = self.at(value, self.ranges[1][0])
            self.p.line(x, top, x, top + height, PALE_GREY, 1)
            self.p.text(x, top + height + 18, f"{value:g}", GREY, 12)
        for value in y_ticks:
            _, y = self.at(self.ranges[0][0], value)
            self.p.line(left, y, left + width, y, PALE_GREY, 1)
            self.p.text(left - 8, y + 4, f"{value:g}", GREY, 12, "end")
        self.p.text(left + width / 2, top + height + 38, x_name, size=13)
        self.p.text(left, top - 10, y_name, size=13, anchor="start")

    def curve(self, points, color, dash=None, dots=False):
        places = [self.at(*point) for point in points]
        self.p.path(places, color, 2, dash)
        if dots:
            for place in places:
                self.p.dot(*place, 4, color)


def legend(p, x, y, entries):
    for number, (color, words, dash) in enumerate(entries):
        p.line(x, y + 22 * number, x + 34, y + 22 * number, color, 2.5, dash)
        p.text(x + 42, y + 22 * number + 5, words, color, 13, "start")


def ghost(runs):
    """From above, what the observer believes, at a threshold that makes it visible."""
    runs.make("replication.error_threshold_m=2", "replication.order=1", "duration_s=13")
    samples = runs.rows("errors.csv")
    updates = runs.updates()
    p = Picture(720, 430)
    chart = Chart(p, 40, 40, 640, 330, (-25.6, 25.6), (-13.2, 13.2))

    def path(what, rows):
        return [(float(row[f"{what}_x"]), -float(row[f"{what}_z"])) for row in rows]
    pieces = [[]]
    for before, row in zip([None, *samples], samples):
        if before and math.dist(path("ghost", [before])[0], path("ghost", [row])[0]) > 1.0:
            pieces.append([])
        pieces[-1].append(row)
    for piece in pieces:
        chart.curve(path("ghost", piece), ORANGE, "7,4")
    chart.curve(path("truth", samples), BLUE)
    for t in updates:
        row = min(samples, key=lambda row: abs(float(row["t_s"]) - t))
        p.dot(*chart.at(*path("truth", [row])[0]), 5, INK)
    legend(p, 60, 18, [(BLUE, "where ada's car is", None)])
    legend(p, 290, 18, [(ORANGE, "its ghost, at bo", "7,4")])
    p.dot(496, 18, 5, INK)
    p.text(508, 23, "an update", size=13, anchor="start")
    p.text(360, 402, f"13 s from above, threshold 2 m, first order: {len(updates)} updates. The area is 51 m wide.", size=13)
    p.save("tutorial-ghost.svg", "A car's path from above, its ghost, and the updates")


def orders(runs):
    """The error over time, by both orders."""
    p = Picture(720, 430)
    for number, order in enumerate((1, 2)):
        runs.make("replication.error_threshold_m=0.5", f"replication.order={order}", "duration_s=13")
        chart = Chart(p, 60, 40 + 190 * number, 630, 120, (0, 13), (0, 0.6))
        chart.axes(range(0, 14), (0, 0.2, 0.4, 0.6), "" if order == 1 else "time [s]", f"order {order}: error of the ghost [m], each line down is an update")
        chart.curve([(float(row["t_s"]), float(row["ghost_error_m"])) for row in runs.rows("errors.csv")], COLOURS[order])
        chart.curve([(0, 0.5), (13, 0.5)], RED, "5,4")
        p.text(686, chart.at(0, 0.5)[1] - 5, "threshold", RED, 12, "end")
    p.save("tutorial-orders.svg", "The error of a ghost over time, by a model of first and of second order")


def thresholds(runs):
    """Updates against the threshold, with what a Taylor series says."""
    found = runs.make("replication.error_threshold_m=[0.05,0.1,0.2,0.5,1,2]", "replication.order=[1,2]")
    p = Picture(720, 380)
    chart = Chart(p, 70, 40, 400, 280, (0.04, 2.5), (15, 400), log=True)
    chart.axes((0.05, 0.1, 0.2, 0.5, 1, 2), (20, 50, 100, 200, 400), "threshold [m]", "updates in 30 s")
    for order in (1, 2):
        points = [(run["params"]["replication.error_threshold_m"], run["objects"][0]["updates_sent"])
                  for run in found if run["params"]["replication.order"] == order]
        chart.curve(points, COLOURS[order], dots=True)
        first = points[0]
        chart.curve([(x, first[1] * (first[0] / x) ** (1 / (order + 1))) for x, _ in points], GREY, "3,4")
    legend(p, 490, 80, [(ORANGE, "first order", None), (BLUE, "second order", None), (GREY, "threshold^(-1/2)", "3,4"), (GREY, "and threshold^(-1/3)", "3,4")])
    p.save("tutorial-thresholds.svg", "Updates against the threshold, for both orders, on logarithmic axes")


def latency(runs):
    found = runs.make("network.latency_ms=[0,50,100,200,400]", "replication.order=[1,2]")
    p = Picture(720, 380)
    chart = Chart(p, 70, 40, 400, 280, (0, 400), (0, 1.4))
    chart.axes((0, 100, 200, 300, 400), (0, 0.2, 0.4, 0.6, 0.8, 1, 1.2, 1.4), "latency [ms]", "mean error of the ghost [m]")
    for order in (1, 2):
        chart.curve([(run["params"]["network.latency_ms"], run["objects"][0]["ghost_error_m"]["mean"])
                     for run in found if run["params"]["replication.order"] == order], COLOURS[order], dots=True)
    legend(p, 490, 80, [(ORANGE, "first order", None), (BLUE, "second order", None)])
    p.text(490, 140, "threshold 0.5 m", GREY, 13, "start")
    p.save("tutorial-latency.svg", "The mean error of a ghost against latency, for both orders")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("peerd", type=pathlib.Path)
    arguments = parser.parse_args()
    committed = draw.FOLDER
    different = []
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(arguments.peerd.resolve(), pathlib.Path(folder))
        if arguments.check:
            draw.FOLDER = pathlib.Path(folder)
        for picture in (ghost, orders, thresholds, latency):
            picture(runs)
        if arguments.check:
            for drawn in sorted(draw.FOLDER.glob("tutorial-*.svg")):
                if drawn.read_bytes() != (committed / drawn.name).read_bytes():
                    different.append(drawn.name)
    for name in different:
        print(f"docs/images/{name}: not what the runs give; docs/images/draw_tutorial.py PEERD draws it")
    return 1 if different else 0


sys.exit(main())
