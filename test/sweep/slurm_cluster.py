# SPDX-License-Identifier: BSD-3-Clause
"""A Slurm cluster of one node on this machine: loopback only, with its own folder, ports, keys and munge."""
import os
import pathlib
import secrets
import shutil
import socket
import subprocess
import time

PROGRAMS = {'munged': 'munge', 'slurmctld': 'slurmctld', 'slurmd': 'slurmd', 'sbatch': 'slurm-client'}
PATIENCE = 60.0

CONFIGURATION = """# SPDX-License-Identifier: BSD-3-Clause
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={controller}
SlurmdPort={node}
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0
MinJobAge=10
ReturnToService=2
MaxArraySize=100
NodeName=localhost NodeAddr=127.0.0.1 NodeHostname={host} Port={node} CPUs=2 State=UNKNOWN
PartitionName=test Nodes=localhost Default=YES MaxTime=INFINITE State=UP
"""


def why_not():
    """What this machine lacks to run a cluster; empty: nothing."""
    path = '/usr/sbin:/sbin:' + os.environ['PATH']
    missing = [package for program, package in PROGRAMS.items() if not shutil.which(program, path=path)]
    if missing:
        return 'Slurm is not installed (Debian: %s)' % ' '.join(missing)
    if os.geteuid() != 0:
        return 'a Slurm cluster of its own needs root'
    return ''


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    try:
        for one in sockets:
            one.bind(('127.0.0.1', 0))
        return [one.getsockname()[1] for one in sockets]
    finally:
        for one in sockets:
            one.close()


class Cluster:
    """Runs from start() to stop(). `environment` is what the programs of Slurm need to find it."""

    def __init__(self, folder):
        self.folder, self.processes = pathlib.Path(folder), {}
        self.configuration = self.folder / 'slurm.conf'
        self.environment = dict(os.environ, SLURM_CONF=str(self.configuration), PATH='/usr/sbin:' + os.environ['PATH'])

    def start(self):
        for name in ('state', 'spool'):
            (self.folder / name).mkdir(parents=True)
        os.chmod(self.folder, 0o755)
        controller, node = free_ports(2)
        self.configuration.write_text(CONFIGURATION.format(folder=self.folder, controller=controller, node=node,
                                                           host=socket.gethostname().split('.')[0]))
        key = self.folder / 'munge.key'
        key.touch(mode=0o600)
        key.write_bytes(secrets.token_bytes(128))
        files = ['--%s=%s/munge.%s' % (kind, self.folder, end) for kind, end in (
            ('socket', 'socket'), ('key-file', 'key'), ('pid-file', 'pid'), ('log-file', 'log'), ('seed-file', 'seed'))]
        self.launch('munged', 'munged', '--foreground', '--force', *files)
        self.wait_for(lambda: (self.folder / 'munge.socket').exists())
        self.start_controller()
        self.launch('slurmd', 'slurmd', '-D', '-N', 'localhost', '-f', str(self.configuration))
        self.wait_for(lambda: 'idle' in self.ask('sinfo', '--noheader', '--format=%T'))

    def start_controller(self):
        self.launch('slurmctld', 'slurmctld', '-D', '-f', str(self.configuration))
        self.wait_for(lambda: 'UP' in self.ask('scontrol', 'ping'))

    def restart_controller(self):
        self.end('slurmctld')
        self.start_controller()

    def launch(self, name, *command):
        log = open(self.folder / (name + '.out'), 'ab')
        self.processes[name] = subprocess.Popen(command, env=self.environment, stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                                start_new_session=True)
        log.close()

    def ask(self, *command):
        return subprocess.run(command, env=self.environment, text=True, capture_output=True, check=False, timeout=PATIENCE).stdout

    def wait_for(self, holds):
        deadline = time.monotonic() + PATIENCE
        while not holds():
            ended = [name for name, process in self.processes.items() if process.poll() is not None]
            if ended or time.monotonic() > deadline:
                raise RuntimeError('%s: %s' % (ended or 'Slurm is not ready', self.logs()))
            time.sleep(0.1)

    def logs(self):
        return '\n'.join('%s: %s' % (path.name, path.read_text(errors='replace')[-1500:])
                         for path in [*self.folder.glob('*.out'), *self.folder.glob('*.log')])

    def end(self, name):
        process = self.processes.pop(name, None)
        if process:
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def stop(self):
        if 'slurmctld' in self.processes:
            self.ask('scancel', '--user=root')
            self.ask('scancel', '--signal=KILL', '--full', '--user=root')
        for name in ('slurmd', 'slurmctld', 'munged'):
            self.end(name)
