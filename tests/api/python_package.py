# SPDX-License-Identifier: Apache-2.0
"""The Python package against the command: the same numbers, bit for bit, and clear errors."""

import json
import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import condyle

SOURCE = Path(os.environ["CONDYLE_SOURCE"])
COMMAND = os.environ["CONDYLE_COMMAND"]
CHEWING = SOURCE / "host_sim/recordings/chewing_60hz.csv"


def run(*words):
    """The command's standard output."""
    done = subprocess.run([COMMAND, *map(str, words)], check=True, capture_output=True, text=True)
    return done.stdout


def table(path):
    """Columns of a CSV file, as texts."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().rstrip("\n").split(",")
        rows = [line.rstrip("\n").split(",") for line in file]
    return {name: [row[i] for row in rows] for i, name in enumerate(names)}


class Equality(unittest.TestCase):
    """What the package gives is what the command writes."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def simulated(self, scenario, seconds):
        """The first seconds of a simulated recording."""
        path = self.folder / f"{scenario}.csv"
        run("simulate", SOURCE / f"host_sim/scenarios/{scenario}.toml", "--out", path)
        lines = path.read_text(encoding="utf-8").splitlines()
        begin = next(i for i, line in enumerate(lines) if line.startswith("time_s"))
        kept = [line for line in lines[begin + 1:] if float(line.split(",")[0]) <= seconds]
        path.write_text("\n".join(lines[: begin + 1] + kept) + "\n", encoding="utf-8")
        return path

    def assert_same(self, recording, options, words):
        out = self.folder / "estimates.csv"
        run("replay", recording, "--out", out, *words)
        expected = table(out)
        estimates = condyle.estimate(condyle.read(recording), **options)
        self.assertEqual(list(estimates), list(expected))
        for name, texts in expected.items():
            values = estimates[name]
            self.assertEqual(len(values), len(texts), name)
            if name == "events":
                continue
            if name.endswith("_provenance"):
                names = [condyle.Provenance(value).name.lower() for value in values]
                self.assertEqual([name.replace("not_computed", "") for name in names], texts)
            elif name.endswith("_limit"):
                self.assertEqual([value == 0 for value in values], [not text for text in texts])
            else:
                wanted = np.array([float(text) if text else math.nan for text in texts])
                # An infinite standard deviation is an empty field.
                shown = np.where(np.isfinite(values), values, np.nan)
                np.testing.assert_array_equal(shown.view(np.uint64)[~np.isnan(shown)],
                                              wanted.view(np.uint64)[~np.isnan(wanted)], name)
                np.testing.assert_array_equal(np.isnan(shown), np.isnan(wanted), name)
        counts = estimates.event_counts()
        for event, count in counts.items():
            in_file = sum(event in text.split("|") or event in text.split(" ")
                          or event in text.split(";") for text in expected["events"])
            self.assertEqual(count, in_file, event)
        return estimates

    def test_one_axis(self):
        self.assert_same(CHEWING, {}, [])

    def test_lag(self):
        self.assert_same(CHEWING, {"lag": 8}, ["--lag", "8"])

    def test_published_cascade(self):
        self.assert_same(CHEWING, {"estimator": "published"}, ["--estimator", "published"])

    def test_drive(self):
        recording = self.folder / "driven.csv"
        samples = condyle.read(CHEWING)
        drive_N = 0.3 * np.sin(samples.time_s) + 2 * samples.position_m
        drive_N[100:110] = np.nan
        rows = zip(samples.time_s.tolist(), samples.position_m.tolist(), drive_N.tolist())
        recording.write_text("time_s,position_m,drive_N\n" + "".join(
            f"{t!r},{x!r},{'' if math.isnan(f) else repr(f)}\n" for t, x, f in rows))
        estimates = self.assert_same(recording, {"drive_missing": 0}, ["--drive-missing", "0"])
        summary = json.loads(run("replay", recording, "--drive-missing", "0", "--json"))
        self.assertIsNotNone(estimates.friction_Ns_m_of_all)
        self.assertIn("friction", json.dumps(summary))

    def test_three_points(self):
        recording = self.simulated("clinical_session", 20)
        self.assertEqual(condyle.read(recording).position_m.shape[1:], (3, 3))
        self.assert_same(recording, {"point": 2, "axis": "y", "lag": 2},
                         ["--point", "2", "--axis", "y", "--lag", "2"])
        self.assert_same(recording, {"jaw_point_mm": (1, -2, 3)},
                         ["--jaw-point-mm", "1", "-2", "3"])

    def test_parameters(self):
        text = '[noise]\nadaptation = "off"\nposition_sd_m = 1e-4\njerk_density_m2_s5 = 10\n'
        path = self.folder / "parameters.toml"
        path.write_text(text, encoding="utf-8")
        self.assert_same(CHEWING, {"parameters": text}, ["--parameters", path])

    def test_readings(self):
        scenario = SOURCE / "host_sim/scenarios/clinical_session.toml"
        session = self.folder / "session.csv"
        run("simulate", scenario, "--out", session)
        landmarks = self.folder / "session.landmarks.toml"
        readings = condyle.analyse(session, landmarks=landmarks,
                                   tasks=self.folder / "session.tasks.csv")
        expected = json.loads(run("analyse", session, "--landmarks", landmarks, "--tasks",
                                  self.folder / "session.tasks.csv", "--json"))["recordings"][0]
        self.assertEqual(readings.details(), expected)
        self.assertEqual(len(readings), len(expected["readings"]))
        for one, other in zip(readings, expected["readings"]):
            self.assertEqual((one.reading, one.task, one.stroke), (
                other["reading"], other["task"], other["stroke"]))
            self.assertEqual(None if math.isnan(one.value) else one.value, other["value"])
        opening = readings.find("opening_mm", task="opening", stroke=None)
        self.assertEqual(len(opening), 1)
        self.assertEqual(opening[0].provenance, "measured")
        self.assertLess(opening[0].low, opening[0].high)
        self.assertIn("recording,", readings.file("cycles.csv"))
        with self.assertRaisesRegex(KeyError, "summary.txt"):
            readings.file("other")


