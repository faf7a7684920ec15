# SPDX-License-Identifier: Apache-2.0
"""Recordings as numpy arrays."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass, field
from typing import Any, Optional, Tuple, Union

import numpy as np

from ._library import Handle, check, library, text_of, word_array

KINDS = ("one_axis", "one_point", "three_points", "pose")
"""What a sample consists of."""
WIDTHS = (1, 3, 9, 7)
"""Number of coordinates of each kind."""

NO_TIME = np.iinfo(np.int64).min


@dataclass(frozen=True)
class Recording:
    """All samples of a recording. A missing value is NaN."""

    source: str
    kind: str
    """one_axis, one_point, three_points or pose."""
    time_ns: np.ndarray
    """Times (int64 nanoseconds, exact); the smallest number stands for a missing time."""
    coordinates: np.ndarray
    """One row a sample, 1, 3, 9 or 7 coordinates (m; a pose ends in a unit quaternion w x y z)."""
    drive_N: Optional[np.ndarray]
    """The measured drive; None without."""
    step_s: float
    """Time between samples by which gaps are found; 0: not known."""
    format: str
    notes: Tuple[str, ...] = field(default=())
    """What was recognised or left out."""
    parameters: str = ""
    """Parameters that the recording holds, as TOML."""

    def __len__(self) -> int:
        return len(self.time_ns)

    @property
    def time_s(self) -> np.ndarray:
        """Times (s); NaN if missing."""
        return np.where(self.time_ns == NO_TIME, np.nan, self.time_ns / 1e9)

    @property
    def position_m(self) -> np.ndarray:
        """Positions (m): (samples,), (samples, 3), or (samples, 3, 3) for three points."""
        if self.kind == "one_axis":
            return self.coordinates[:, 0]
        if self.kind == "three_points":
            return self.coordinates.reshape(-1, 3, 3)
        return self.coordinates[:, :3]

    @property
    def quaternion(self) -> Optional[np.ndarray]:
        """Orientations, w x y z: (samples, 4); None unless the samples are poses."""
        return self.coordinates[:, 3:] if self.kind == "pose" else None


def _copy(pointer: Any, shape: Tuple[int, ...]) -> np.ndarray:
    if 0 in shape:
        return np.empty(shape)
    return np.ctypeslib.as_array(pointer, shape).copy()


def read(source: Union[str, "os.PathLike[str]"], **options: Any) -> Recording:
    """Reads all of a recording, in any format that the command ``condyle`` reads.

    Options are those of ``condyle replay``: faults="event", marker=["A", "B", "C"],
    columns={"time_s": "T"}, rate_Hz=100, unit="mm", profile=..., movement=..., ignore_column=[...].
    Raises InputError, which names the place, the problem and the remedy.
    """
    name = os.fspath(source)
    words, count = word_array(options)
    handle = Handle(library.condyle_recording_free)
    check(
        library.condyle_recording_read(
            os.fsencode(name), words, count, ctypes.byref(handle.pointer)
        )
    )
    made = handle.pointer
    samples = library.condyle_recording_count(made)
    kind = library.condyle_recording_kind(made)
    drive = library.condyle_recording_drive_N(made)
    return Recording(
        source=name,
        kind=KINDS[kind],
        time_ns=_copy(library.condyle_recording_time_ns(made), (samples,)),
        coordinates=_copy(library.condyle_recording_position(made), (samples, WIDTHS[kind])),
        drive_N=_copy(drive, (samples,)) if drive else None,
        step_s=library.condyle_recording_step_s(made),
        format=text_of(library.condyle_recording_format(made)),
        notes=tuple(
            text_of(library.condyle_recording_note(made, i))
            for i in range(library.condyle_recording_note_count(made))
        ),
        parameters=text_of(library.condyle_recording_parameters(made)),
    )
