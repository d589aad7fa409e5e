#!/usr/bin/env python3
"""What scripts/attack runs in namespaces of its own: peers, an attacker, joining peers, and what came of it.

    attack_run.py start BIN NAME [--seconds N] ..     makes the namespaces, which are gone with the last process in them
    attack_run.py run BIN NAME [--seconds N] [--joins N] [--rate R] [--count N] [--addresses N] [--json FILE]
    attack_run.py delay FROM_PORT ADDRESS PORT MS     passes TCP connections on, each byte so much later

a, b and c are the peers of configs/scenarios/town.toml, x is the attacker's computer, n that of those who join.
"""
import argparse
import asyncio
import concurrent.futures
import json
import os
import pathlib
import re
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
HOSTS = {"a": 1, "b": 2, "c": 3, "x": 4, "n": 5}
PEERS = {"a": "ada", "b": "ben", "c": "cleo"}
LATE_MS = [1, 2, 5, 10, 20, 50]
SNAPSHOT_PORT, DELAYED_PORT = 48100, 48200
JOINED_WITHIN_S = 20
# Those who join in this attack come over a path of 100 ms each way.
FAR_JOINS = {"silent-connections", "keyed-connections"}
LOG_BYTES = 14_500_000  # of edits, for the attack that reads them
# By attack: the counts of the attacker that must not be 0, and the counters of a that must have grown. Without these the
# attack has not taken place, and what it cost says nothing.
MUST_GROW = {
    "identities": (["identities"], ["net.in_unproven"]),
    "signatures": (["datagrams"], ["net.in_unsigned"]),
    "many-signatures": (["datagrams"], ["net.in_unsigned", "net.in_flood"]),
    "signed-flood": (["datagrams"], ["net.in_flood"]),
    "doubling-edit": (["edits", "bytes"], ["operations_in"]),
    "growing-edit": (["edits", "bytes"], ["operations_in"]),
    "large-edits": (["edits", "bytes"], ["operations_in"]),
    "forged-answers": (["questions", "answers"], []),
    "silent-connections": (["connections"], []),
    "keyed-connections": (["connections", "spoken"], []),
    "second-process": (["starts"], []),
    "stamps-ahead": (["edits", "bytes"], ["dropped_operation_ahead"]),
    "locks": (["edits", "bytes"], ["operations_in"]),
    "gives": (["edits", "bytes"], ["operations_in"]),
    "claims": (["hellos"], []),
    "clock-shift": (["hellos"], []),
    "region-groups": (["datagrams"], ["dropped_subscription_rate"]),
    "digests": (["asked", "answered"], []),
}


def ip(*words):
    subprocess.run(["ip", *words], check=True)


def make_network(attackers_addresses):
    subprocess.run(["mount", "-t", "tmpfs", "none", "/run"], check=True)
    subprocess.run(["mount", "-t", "proc", "proc", "/proc"], check=True)
    pathlib.Path("/run/netns").mkdir()
    ip("link", "add", "lan", "type", "bridge", "mcast_snooping", "0")
    ip("link", "set", "lan", "up")
    for host, number in HOSTS.items():
        ip("netns", "add", host)
        ip("link", "add", f"to-{host}", "type", "veth", "peer", "name", "eth0", "netns", host)
        ip("link", "set", f"to-{host}", "master", "lan", "up")
        for words in (["addr", "add", f"10.66.0.{number}/16", "dev", "eth0"], ["link", "set", "eth0", "up"],
                      ["link", "set", "lo", "up"]):
            ip("-n", host, *words)
    for i in range(1, attackers_addresses):
        ip("-n", "x", "addr", "add", f"10.66.{1 + i // 250}.{1 + i % 250}/16", "dev", "eth0")
    time.sleep(0.5)


