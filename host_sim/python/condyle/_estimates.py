# SPDX-License-Identifier: Apache-2.0
"""Estimates over whole arrays."""

from __future__ import annotations

import ctypes
import math
from typing import Any, Dict, Iterable, Iterator, List, Mapping, NamedTuple, Optional, Tuple, Union

import numpy as np

from ._library import CValue, Handle, InputError, Provenance, check, library, text_of, word_array
from ._recording import KINDS, WIDTHS, Recording

_DOUBLES = ctypes.POINTER(ctypes.c_double)
_QUANTILE_95 = 1.959963984540054


class Value(NamedTuple):
    """A value with its 95 % interval; NaN without one."""

    value: float
    sd: float
    low: float
    high: float
    provenance: Provenance
    limit: str
    """Why it is withheld; empty if it is not."""


def value_of(of: CValue) -> Value:
    """The value of a structure of the library."""
    return Value(of.value, of.sd, of.low, of.high, Provenance(of.provenance),
                 text_of(library.condyle_limit_name(of.limit)))


class Estimates(Mapping[str, np.ndarray]):
    """Estimates, one array for each column of the command's file of estimates.

    ``estimates["velocity_m_s"]`` is the same as ``estimates.velocity_m_s``. A missing value is NaN.
    Columns that end in _provenance hold numbers of Provenance, ``events`` sets of bits.
    """

    def __init__(self, columns: Dict[str, np.ndarray], friction: Optional[Value],
                 mass: Optional[Value]) -> None:
        self._columns = columns
        self.friction_Ns_m_of_all = friction
        """Friction from all samples; None without a drive."""
        self.mass_kg_of_all = mass
        """Mass from all samples; None without a drive."""

    def __getitem__(self, name: str) -> np.ndarray:
        return self._columns[name]

    def __getattr__(self, name: str) -> np.ndarray:
        try:
            return self.__dict__["_columns"][name]
        except KeyError:
            raise AttributeError(f"there is no column {name}; see list(estimates)") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        rows = len(next(iter(self._columns.values()), ()))
        return f"<condyle.Estimates: {rows} samples, {len(self)} columns>"

    def interval(self, name: str) -> Tuple[np.ndarray, np.ndarray]:
        """Low and high ends of the 95 % intervals of the column ``name``, such as velocity_m_s."""
        for stem in ("position", "velocity", "acceleration", "force", "friction", "mass"):
            value = name[2:] if name[:2] in ("x_", "y_", "z_") else name
            if value.startswith(stem + "_"):
                prefix = name[: len(name) - len(value)]
                sd = self[prefix + stem + "_sd" + value[len(stem):]]
                half = _QUANTILE_95 * sd
                return self[name] - half, self[name] + half
        raise KeyError(f"{name} has no interval")

    def event_counts(self) -> Dict[str, int]:
        """How often each event happened, those that did."""
        counts = {}
        for bit in range(library.condyle_event_count()):
            count = int(np.count_nonzero(self["events"] & np.uint32(1 << bit)))
            if count:
                counts[text_of(library.condyle_event_name(bit))] = count
        return counts


def _of_unit(unit: str) -> float:
    if unit not in ("m", "mm"):
        raise InputError(f"unit: must be m or mm, not {unit!r}")
    return 1.0 if unit == "m" else 1e-3


def _times(time: Any) -> Tuple[Any, Any, int]:
    """Seconds or nanoseconds for the library, and their number."""
    array = np.asarray(time)
    if array.ndim != 1:
        raise InputError(f"time_s: has {array.ndim} dimensions; give one time for each sample")
    if array.dtype.kind in "mM":
        return None, np.ascontiguousarray(array.astype(array.dtype.kind + "8[ns]").view(np.int64)), len(array)
    return np.ascontiguousarray(array, dtype=np.float64), None, len(array)


def coordinates_of(position: Any, kind: Optional[str], unit: str) -> Tuple[np.ndarray, int]:
    """Rows of coordinates for the library, and the index of their kind."""
    array = np.asarray(position, dtype=np.float64)
    rows = array.reshape(array.shape[0] if array.ndim else 1, math.prod(array.shape[1:]))
    if kind is not None and kind not in KINDS:
        raise InputError(f"kind: must be one of {', '.join(KINDS)}, not {kind!r}")
    index = KINDS.index(kind) if kind is not None else -1
    if index < 0 and rows.shape[1] in WIDTHS:
        index = WIDTHS.index(rows.shape[1])
    if index < 0 or rows.shape[1] != WIDTHS[index]:
        raise InputError(
            f"position_m: has {rows.shape[1]} coordinates a sample; give 1 (one axis), 3 (x y z), "
            "9 (three points), or 7 (a pose)"
        )
    factor = _of_unit(unit)
    if factor != 1.0:
        rows = rows.copy()
        rows[:, : 3 if KINDS[index] == "pose" else None] *= factor
    return np.ascontiguousarray(rows), index


