# SPDX-License-Identifier: Apache-2.0
"""Readings: range of motion, condylar paths, chewing."""

from __future__ import annotations

import ctypes
import json
import os
from typing import Any, Dict, Iterator, List, NamedTuple, Optional, Sequence, Union, overload

from ._library import CReading, Handle, check, library, text_of, word_array


class Reading(NamedTuple):
    """One number about a jaw's motion, with its 95 % interval; NaN if it is withheld."""

    task: str
    """opening, protrusion, left ...; empty: the whole recording."""
    side: str
    """left, right or empty."""
    stroke: Optional[int]
    """From 1; None: of the whole task."""
    reading: str
    value: float
    low: float
    high: float
    unit: str
    definition: str
    provenance: str
    """measured, derived or withheld."""
    reason: str
    """Why it is withheld, or what a derived one assumes."""


class Readings(Sequence[Reading]):
    """The readings of a recording. ``pandas.DataFrame(readings)`` makes a table of them."""

    def __init__(self, handle: Handle) -> None:
        self._handle = handle
        self.unusable: str = text_of(library.condyle_readings_unusable(handle.pointer))
        """Why no reading can be trusted; empty: they can be."""
        self._readings: List[Reading] = []
        for i in range(library.condyle_readings_count(handle.pointer)):
            of = CReading()
            check(library.condyle_readings_get(handle.pointer, i, of, ctypes.sizeof(of)))
            self._readings.append(
                Reading(text_of(of.task), text_of(of.side), of.stroke or None, text_of(of.name),
                        of.value, of.low, of.high, text_of(of.unit), text_of(of.definition),
                        text_of(of.provenance), text_of(of.reason))
            )

    @overload
    def __getitem__(self, index: int) -> Reading: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Reading]: ...
    def __getitem__(self, index: Union[int, slice]) -> Union[Reading, Sequence[Reading]]:
        return self._readings[index]

    def __len__(self) -> int:
        return len(self._readings)

    def __iter__(self) -> Iterator[Reading]:
        return iter(self._readings)

    def find(self, reading: str, **where: Any) -> List[Reading]:
        """Those called ``reading``; where: task="opening", side="left", stroke=None ..."""
        return [
            one for one in self._readings
            if one.reading == reading
            and all(getattr(one, name) == value for name, value in where.items())
        ]

    def file(self, name: str) -> str:
        """The text of a file that ``condyle analyse --out`` writes: readings.csv, readings.json,
        cycles.csv, average_cycle.csv or summary.txt."""
        text = library.condyle_readings_file(self._handle.pointer, name.encode())
        if text is None:
            raise KeyError(text_of(library.condyle_last_error()))
        return text_of(text)

    def details(self) -> Dict[str, Any]:
        """The recording's entry of readings.json: tasks, noise, notes ..."""
        return json.loads(self.file("readings.json"))["recordings"][0]


def analyse(source: Union[str, "os.PathLike[str]"], **options: Any) -> Readings:
    """Reads range of motion, condylar paths, chewing and smoothness from a recording.

    Options are those of ``condyle analyse``: landmarks=..., tasks=..., reference_s=(0, 1),
    task=[("opening", 1, 5)], jaw="A,B,C", head="D,E,F", moving="upper", marker=[...] ...
    """
    words, count = word_array(options)
    handle = Handle(library.condyle_readings_free)
    check(library.condyle_analyse(os.fsencode(source), words, count,
                                  ctypes.byref(handle.pointer)))
    return Readings(handle)
