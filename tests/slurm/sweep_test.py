#!/usr/bin/env python3
"""sweep_test.py PEERD: sweeps as array jobs of a real Slurm of this computer, which the test starts and ends.

The report of 240 runs is the same, byte for byte, as that of one process, also where a job was cancelled, a task killed, or
whoever waits for it. 77: there is no Slurm here, and nothing is tested."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import local_slurm

PEERD = os.path.realpath(sys.argv.pop(1)) if len(sys.argv) > 1 else ""
RUNS, TASKS = 240, 16
PATIENCE_S = 300  # of a test for what a busy computer must do at some time

WORLD = "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box {} } }\n"
SCENARIO = f"""world = "w.wrl"
duration_s = 0.5
[peer.a]
id = 1
owns = ["A"]
[peer.b]
id = 2
[motion.A]
x = "sin(3*t)"
[sweep]
"network.latency_ms" = {[10 * i for i in range(12)]}
"network.loss" = [0.0, 0.1]
"""


def wait_until(done):
    give_up = time.monotonic() + PATIENCE_S
    while not done():
        if time.monotonic() > give_up:
            raise TimeoutError("it did not come")
        time.sleep(0.02)


class Sweep(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory(prefix="peerd-slurm-")
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = pathlib.Path(cls.scratch.name)
        cls.folder.chmod(0o711)  # munged wants its socket to be reached by all
        cls.slurm = cls.enterClassContext(local_slurm.LocalSlurm(cls.folder / "slurm"))
        (cls.folder / "w.wrl").write_text(WORLD)
        (cls.folder / "s.toml").write_text(SCENARIO)
        here = cls.run_peerd("--out", "here", on=None)
        assert here.returncode == 0, here.stderr
        cls.expected = cls.report("here")
        assert len(json.loads(cls.expected["summary.json"])["runs"]) == RUNS and "report.html" in cls.expected

    @classmethod
    def command(cls, *options, on="slurm", tasks=TASKS):
        command = [PEERD, "sim", "s.toml", "--repeat", "10", *options]
        return command + (["--on", on, "--tasks", str(tasks)] if on else [])

    @classmethod
    def run_peerd(cls, *options, **how):
        return subprocess.run(cls.command(*options, **how), cwd=cls.folder, env=cls.slurm.environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=PATIENCE_S)

    def start_peerd(self, *options):
        """The command as a process that is there no more behind the test."""
        process = subprocess.Popen(self.command(*options), cwd=self.folder, env=self.slurm.environment, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    @classmethod
    def report(cls, out):
        """The files of a report, but for those that its runs have left."""
        return {p.name: p.read_bytes() for p in (cls.folder / out).iterdir() if p.is_file()}

    def results(self, out):
        return {p.name: p.stat().st_mtime_ns for p in (self.folder / out / "work/results").glob("*.result")}

    def wait_for_first_result(self, out):
        wait_until(lambda: self.results(out) and (self.folder / out / "work/job").exists())

    def job(self, out):
        return (self.folder / out / "work/job").read_text().strip()

    def expect_resumed(self, out, former):
        """The same command again gives the report, and does nothing twice."""
        again = self.run_peerd("--out", out)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(self.report(out), self.expected)
        now = self.results(out)
        self.assertEqual(len(now), RUNS)
        self.assertEqual({name: now[name] for name in former}, former)

    def test_the_report_is_that_of_one_process(self):
        done = self.run_peerd("--out", "whole")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"240 runs in {TASKS} tasks", done.stderr)
        there = self.report("whole")
        self.assertEqual(there["summary.json"], self.expected["summary.json"])
        self.assertEqual(there, self.expected)
        self.expect_resumed("whole", self.results("whole"))

    def test_no_more_tasks_than_slurm_takes(self):
        done = self.run_peerd("--out", "many", tasks=1000)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"240 runs in {self.slurm.array_size - 1} tasks", done.stderr)
        self.assertEqual(self.report("many"), self.expected)

    def test_a_cancelled_job_is_resumed(self):
        waiting = self.start_peerd("--out", "cancelled")
        self.wait_for_first_result("cancelled")
        self.slurm.run("scancel", self.job("cancelled"))
        _, err = waiting.communicate(timeout=PATIENCE_S)
        self.assertEqual(waiting.returncode, 3, err)
        former = self.results("cancelled")
        self.assertLess(len(former), RUNS)
        self.assertIn(f"{RUNS - len(former)} of 240 runs have no result: run-", err)
        self.assertFalse((self.folder / "cancelled/summary.json").exists())
        self.expect_resumed("cancelled", former)

    def test_a_killed_task_is_resumed(self):
        waiting = self.start_peerd("--out", "killed")
        out = f"--out={self.folder}/killed"

        def kill_one():
            for process in pathlib.Path("/proc").iterdir():
                try:
                    words = (process / "cmdline").read_bytes().decode().split("\0")
                    if words[0] not in (PEERD, PEERD + "-lab") or out not in words or "--task" not in words:
                        continue
                    first, _, last = words[words.index("--task") + 1].partition("-")
                    os.kill(int(process.name), signal.SIGSTOP)
                    if f"run-{int(last or first) + 1:03}.result" in self.results("killed"):
                        os.kill(int(process.name), signal.SIGCONT)  # it is about to end
                        continue
                    os.kill(int(process.name), signal.SIGKILL)
                    return True
                except (OSError, ValueError):
                    continue  # it has ended, or is no process
            return False

        wait_until(kill_one)
        _, err = waiting.communicate(timeout=PATIENCE_S)
        self.assertEqual(waiting.returncode, 3, err)
        former = self.results("killed")
        self.assertLess(len(former), RUNS)
        self.assertIn("no result: run-", err)
        self.expect_resumed("killed", former)

    def test_a_job_goes_on_without_whoever_waits_for_it(self):
        waiting = self.start_peerd("--out", "left")
        self.wait_for_first_result("left")
        waiting.kill()
        waiting.communicate()
        again = self.run_peerd("--out", "left")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn(f"Slurm job {self.job('left')} of an earlier start goes on", again.stderr)
        self.assertEqual(self.report("left"), self.expected)

    def test_control_c_cancels_the_job(self):
        waiting = self.start_peerd("--out", "stopped")
        self.wait_for_first_result("stopped")
        waiting.send_signal(signal.SIGINT)
        _, err = waiting.communicate(timeout=PATIENCE_S)
        self.assertEqual(waiting.returncode, 130, err)
        self.assertIn("stopped by SIGINT", err)
        wait_until(lambda: self.job("stopped") not in self.slurm.jobs())
        former = self.results("stopped")
        self.assertLess(len(former), RUNS)
        self.expect_resumed("stopped", former)

    def test_what_sbatch_refuses_is_shown(self):
        done = self.run_peerd("--out", "refused", "--slurm-options", "--partition=none")
        self.assertEqual(done.returncode, 3)
        self.assertIn("error: sbatch failed with exit code 1: ", done.stderr)
        self.assertIn("invalid partition", done.stderr)

    def test_chaos_gives_the_same_lines(self):
        command = [PEERD, "sim", "--chaos", "1..6", "--chaos-seconds", "22", "--chaos-peers", "2", "--json"]
        here = subprocess.run(command, stdout=subprocess.PIPE, check=True)
        there = subprocess.run([*command, "--on", "slurm", "--out", "chaos"], cwd=self.folder, env=self.slurm.environment,
                               stdout=subprocess.PIPE, check=True, timeout=PATIENCE_S)
        self.assertEqual(there.stdout, here.stdout)


if __name__ == "__main__":
    if missing := local_slurm.missing():
        print(f"skipped: {', '.join(missing)} not here; Debian's slurm-wlm and munge have them")
        sys.exit(77)
    # A shell starts what is in the background with SIGINT ignored, and the commands of the test would go on ignoring it.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    unittest.main()