def _pointer(array: Optional[np.ndarray], of: Any = ctypes.c_double) -> Any:
    return None if array is None else array.ctypes.data_as(ctypes.POINTER(of))


def _dtype(name: str) -> Any:
    if name == "events":
        return np.uint32
    return np.uint8 if name.endswith(("_provenance", "_limit")) else np.float64


def _new_estimator(kind: int, has_drive: bool, step_s: float, parameters: Optional[str],
                   options: Dict[str, Any]) -> Handle:
    words, count = word_array(options)
    handle = Handle(library.condyle_estimator_free)
    text = None if parameters is None else parameters.encode()
    check(library.condyle_estimator_create(kind, has_drive, step_s, text, words, count,
                                           ctypes.byref(handle.pointer)))
    return handle


def estimate(
    time_s: Union[Recording, Any],
    position_m: Any = None,
    drive_N: Any = None,
    *,
    kind: Optional[str] = None,
    unit: str = "m",
    step_s: Optional[float] = None,
    parameters: Optional[str] = None,
    columns: Optional[Iterable[str]] = None,
    **options: Any,
) -> Estimates:
    """Estimates from arrays, or from a Recording, as ``condyle replay`` does from a file.

    time_s: times (s), or datetime64 or timedelta64; or a Recording, and nothing else.
    position_m: (n,) along one axis, (n, 3) a point, (n, 3, 3) or (n, 9) three points, (n, 7) a
        pose; NaN if missing. In mm with unit="mm".
    drive_N: the sum of all forces on the jaw along the followed axis (n,).
    step_s: time between samples, for finding gaps; the median if not given, 0: none are found.
    parameters: text of a parameter file (TOML).
    columns: names of the wanted columns; all if not given.
    Further options are those of the command: lag=8, axis="y", point=2, estimator="published",
    faults="event", drive_missing=0 ...

    Raises InputError for samples or options that cannot be used.
    """
    if isinstance(time_s, Recording):
        if position_m is not None or drive_N is not None:
            raise TypeError("a Recording is given alone; leave out position_m and drive_N")
        recording = time_s
        seconds, nanoseconds, count = None, recording.time_ns, len(recording)
        rows, index = coordinates_of(recording.coordinates, recording.kind, unit)
        drive_N = recording.drive_N
        step_s = recording.step_s if step_s is None else step_s
        if parameters is None and recording.parameters and "parameters" not in options:
            parameters = recording.parameters
    else:
        if position_m is None:
            raise TypeError("position_m is missing; give times and positions, or a Recording")
        seconds, nanoseconds, count = _times(time_s)
        rows, index = coordinates_of(position_m, kind, unit)
    drive = None if drive_N is None else np.ascontiguousarray(drive_N, dtype=np.float64)
    for name, array in (("position_m", rows), ("drive_N", drive)):
        if array is not None and len(array) != count:
            raise InputError(f"{name}: has {len(array)} samples, but there are {count} times")
    times, times_ns = _pointer(seconds), _pointer(nanoseconds, ctypes.c_int64)
    if step_s is None:
        median = ctypes.c_double()
        check(library.condyle_median_step(count, times, times_ns, ctypes.byref(median)))
        step_s = median.value

    handle = _new_estimator(index, drive is not None, step_s, parameters, options)
    made = handle.pointer
    names: List[str] = [
        text_of(library.condyle_estimator_column_name(made, i))
        for i in range(library.condyle_estimator_column_count(made))
    ]
    wanted = names if columns is None else list(columns)
    unknown = [name for name in wanted if name not in names]
    if unknown:
        raise InputError(f"columns: there is no {', '.join(unknown)}; there are {', '.join(names)}")
    results = {name: np.empty(count) for name in names if name in wanted}
    pointers = (_DOUBLES * len(names))(
        *(_pointer(results.get(name)) for name in names)
    )
    check(library.condyle_estimator_run(made, count, times, times_ns, _pointer(rows),
                                        WIDTHS[index], _pointer(drive), pointers, len(names)))
    for name, array in results.items():
        if _dtype(name) is not np.float64:
            results[name] = array.astype(_dtype(name))
    friction = mass = None
    if drive is not None and options.get("estimator") != "published":
        c_friction, c_mass = CValue(), CValue()
        check(library.condyle_estimator_conclude(made, c_friction, c_mass))
        friction, mass = value_of(c_friction), value_of(c_mass)
    return Estimates(results, friction, mass)
