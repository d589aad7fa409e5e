"""The test programs of the floors: building them, and running the tests that can notice a wrong line."""
import os
import re
import resource
import shutil
import subprocess
import time

MEMORY_BYTES = 8 << 30  # A wrong line that allocates for ever must not take the computer with it.


def limited():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


class Programs:
    def __init__(self, root, folder, jobs):
        self.root, self.folder, self.jobs = root, folder, jobs
        self.kept = folder / "together"

    def configure(self):
        command = ["cmake", "--preset", "release", "-DPEERD_WERROR=OFF", "-S", self.root, "-B", self.folder]
        return subprocess.run(command, cwd=self.root, stdout=subprocess.DEVNULL).returncode == 0

    def build(self, targets):
        """What the compiler says if the programs do not build, or nothing."""
        command = ["cmake", "--build", self.folder, "--target", *targets, "--", f"-j{self.jobs}", "-k0"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace")
        return done.stdout if done.returncode else None

    def keep(self, targets):
        """Copies the programs that have all wrong lines, before others are built."""
        self.kept.mkdir(exist_ok=True)
        for target in targets:
            shutil.copy2(self.folder / "bin" / target, self.kept / target)

    def program(self, target, alone):
        return (self.folder / "bin" if alone else self.kept) / target

    def tests(self, target):
        """The names of all tests."""
        listed = subprocess.run([self.program(target, False), "--gtest_list_tests"], capture_output=True, text=True, check=True)
        suite, names = "", []
        for line in listed.stdout.splitlines():
            name = line.split("#")[0].rstrip()
            if re.match(r"\S+\.$", name):
                suite = name
            elif name.startswith("  "):
                names.append(suite + name.strip())
        return names

    def failing(self, target, tests, limit_s, number, reached=None):
        """What notices the wrong line of this number (none: the one that was built by itself): the first of these tests
        that fails, or nothing; and the time [s]."""
        program = self.program(target, number is None)
        flags = self.folder / f"{target}.flags"
        flags.write_text(f"--gtest_filter={':'.join(tests)}\n--gtest_fail_fast\n--gtest_brief=1\n")
        environment = dict(os.environ, WRONG_LINE=str(number or 0))
        if reached:
            environment["WRONG_LINES_REACHED"] = str(reached)
        began = time.monotonic()
        try:
            done = subprocess.run(
                [program, f"--gtest_flagfile={flags}"], env=environment, preexec_fn=limited,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", timeout=limit_s,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return f"never ended ({limit_s:.0f} s)", limit_s
        took_s = time.monotonic() - began
        if done.returncode == 0:
            return None, took_s
        failed = re.search(r"\[  FAILED  \] ([^\s,]+)", done.stdout)
        if failed:
            return failed.group(1), took_s
        why = re.search(r"[^\n]*(?:Assertion|terminate called)[^\n]*", done.stdout)
        return f"exit code {done.returncode}" + (f": {why.group().strip()[-120:]}" if why else ""), took_s


def suites_in(files):
    found = set()
    for source in files:
        found |= set(re.findall(r"^(?:TYPED_)?TEST(?:_[FP])?\(\s*(\w+)", source.read_text(), re.M))
    return found


def is_of(test, suites):
    """Whether a test is one of these suites', with or without the prefix and the number of its parameters."""
    return any(part in suites for part in test.split(".")[0].split("/"))


class Floor:
    """The test program of a floor: how long each test takes as it is, and which wrong lines it reaches."""

    def __init__(self, programs, name, root):
        self.programs, self.name, self.root = programs, name, root
        self.usual_s, self.reaches = {}, {}

    def measure(self):
        """Runs each test by itself without any wrong line; returns the first that fails."""
        reached = self.programs.folder / "reached"
        for test in self.programs.tests(self.name):
            reached.unlink(missing_ok=True)
            failed, self.usual_s[test] = self.programs.failing(self.name, [test], 3600, 0, reached)
            if failed:
                return failed
            numbers = reached.read_text().split() if reached.exists() else []
            self.reaches[test] = {int(n) for n in numbers}
        return None

    def stages(self, mutant):
        """The tests that can notice a wrong line, in the order of how likely that is: those of the source's own test, then
        of its room and the quickest others, then all others."""
        tests = [t for t in self.usual_s if mutant.alone or mutant.number in self.reaches[t]]
        room = self.root / "tests" / mutant.path.parent
        own = suites_in([f for f in [room / f"{mutant.path.stem}_test.cpp"] if f.exists()])
        near = suites_in(room.glob("*_test.cpp"))
        first = [t for t in tests if is_of(t, own)]
        rest = sorted((t for t in tests if not is_of(t, own)), key=lambda t: (not is_of(t, near), self.usual_s[t]))
        second, spent_s = [], 0
        for test in rest:
            if spent_s + self.usual_s[test] > 3:
                break
            spent_s += self.usual_s[test]
            second.append(test)
        return [s for s in (first, second, [t for t in rest if t not in set(second)]) if s], len(tests)

    def noticed(self, mutant):
        """What notices the wrong line, or nothing; and how many tests reach it."""
        stages, count = self.stages(mutant)
        for tests in stages:
            limit_s = 10 * sum(self.usual_s[t] for t in tests) + 10
            failed, _ = self.programs.failing(self.name, tests, limit_s, None if mutant.alone else mutant.number)
            if failed:
                return failed, count
        return None, count
