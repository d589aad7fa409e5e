"""The files of `peerd sim --out`: rows by run."""
import csv
import json


class Runs:
    def __init__(self, folder):
        self.folder = folder
        self.summary = json.loads((folder / "summary.json").read_text())
        self.params = [run["params"] for run in self.summary["runs"]]

    def rows(self, name, keep=lambda row: True):
        """The rows of NAME.csv that are kept, a list for each run."""
        out = [[] for _ in self.params]
        with open(self.folder / f"{name}.csv", newline="") as file:
            for row in csv.DictReader(file):
                if keep(row):
                    out[int(row["run"]) - 1].append(row)
        return out

    def index(self, **wanted):
        """The number of the run, from 0, with such parameters; keys by the last word of their names."""
        for i, params in enumerate(self.params):
            short = {key.rpartition(".")[2]: value for key, value in params.items()}
            if all(short.get(key) == value for key, value in wanted.items()):
                return i
        raise LookupError(f"no run with {wanted}")


def greatest(rows, begin, end, key="ghost_error_m"):
    return max((float(r[key]) for r in rows if begin <= float(r["t_s"]) < end), default=0.0)


def mean_error(rows, begin=0.0, end=1e9):
    values = [float(r["ghost_error_m"]) for r in rows if begin <= float(r["t_s"]) < end]
    return sum(values) / len(values) if values else 0.0
