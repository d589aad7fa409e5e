"""A Slurm of one computer, in a folder and with ports, a key and daemons of its own; Debian's slurm-wlm and munge.

`with LocalSlurm(folder, processors) as slurm:` starts it, and ends its jobs and daemons behind. No control groups, no
accounts: it needs neither systemd nor root."""
import os
import pathlib
import pwd
import shutil
import signal
import socket
import subprocess
import time

DAEMONS = ("munged", "slurmctld", "slurmd")
PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"
START_S = 60  # within which a daemon is up, on a busy computer


def missing():
    """The programs that are not installed here."""
    return [p for p in (*DAEMONS, "sbatch", "squeue", "scancel", "sinfo") if shutil.which(p, path=PATH) is None]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


class LocalSlurm:
    def __init__(self, folder, processors=2, array_size=50):
        self.folder = pathlib.Path(folder)
        self.processors = processors
        self.array_size = array_size
        self.running = []
        self.environment = {**os.environ, "PATH": PATH, "SLURM_CONF": str(self.folder / "slurm.conf")}

    def __enter__(self):
        for part in ("munge", "state", "spool"):
            (self.folder / part).mkdir(parents=True)
        key = self.folder / "munge/key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o600)
        self.write_configuration()
        try:
            munge = self.folder / "munge"
            self.start("munged", "--foreground", f"--socket={munge}/socket", f"--key-file={key}", f"--pid-file={munge}/pid",
                       f"--log-file={munge}/log", f"--seed-file={munge}/seed")
            self.wait_for(lambda: (munge / "socket").exists(), "munged's socket")
            self.start("slurmctld", "-D", "-f", self.folder / "slurm.conf")
            self.start("slurmd", "-D", "-N", "node", "-f", self.folder / "slurm.conf")
            self.wait_for(lambda: "idle" in self.run("sinfo", "-h", "-o", "%T").stdout, "an idle node")
        except BaseException:
            self.end()
            raise
        return self

    def __exit__(self, *_):
        try:
            for job in set(self.jobs()):
                self.run("scancel", "--signal=KILL", job)
                self.run("scancel", job)
            self.wait_for(lambda: not self.jobs(), "the end of all jobs")
        finally:
            self.end()

    def write_configuration(self):
        controller, node = free_ports(2)
        host = socket.gethostname().split(".")[0]
        user = pwd.getpwuid(os.getuid()).pw_name
        (self.folder / "cgroup.conf").write_text("")
        (self.folder / "slurm.conf").write_text(f"""ClusterName=scratch
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={self.folder}/munge/socket
SlurmUser={user}
SlurmdUser={user}
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1
KillWait=5
MaxArraySize={self.array_size}
NodeName=node NodeAddr=127.0.0.1 NodeHostname={host} CPUs={self.processors} State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
""")

    def start(self, *command):
        command = [str(word) for word in command]
        with open(self.folder / f"{command[0]}.txt", "wb") as log:
            self.running.append((command[0], subprocess.Popen([shutil.which(command[0], path=PATH), *command[1:]],
                                                              env=self.environment, stdin=subprocess.DEVNULL,
                                                              stdout=log, stderr=log)))

    def end(self):
        """Ends the daemons, the last one first."""
        while self.running:
            _, process = self.running.pop()
            process.send_signal(signal.SIGTERM)
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def run(self, *command):
        return subprocess.run(command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def jobs(self):
        """The ids of jobs that wait, run or end."""
        return self.run("squeue", "--noheader", "--format=%F").stdout.split()

    def wait_for(self, done, what):
        give_up = time.monotonic() + START_S
        while not done():
            gone = [name for name, process in self.running if process.poll() is not None]
            if gone or time.monotonic() > give_up:
                logs = "\n".join(f"{log}:\n{log.read_text(errors='replace')[-2000:]}" for log in self.folder.glob("*.txt"))
                raise RuntimeError(f"no {what}{'; ' + ', '.join(gone) + ' ended' if gone else ''}\n{logs}")
            time.sleep(0.1)
