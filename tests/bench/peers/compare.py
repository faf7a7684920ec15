# SPDX-License-Identifier: Apache-2.0
"""Runs condyle's and the peers' filters on one recording; see `run`.

usage: compare.py PROGRAM_FOLDER RECORDING.csv PARAMETERS.toml
Exit codes: 0 same results, 1 a peer's results differ from condyle's, 2 cannot run.
"""

import csv
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile
import tomllib
import traceback

import numpy as np

HERE = pathlib.Path(__file__).parent
ROUNDS = 15
LARGEST_DIFFERENCE = 1e-9
COLUMNS = {"stage_1": ("p", "v", "F"), "cascade": ("p", "v", "F", "kv", "m")}


def stop(message):
    print(f"compare.py: {message}", file=sys.stderr)
    sys.exit(2)


class Peer:
    """A program that answers the commands of peer.h."""

    def __init__(self, label, command, input_path, filters=("stage_1", "cascade")):
        self.label = label
        self.filters = dict(zip(("stage_1", "cascade"), filters))  # by column of the table
        self.process = subprocess.Popen(
            [*command, input_path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def ask(self, *words):
        try:
            print(*words, file=self.process.stdin, flush=True)
            answer = self.process.stdout.readline()
        except BrokenPipeError:
            answer = ""
        if not answer:
            stop(f"{self.label}: the program ended with code {self.process.wait()}")
        return answer

    def ns_per_sample(self, what):
        return float(self.ask("time", self.filters[what]))

    def estimates(self, what, folder):
        path = folder / "estimates"
        self.ask("write", self.filters[what], path)
        return np.loadtxt(path, ndmin=2)

    def end(self):
        self.process.stdin.close()
        self.process.wait()


def read_positions(path):
    positions_m = []
    with open(path, newline="") as file:
        rows = csv.DictReader(file)
        if "position_m" not in (rows.fieldnames or []):
            stop(f"{path}, line 1: names no column position_m")
        for row in rows:
            try:
                positions_m.append(float(row["position_m"]))
            except (TypeError, ValueError):
                positions_m.append(math.nan)
            if not math.isfinite(positions_m[-1]):
                stop(
                    f"{path}, line {rows.line_num}: position_m is no finite number;"
                    " leave the row out, the peers know no missing samples"
                )
    if not positions_m:
        stop(f"{path}: has no samples")
    return positions_m


def read_parameters(path):
    """All numbers by their names, the section's before a dot."""
    with open(path, "rb") as file:
        sections = tomllib.load(file)
    values = {}
    for key, value in sections.items():
        entries = value if isinstance(value, dict) else {None: value}
        for name, entry in entries.items():
            values[f"{key}.{name}" if name else key] = entry if isinstance(entry, list) else [entry]
    discretisation = values.pop("motion.discretisation", ["forward"])
    values["motion.is_backward"] = [int(discretisation == ["backward"])]
    return values


def write_input(recording, parameters, path):
    """Lines of a name and its numbers, for all peers. Returns the number of samples."""
    try:
        values = read_parameters(parameters)
        values["position_m"] = read_positions(recording)
    except OSError as error:
        stop(f"{error.filename}: {error.strerror}")
    except tomllib.TOMLDecodeError as error:
        stop(f"{parameters}: {error}")
    with open(path, "w") as file:
        for name, numbers in values.items():
            print(name, *map(repr, numbers), file=file)
    return len(values["position_m"])


def difference(found, expected, what):
    """Greatest of all samples and columns, in units of the column's scale, and where it is."""
    if found.shape != expected.shape:
        return float("inf"), "number of results"
    scale = np.abs(expected).max(axis=0)
    relative = np.abs(found - expected).max(axis=0) / np.where(scale > 0, scale, 1)
    relative = np.where(np.isfinite(relative), relative, np.inf)
    worst = int(relative.argmax())
    names = COLUMNS[what]
    name = names[worst] if worst < len(names) else f"variance of {names[worst - len(names)]}"
    return float(relative[worst]), name


def three_digits(value):
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def main():
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        sys.exit(2)
    programs = pathlib.Path(sys.argv[1])
    with tempfile.TemporaryDirectory() as name:
        return compare(programs, sys.argv[2], sys.argv[3], pathlib.Path(name))


def compare(programs, recording, parameters, folder):
    input_path = folder / "input"
    samples = write_input(recording, parameters, input_path)
    condyle_program = [programs / "peer_condyle"]
    condyle = Peer(f"condyle, given {recording} and {parameters}", condyle_program, input_path)
    expected = {what: condyle.estimates(what, folder) for what in COLUMNS}
    for estimates in expected.values():
        if len(estimates) != samples or not np.isfinite(estimates).all():
            stop(f"{recording}: condyle has no finite estimate of each sample")
    peers = [
        Peer("condyle, all it reports", condyle_program, input_path, (None, "reported")),
        Peer("Eigen", [programs / "peer_eigen"], input_path),
        Peer("Eigen, condyle's options", [programs / "peer_eigen_as_condyle"], input_path),
        Peer("OpenCV KalmanFilter", [programs / "peer_opencv"], input_path),
        Peer("Orocos BFL", [programs / "peer_orocos_bfl"], input_path),
        Peer("numpy", [sys.executable, HERE / "numpy_filters.py"], input_path),
    ]
    asked = {peer: [what for what in COLUMNS if peer.filters[what]] for peer in peers}

    differences = {
        (peer, what): difference(peer.estimates(what, folder), expected[what], what)
        for peer in peers
        for what in asked[peer]
    }

    # Each peer beside a measurement of condyle right before it.
    times = {(peer, what): [] for peer in peers for what in asked[peer]}
    ratios = {key: [] for key in times}
    condyle_times = {what: [] for what in COLUMNS}
    for _ in range(ROUNDS):
        for peer, what in times:
            own = condyle.ns_per_sample(what)
            others = peer.ns_per_sample(what)
            condyle_times[what].append(own)
            times[peer, what].append(others)
            ratios[peer, what].append(others / own)
    for peer in [condyle, *peers]:
        peer.end()

    print(f"{samples} samples; CPU time, median of {ROUNDS} rounds; ratio: time / condyle's right before,")
    print("median (least to greatest); difference from condyle: greatest of all samples, estimates and")
    print("variances, in units of the greatest absolute value in condyle's column")
    columns = "{:<26}{:>11}{:>22}{:>11}{:>22}{:>13}"
    print(columns.format("", "stage 1", "ratio", "cascade", "ratio", "greatest"))
    print(columns.format("", "ns/sample", "", "ns/sample", "", "difference"))
    own = [three_digits(statistics.median(condyle_times[what])) for what in COLUMNS]
    print(columns.format("condyle", own[0], "1", own[1], "1", ""))
    failed = []
    for peer in peers:
        cells = []
        for what in COLUMNS:
            if what not in asked[peer]:
                cells += ["", ""]
                continue
            of_rounds = ratios[peer, what]
            ends = f"({three_digits(min(of_rounds))} to {three_digits(max(of_rounds))})"
            cells.append(three_digits(statistics.median(times[peer, what])))
            cells.append(f"{three_digits(statistics.median(of_rounds))} {ends}")
        found = {what: differences[peer, what] for what in asked[peer]}
        cells.append(f"{max(value for value, _ in found.values()):.1e}")
        print(columns.format(peer.label, *cells))
        for what, (value, column) in found.items():
            if not value <= LARGEST_DIFFERENCE:
                failed.append(f"{peer.label}, {what}: {column} differs by {value:.1e}")
    for line in failed:
        print(f"{line}; at most {LARGEST_DIFFERENCE:.0e} is the same result", file=sys.stderr)
    return 1 if failed else 0


try:
    code = main()
except Exception:
    traceback.print_exc()
    code = 2  # 1 says that results differ
sys.exit(code)
