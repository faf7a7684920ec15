# SPDX-License-Identifier: Apache-2.0
"""Virtual sensor for jaw motion. Research use only; not a diagnosis.

    recording = condyle.read("session.mcap")          # a file of any format, as numpy arrays
    estimates = condyle.estimate(recording)           # velocity, acceleration, force; 95 % intervals
    estimates = condyle.estimate(time_s, position_m)  # the same from arrays
    readings = condyle.analyse("session.csv", landmarks="session.landmarks.toml")

Options are keywords: ``lag=8`` is ``--lag=8`` of the command ``condyle``. The command's pages
describe them.
"""

from ._estimates import Estimates, Value, estimate
from ._estimator import AxisEstimate, Estimate, Estimator
from ._library import Error, InputError, Provenance, version
from ._readings import Reading, Readings, analyse
from ._recording import Recording, read

__version__ = version()

__all__ = [
    "AxisEstimate",
    "Error",
    "Estimate",
    "Estimates",
    "Estimator",
    "InputError",
    "Provenance",
    "Reading",
    "Readings",
    "Recording",
    "Value",
    "analyse",
    "estimate",
    "read",
    "version",
]
