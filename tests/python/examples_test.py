"""The scripts of examples/python, as they are run by hand, each on little. Skipped where there is no matplotlib. The variable PEERD
names the program."""
import importlib.util
import os
import random
import re
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PEERD = os.environ.get("PEERD", "peerd")
GIVES_UP_S = 100


@unittest.skipUnless(importlib.util.find_spec("matplotlib"), "there is no matplotlib: install python3-matplotlib")
class ExamplesTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        number = random.SystemRandom().randrange(20_000, 30_000)  # other tests of this computer are left alone
        self.session = ["--port", str(number), "--name", f"swarm-{number}"]

    def tearDown(self):
        self.folder.cleanup()

    def run_example(self, name, *more):
        """What it prints; its picture has been checked."""
        picture = Path(self.folder.name, "picture.png")
        done = subprocess.run([sys.executable, str(ROOT / "examples/python" / name), "--quick", "--out", str(picture), *more], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=GIVES_UP_S,
                              env={**os.environ, "XDG_CONFIG_HOME": self.folder.name, "MPLCONFIGDIR": self.folder.name})
        self.assertEqual(done.returncode, 0, done.stdout)
        image = picture.read_bytes()
        self.assertEqual(image[:8], b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack(">II", image[16:24])
        self.assertGreater(min(width, height), 400)
        self.assertGreater(len(image), 10_000, "it is all but empty")
        return done.stdout

    def test_dead_reckoning(self):
        said = self.run_example("dead_reckoning.py", "--peerd", PEERD, "--scenario", str(ROOT / "configs/scenarios/eq47.toml"))
        rows = re.findall(r"^(\S.*\S) +(\d+) ms +(\S+) m +(\S+) bytes/s +(\S+) m$", said, re.MULTILINE)
        results = {(model, latency, threshold): (float(size), float(error)) for model, latency, threshold, size, error in rows}
        self.assertEqual(len(results), 3 * 2 * 3, said)
        for latency in ("5", "200"):
            first, second = results["first order", latency, "0.02"], results["second order", latency, "0.02"]
            self.assertLess(second[0], first[0], "a better model needs fewer bytes")
            self.assertLess(second[1], first[1], "and has less error")
        self.assertLess(results["second order", "5", "0.02"][1], results["second order", "200", "0.02"][1])

    def test_swarm(self):
        said = self.run_example("swarm.py", *self.session)
        frames, objects, updates = map(int, re.search(r"(\d+) frames of (\d+) objects, (\d+) updates/s", said).groups())
        self.assertEqual(objects, 40)
        self.assertGreater(frames, 20)
        self.assertGreater(updates, 0)

    def test_observer(self):
        said = self.run_example("observer.py", *self.session)
        median_mm = float(re.search(r"error median (\S+) mm", said).group(1))
        # Objects fly at 3 to 9 m/s and updates are due at 50 mm; a busy computer's come late.
        self.assertLess(median_mm, 500.0)


if __name__ == "__main__":
    unittest.main()