class Arrays(unittest.TestCase):
    """Properties of estimates from arrays."""

    def setUp(self):
        random = np.random.default_rng(25)
        self.time_s = np.arange(3000) / 200
        self.position_m = 0.02 * np.sin(2 * np.pi * 1.3 * self.time_s) + random.normal(
            0, 1e-4, 3000)

    def test_sample_by_sample(self):
        for lag in (0, 3, 16):
            whole = condyle.estimate(self.time_s, self.position_m, lag=lag)
            estimator = condyle.Estimator(step_s=0.005, lag=lag)
            single = [estimate for time_s, position_m in zip(self.time_s, self.position_m)
                      if (estimate := estimator.push(time_s, position_m)) is not None]
            single += estimator.finish()
            self.assertEqual([one.followed.velocity_m_s.value for one in single],
                             list(whole.velocity_m_s))
            low, high = whole.interval("velocity_m_s")
            self.assertEqual([one.followed.velocity_m_s.low for one in single], list(low))
            self.assertEqual([one.followed.velocity_m_s.high for one in single], list(high))
            self.assertTrue(all(one.lag_s <= lag * 0.005 + 1e-9 for one in single))

    def test_missing_is_never_measured(self):
        random = np.random.default_rng(5)
        for _ in range(20):
            position_m = self.position_m.copy()
            missing = random.random(len(position_m)) < 0.1
            position_m[missing] = np.nan
            estimates = condyle.estimate(self.time_s, position_m)
            self.assertFalse(np.any(
                estimates.velocity_provenance[missing] == condyle.Provenance.MEASURED))
            self.assertEqual(estimates.event_counts()["position_missing"], missing.sum())

    def test_inputs_are_not_changed_and_may_be_strided(self):
        both = np.stack([self.position_m, self.position_m], axis=1)
        before = both.copy()
        strided = condyle.estimate(self.time_s, both[:, 0], unit="m")
        plain = condyle.estimate(self.time_s, self.position_m)
        np.testing.assert_array_equal(both, before)
        np.testing.assert_array_equal(strided.velocity_m_s, plain.velocity_m_s)
        in_mm = condyle.estimate(self.time_s, self.position_m * 1e3, unit="mm")
        np.testing.assert_allclose(in_mm.velocity_m_s, plain.velocity_m_s, rtol=1e-6, atol=1e-9)

    def test_times_of_a_clock(self):
        start = np.datetime64("2026-11-25T12:00:00", "ns")
        times = start + (self.time_s * 1e9).round().astype("timedelta64[ns]")
        with_date = condyle.estimate(times, self.position_m)
        plain = condyle.estimate(self.time_s, self.position_m)
        np.testing.assert_array_equal(with_date.velocity_m_s, plain.velocity_m_s)

    def test_wanted_columns(self):
        one = condyle.estimate(self.time_s, self.position_m, columns=["velocity_m_s"])
        self.assertEqual(list(one), ["velocity_m_s"])
        with self.assertRaisesRegex(condyle.InputError, "there is no speed"):
            condyle.estimate(self.time_s, self.position_m, columns=["speed"])

    def test_errors(self):
        estimate = condyle.estimate
        backwards = self.time_s.copy()
        backwards[1000] = 0
        for words, call in {
            "sample 1000 .*runs backwards": lambda: estimate(backwards, self.position_m),
            "2999 samples, but there are 3000": lambda: estimate(self.time_s, self.position_m[1:]),
            "has 2 coordinates": lambda: estimate(self.time_s, np.zeros((3000, 2))),
            "did you mean --lag": lambda: estimate(self.time_s, self.position_m, lagg=3),
            "in metres": lambda: estimate(self.time_s, self.position_m * 1e3),
            "unit: must be m or mm": lambda: estimate(self.time_s, self.position_m, unit="cm"),
            "kind": lambda: condyle.Estimator("two_axes"),
            "no_such.csv": lambda: condyle.read("no_such.csv"),
            "--movement": lambda: condyle.read(CHEWING, movement=0),
            "parameters:1": lambda: estimate(self.time_s, self.position_m, parameters="nois = 1"),
            "no_such.toml": lambda: condyle.analyse(CHEWING, landmarks="no_such.toml"),
        }.items():
            with self.subTest(words), self.assertRaisesRegex(condyle.InputError, words):
                call()
        with self.assertRaises(TypeError):
            estimate(self.time_s)
        self.assertEqual(estimate(backwards, self.position_m, faults="event")
                         .event_counts()["time_reversed"], 1)

    def test_empty(self):
        self.assertEqual(len(condyle.estimate([], []).velocity_m_s), 0)


class Example(unittest.TestCase):
    """The notebook's cells, in order. Those that draw need matplotlib."""

    def test_notebook(self):
        notebook = json.loads(
            (SOURCE / "host_sim/python/examples/chewing.ipynb").read_text(encoding="utf-8"))
        names = {}
        folder = os.getcwd()
        self.addCleanup(os.chdir, folder)
        os.chdir(SOURCE / "host_sim/python/examples")
        ran = 0
        for cell in notebook["cells"]:
            if cell["cell_type"] != "code":
                continue
            code = "".join(cell["source"])
            try:
                exec(compile(code, "chewing.ipynb", "exec"), names)
                ran += 1
            except ModuleNotFoundError as error:
                if error.name != "matplotlib":
                    raise
                print("not run, matplotlib is not installed:", code.splitlines()[0],
                      file=sys.stderr)
        self.assertGreaterEqual(ran, 4)


if __name__ == "__main__":
    unittest.main()
