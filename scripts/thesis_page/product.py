"""Runs peerd's commands, one after the other."""
import json
import pathlib
import shlex
import subprocess
import sys


class Product:
    def __init__(self, program, quick):
        self.program, self.quick = program, quick

    def run(self, *arguments, accepted=(0,)):
        command = [str(self.program), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode not in accepted:
            sys.exit(f"{shlex.join(command)}\nended with {done.returncode}: {done.stderr.strip()}")
        return done.stdout

    def json(self, *arguments):
        return json.loads(self.run(*arguments, "--json"))

    def simulate(self, out, scenario, *arguments):
        """The summary of `peerd sim`; whether what the scenario expects holds is not asked here."""
        self.run("sim", scenario, "--out", out, *arguments, accepted=(0, 1))
        return json.loads((pathlib.Path(out) / "summary.json").read_text())


def progress(sentence):
    print(sentence, file=sys.stderr, flush=True)


def shown(*words):
    """A command as the page shows it."""
    return "peerd " + " ".join(str(w) for w in words)