class Program:
    """A program on one of the hosts, whose output goes to a file."""

    def __init__(self, folder, host, name, words, user=None):
        home = folder / (user or name)
        home.mkdir(exist_ok=True)
        environment = {**os.environ, "XDG_CONFIG_HOME": str(home / "config"), "XDG_STATE_HOME": str(home / "state"),
                       "XDG_RUNTIME_DIR": str(home)}
        self.log = folder / f"{name}.log"
        with open(self.log, "w") as out:
            self.process = subprocess.Popen(["ip", "netns", "exec", host, *map(str, words)], stdout=out, stderr=out,
                                            env=environment)
        self.socket = folder / f"{name}.sock"

    def ask(self, request):
        with socket.socket(socket.AF_UNIX) as line:
            line.settimeout(10)
            line.connect(str(self.socket))
            line.sendall(json.dumps(request).encode() + b"\n")
            reply = b""
            while not reply.endswith(b"\n"):
                more = line.recv(1 << 16)
                if not more:
                    break
                reply += more
        return json.loads(reply)

    def status(self):
        try:
            return self.ask({"do": "status"})
        except (OSError, ValueError):
            return None

    def memory_kb(self):
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", status).group(1))

    def processor_s(self):
        fields = pathlib.Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def end(self, with_signal=signal.SIGTERM, within_s=5):
        if self.process.poll() is None:
            self.process.send_signal(with_signal)
        try:
            self.process.wait(within_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()


class Session:
    def __init__(self, folder, programs):
        self.folder = folder
        self.key = folder / "key"
        self.key.write_text(key_text())
        self.key.chmod(0o600)
        self.peers = {}
        self.joined = 0
        self.bin = programs

    def begin(self):
        for host, name in PEERS.items():
            self.peers[host] = Program(self.folder, host, name, [
                self.bin / "peerd", "run", "-c", ROOT / "configs/scenarios/town.toml", "--peer", name, "--interface", "eth0",
                "--key", self.key, "--control", self.folder / f"{name}.sock", "--set",
                f"transport.snapshot_port={SNAPSHOT_PORT}"])
        wait_for(30, lambda: all(self.sees_others(host) for host in PEERS), "the three peers do not find each other")

    def sees_others(self, host):
        status = self.peers[host].status()
        return status is not None and set(PEERS.values()) - {PEERS[host]} <= names_in(status)

    def fill_logs(self):
        """Edits of a, by data at a node, which all peers get."""
        value_bytes = 16_000
        for number in range(LOG_BYTES // value_bytes):
            request = {"do": "data", "path": "BUS", "key": f"k{number % 100}", "value": secrets.token_hex(value_bytes // 2)}
            wait_for(10, lambda: self.peers["a"].ask(request).get("done"), "a does not take the edits that are to be read")
        edits = LOG_BYTES // value_bytes
        wait_for(60, lambda: all(self.peers[host].status()["counters"]["operations_in"] >= edits for host in "bc"),
                 "the edits that are to be read do not reach all")

    def join(self, is_far):
        """Seconds until a new peer and the others know each other; none: they did not."""
        self.joined += 1
        name = f"n{self.joined}"
        words = [self.bin / "peerd", "join", "town", "--name", name, "--id", 5000 + self.joined, "--store", "", "--key", self.key,
                 "--interface", "eth0", "--control", self.folder / f"{name}.sock"]
        if is_far:
            words += ["--from", f"127.0.0.1:{DELAYED_PORT}"]
        began = time.monotonic()
        newcomer = Program(self.folder, "n", name, words)
        took = None
        while took is None and time.monotonic() - began < JOINED_WITHIN_S and newcomer.process.poll() is None:
            time.sleep(0.1)
            status = newcomer.status() if newcomer.socket.exists() else None
            if status and status["session"]["joined"] and set(PEERS.values()) <= names_in(status) and \
                    all(name in names_in(self.peers[host].status() or {}) for host in PEERS):
                took = time.monotonic() - began
        newcomer.end()
        if took is None:
            print(f"  {name} did not join: {newcomer.log.read_text().strip().splitlines()[-1:]}", file=sys.stderr)
        return took

    def joins(self, count, is_far):
        with concurrent.futures.ThreadPoolExecutor(4) as four:
            return [t for t in four.map(lambda _: self.join(is_far), range(count)) if t is not None]

    def sample(self):
        return {host: {"counters": peer.status()["counters"], "memory_kb": peer.memory_kb(), "processor_s": peer.processor_s(),
                       "lost": len(re.findall(r"\((?:ada|ben|cleo)\) is lost|(?:ada|ben|cleo) \(id \d\) is lost", peer.log.read_text())),
                       "at": time.monotonic()} for host, peer in self.peers.items()}


def key_text():
    import base64
    return "peerd-key-1:" + base64.urlsafe_b64encode(secrets.token_bytes(32)).decode().rstrip("=") + "\n"


def names_in(status):
    return {member["name"] for member in status.get("members", [])}


def wait_for(seconds, holds, otherwise):
    until = time.monotonic() + seconds
    while not holds():
        if time.monotonic() > until:
            sys.exit(f"error: {otherwise}")
        time.sleep(0.2)


def between(before, after):
    """How late the ticks of each peer were between two samples."""
    rows = {}
    for host in before:
        counted = lambda name: after[host]["counters"][name] - before[host]["counters"][name]
        ticks = counted("ticks") + counted("ticks_missed")
        late = {ms: counted(f"ticks_late_{ms}_ms") + counted("ticks_missed") for ms in LATE_MS}
        p99 = next((f"<= {ms} ms" for ms in LATE_MS if late[ms] * 100 <= ticks), f"> {LATE_MS[-1]} ms")
        elapsed = after[host]["at"] - before[host]["at"]
        rows[host] = {"ticks": ticks, "late_2_ms": late[2], "missed": counted("ticks_missed"), "p99": p99,
                      "processor": round((after[host]["processor_s"] - before[host]["processor_s"]) / elapsed, 2),
                      "memory_mb": round((after[host]["memory_kb"] - before[host]["memory_kb"]) / 1024, 1),
                      "lost": after[host]["lost"] - before[host]["lost"]}
    return rows


def changed_counters(before, after):
    """The counters of a that say that something was refused, or came in large numbers."""
    names = [n for n in after["counters"] if re.match(r"net\.in_|dropped_|operations_in", n)]
    return {n: after["counters"][n] - before["counters"].get(n, 0) for n in names
            if after["counters"][n] > before["counters"].get(n, 0)}


def missing(name, sent, counters):
    """The counts and counters that say that the attack has not taken place."""
    of_attacker, of_peer = MUST_GROW[name]
    return [n for n in of_attacker if not sent.get(n)] + [n for n in of_peer if not counters.get(n)]


def counts_in(line):
    """What the attacker says it has sent; nothing where it says something else."""
    try:
        counts = json.loads(line)
    except ValueError:
        return {}
    return counts if isinstance(counts, dict) else {}


def edit_arrives(session):
    """Whether an edit of b reaches c, which is still what the session is for."""
    value = secrets.token_hex(4)
    if not session.peers["b"].ask({"do": "data", "path": "BUS", "key": "after", "value": value}).get("done"):
        return False
    for _ in range(100):
        if session.peers["c"].ask({"do": "data", "path": "BUS", "key": "after"}).get("value") == value:
            return True
        time.sleep(0.1)
    return False


def run(options):
    make_network(options.addresses)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="attack.", dir="/run"))
    session = Session(folder, options.bin)
    session.begin()
    if options.name == "digests":
        session.fill_logs()
    is_far = options.name in FAR_JOINS
    delay = None
    if is_far:
        delay = subprocess.Popen(["ip", "netns", "exec", "n", sys.executable, __file__, "delay", str(DELAYED_PORT), "10.66.0.1",
                                  str(SNAPSHOT_PORT), "100"])
    time.sleep(5)
    begin = session.sample()
    time.sleep(options.seconds)
    idle = session.sample()
    words = [session.bin / "peerd-attacker", options.name, "--world", "town", "--interface", "eth0", "--key", session.key,
             "--seconds", options.seconds + 600]
    if options.name in FAR_JOINS | {"digests"}:
        words += ["--at", f"10.66.0.1:{SNAPSHOT_PORT}"]
    if options.name == "second-process":
        shutil.copy(folder / "ben/config/peerd/identity.key", folder / "copied")
        words += ["--identity", folder / "copied", "--number", 2]
    for name in ("rate", "count"):
        if getattr(options, name) is not None:
            words += [f"--{name}", getattr(options, name)]
    attacker = Program(folder, "x", "attacker", words)
    time.sleep(4)  # it becomes a member first
    start = session.sample()
    time.sleep(options.seconds)
    attacked = session.sample()
    during = session.joins(options.joins, is_far)
    if attacker.process.poll() is not None:
        sys.exit(f"error: the attacker ended: {attacker.log.read_text()}")
    attacker.end(signal.SIGTERM, 10)
    sent = attacker.log.read_text().strip().splitlines()[-1:]
    # A counter that says what the attack did grows while it goes on, before those who join add to it.
    counters = changed_counters(start["a"], attacked["a"])
    not_done = missing(options.name, counts_in("".join(sent)), counters)
    time.sleep(3)
    end = session.sample()
    after = session.joins(options.joins, is_far)
    works = edit_arrives(session)
    everybody = all(session.sees_others(host) for host in PEERS)
    for program in session.peers.values():
        program.end()
    if delay:
        delay.kill()
        delay.wait()
    result = {"attack": options.name, "seconds": options.seconds, "sent": sent, "idle": between(begin, idle),
              "attacked": between(start, attacked), "whole": between(idle, end), "joins": options.joins,
              "joined_during": len(during), "joined_after": len(after), "join_s": [round(t, 1) for t in sorted(during)],
              "edit_arrives": works, "everybody_is_there": everybody, "counters": changed_counters(idle["a"], end["a"]),
              "not_done": not_done}
    print_result(result)
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps(result, indent=1) + "\n")
    if options.keep:
        shutil.copytree(folder, options.keep, ignore=shutil.ignore_patterns("*.sock"), dirs_exist_ok=True)
    lost = sum(row["lost"] for row in result["whole"].values())
    return not not_done and lost == 0 and len(during) == len(after) == options.joins and works and everybody


def print_result(result):
    print(f"{result['attack']}, {result['seconds']} s: the attacker says {' '.join(result['sent'])}")
    print("peer  ticks  later than 2 ms      p99                 processor    memory     peers")
    print("             idle     attacked    idle     attacked   idle  att.   grew [MB]  lost")
    for host in result["idle"]:
        i, a, w = (result[part][host] for part in ("idle", "attacked", "whole"))
        print(f"{host:5} {a['ticks']:5}  {i['late_2_ms']:5}    {a['late_2_ms']:5}       {i['p99']:8} {a['p99']:8}   "
              f"{i['processor']:.2f}  {a['processor']:.2f}   {w['memory_mb']:6}     {w['lost']}")
    print(f"joined during the attack: {result['joined_during']} of {result['joins']}, after it {result['joined_after']}; "
          f"seconds: {result['join_s']}")
    print(f"afterwards an edit of b reaches c: {result['edit_arrives']}; all three know each other: {result['everybody_is_there']}")
    if result["not_done"]:
        print("the attack has not taken place, as these did not grow: " + ", ".join(result["not_done"]))
    print("counters of a: " + ", ".join(f"{n} {v}" for n, v in result["counters"].items()))


def start(words):
    as_root = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
    unshare = ["unshare", *as_root, "--net", "--mount", "--pid", "--fork", "--kill-child"]
    if subprocess.run([*unshare, "ip", "link", "add", "lan", "type", "bridge"], stderr=subprocess.DEVNULL).returncode != 0:
        print("error: no network namespaces can be made here", file=sys.stderr)
        sys.exit(3)
    os.execvp("unshare", [*unshare, sys.executable, __file__, "run", *words])


async def delay(port, address, to_port, seconds):
    async def pass_on(reader, writer, first_at_once):
        loop = asyncio.get_running_loop()
        try:
            while data := await reader.read(1 << 16):
                loop.call_later(0 if first_at_once else seconds, lambda data=data: writer.is_closing() or writer.write(data))
                first_at_once = False
        except OSError:
            pass
        loop.call_later(seconds, writer.close)

    # The first two packets of a connection and then the third one take their time; with the third one come the first bytes.
    async def take(reader, writer):
        await asyncio.sleep(3 * seconds)
        try:
            there_reader, there_writer = await asyncio.open_connection(address, to_port)
        except OSError:
            writer.close()
            return
        await asyncio.gather(pass_on(reader, there_writer, True), pass_on(there_reader, writer, False))

    server = await asyncio.start_server(take, "127.0.0.1", port, backlog=1024)
    await server.serve_forever()


def main():
    if sys.argv[1:2] == ["delay"]:
        port, address, to_port, ms = sys.argv[2:]
        asyncio.run(delay(int(port), address, int(to_port), int(ms) / 1000))
    parser = argparse.ArgumentParser(prog="scripts/attack")
    parser.add_argument("run")
    parser.add_argument("bin", type=lambda folder: pathlib.Path(folder).resolve())
    parser.add_argument("name", choices=MUST_GROW)
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--joins", type=int, default=20)
    parser.add_argument("--rate", type=float)
    parser.add_argument("--count", type=int)
    parser.add_argument("--addresses", type=int, default=1)
    parser.add_argument("--json")
    parser.add_argument("--keep", help="a folder for the logs of all")
    options = parser.parse_args()
    if options.run == "start":
        start(sys.argv[2:])
    sys.exit(0 if run(options) else 1)


if __name__ == "__main__":
    main()
