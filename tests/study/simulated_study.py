# SPDX-License-Identifier: Apache-2.0
"""A data set of simulated subjects, and how a run of `condyle study` is started and measured. A few
dozen recordings are simulated; the data set has hard links to them, so files of one task repeat."""
import os
import subprocess
import time

SEEDS = 9  # recordings of each task
SESSIONS = 3
TASKS = {"opening": "[opening]\nstrokes = 2\n", "protrusion": "[protrusion]\nstrokes = 2\n",
         "left": "[left]\nstrokes = 2\n", "chewing": '[chewing]\nduration_s = 6\nside = "right"\n'}
SCENARIO = """[kinematic]
[rest]
duration_s = 1
{}[facebow]
rate_Hz = 60
noise_m = 0.00002
noise_rad = 0.0008
[landmarks]
condyle_sd_mm = 1
incisor_sd_mm = 0.5
plane_sd_mm = 1
"""
ENDINGS = (".csv", ".landmarks.toml", ".tasks.csv")


def make(condyle, folder, subjects):
    """Writes the data set of `subjects` x SESSIONS x TASKS; returns the number of recordings."""
    sources, dataset = os.path.join(folder, "simulated"), os.path.join(folder, "dataset")
    os.mkdir(sources)
    os.mkdir(dataset)
    for number, (task, stretch) in enumerate(TASKS.items()):
        scenario = os.path.join(sources, f"{task}.toml")
        with open(scenario, "w", encoding="utf-8") as file:
            file.write(SCENARIO.format(stretch))
        for seed in range(SEEDS):
            subprocess.run([condyle, "simulate", scenario, "--seed", str(100 * number + seed + 1),
                            "--out", os.path.join(sources, f"{task}{seed}.csv")],
                           check=True, stdout=subprocess.DEVNULL)
    rows = ["recording,subject,session,task"]
    for subject in range(subjects):
        for session in range(SESSIONS):
            for task in TASKS:
                name = f"sub-{subject + 1:04d}_ses-{session + 1}_task-{task}"
                seed = (SESSIONS * subject + session) % SEEDS
                for ending in ENDINGS:
                    os.link(os.path.join(sources, f"{task}{seed}{ending}"),
                            os.path.join(dataset, name + ending))
                rows.append(f"{name}.csv,{subject + 1:04d},{session + 1},{task}")
    with open(os.path.join(dataset, "recordings.csv"), "w", encoding="utf-8") as file:
        file.write("\n".join(rows) + "\n")
    return len(rows) - 1


def done(out):
    """Recordings with results in the folder `out`."""
    return sum("provenance.json" in files for _, _, files in os.walk(out))


def bytes_below(folder):
    total = 0
    for path, _, files in os.walk(folder):
        for name in files:
            try:
                total += os.path.getsize(os.path.join(path, name))
            except OSError:  # it was moved meanwhile
                pass
    return total


def children(process):
    try:
        with open(f"/proc/{process}/task/{process}/children", encoding="ascii") as file:
            return [int(word) for word in file.read().split()]
    except OSError:
        return []


def files_open(process):
    try:
        return len(os.listdir(f"/proc/{process}/fd"))
    except OSError:
        return 0


class Run:
    """One run of a level; `watch` ends it with SIGKILL if asked, and measures it."""

    def __init__(self, condyle, folder, out, level, *more):
        self.out = os.path.join(folder, out)
        # Not a pipe: the killed process leaves nothing to drain.
        self.said = open(os.path.join(folder, f"{out}.said"), "w+", encoding="utf-8")
        self.start = time.monotonic()
        self.process = subprocess.Popen(
            [condyle, "study", os.path.join(folder, "dataset"), self.out, level, *more],
            stdout=self.said, stderr=subprocess.STDOUT)
        self.memory_MB = self.seconds = self.core_s = 0
        self.open_files = self.temporary_bytes = 0

    def watch(self, kill_when=lambda: False):
        """Returns the exit code, and measures until the process has ended."""
        while True:
            process, status, used = os.wait4(self.process.pid, os.WNOHANG)
            if process:
                break
            if kill_when():
                self.process.kill()
                process, status, used = os.wait4(self.process.pid, 0)
                break
            processes = [self.process.pid] + children(self.process.pid)
            self.open_files = max(self.open_files, sum(map(files_open, processes)))
            self.temporary_bytes = max(self.temporary_bytes,
                                       bytes_below(os.path.join(self.out, ".work")))
            time.sleep(0.02)
        self.process.returncode = os.waitstatus_to_exitcode(status)
        self.seconds = time.monotonic() - self.start
        self.memory_MB = used.ru_maxrss / 1024  # of the largest process
        self.core_s = used.ru_utime + used.ru_stime
        return self.process.returncode

    def text(self):
        self.said.seek(0)
        return self.said.read()


def must(condyle, folder, out, level, *more):
    """A run that must succeed."""
    run = Run(condyle, folder, out, level, *more)
    if run.watch() != 0:
        raise RuntimeError(f"the {level} level of {out} failed:\n{run.text()}")
    if level == "group":
        with open(os.path.join(run.out, "group", "problems.csv"), encoding="utf-8") as file:
            problems = file.read().splitlines()
        if len(problems) != 1:  # the names of the columns
            raise RuntimeError(f"{out} has problems:\n" + "\n".join(problems[:3]))
    return run


def differences(folder, one, other):
    """What `diff -r` finds between two results."""
    found = subprocess.run(["diff", "-r", "--brief", one, other], cwd=folder, capture_output=True,
                           text=True)
    return (found.stdout + found.stderr).splitlines()
