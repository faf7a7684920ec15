# SPDX-License-Identifier: Apache-2.0
"""The C interface (condyle.h) by ctypes."""

from __future__ import annotations

import ctypes
import enum
import os
from ctypes import POINTER, Structure, c_char_p, c_double, c_int, c_int32, c_int64, c_size_t
from ctypes import c_uint32, c_void_p
from typing import Any, List

_SONAME = "libcondyle.so.0"


class Error(Exception):
    """A fault of the library, or no memory."""


class InputError(Error, ValueError):
    """A file, an option or a sample cannot be used: the place, the problem and the remedy."""


class Provenance(enum.IntEnum):
    """Where a value comes from."""

    NOT_COMPUTED = 0
    """There is no value: NaN."""
    ASSUMED = 1
    """The prior or the tuning determines it, not the subject."""
    DERIVED = 2
    """A measured quantity times a named assumption."""
    MEASURED = 3
    """The measurements determine it."""


class CValue(Structure):
    _fields_ = [
        ("value", c_double),
        ("sd", c_double),
        ("low", c_double),
        ("high", c_double),
        ("provenance", c_int32),
        ("limit", c_int32),
    ]


class CAxisEstimate(Structure):
    _fields_ = [
        ("position_m", CValue),
        ("velocity_m_s", CValue),
        ("acceleration_m_s2", CValue),
        ("noise_sd_m", c_double),
    ]


class CEstimate(Structure):
    _fields_ = [
        ("time_ns", c_int64),
        ("time_s", c_double),
        ("lag_s", c_double),
        ("events", c_uint32),
        ("axis_count", c_int32),
        ("followed", CAxisEstimate),
        ("axes", CAxisEstimate * 3),
        ("force_N", CValue),
        ("friction_Ns_m", CValue),
        ("mass_kg", CValue),
    ]


class CReading(Structure):
    _fields_ = [
        ("task", c_char_p),
        ("side", c_char_p),
        ("stroke", c_int32),
        ("name", c_char_p),
        ("value", c_double),
        ("low", c_double),
        ("high", c_double),
        ("unit", c_char_p),
        ("definition", c_char_p),
        ("provenance", c_char_p),
        ("reason", c_char_p),
    ]


_WORDS = POINTER(c_char_p)
_DOUBLES = POINTER(c_double)
_TIMES = POINTER(c_int64)

# Result and arguments of each function of condyle.h that is used.
_FUNCTIONS = {
    "condyle_version": (c_char_p, []),
    "condyle_last_error": (c_char_p, []),
    "condyle_event_name": (c_char_p, [c_int]),
    "condyle_event_count": (c_int, []),
    "condyle_limit_name": (c_char_p, [c_int]),
    "condyle_recording_read": (c_int, [c_char_p, _WORDS, c_size_t, POINTER(c_void_p)]),
    "condyle_recording_free": (None, [c_void_p]),
    "condyle_recording_kind": (c_int, [c_void_p]),
    "condyle_recording_count": (c_size_t, [c_void_p]),
    "condyle_recording_time_ns": (_TIMES, [c_void_p]),
    "condyle_recording_position": (_DOUBLES, [c_void_p]),
    "condyle_recording_drive_N": (_DOUBLES, [c_void_p]),
    "condyle_recording_step_s": (c_double, [c_void_p]),
    "condyle_recording_format": (c_char_p, [c_void_p]),
    "condyle_recording_note_count": (c_size_t, [c_void_p]),
    "condyle_recording_note": (c_char_p, [c_void_p, c_size_t]),
    "condyle_recording_parameters": (c_char_p, [c_void_p]),
    "condyle_estimator_create": (
        c_int,
        [c_int, c_int, c_double, c_char_p, _WORDS, c_size_t, POINTER(c_void_p)],
    ),
    "condyle_estimator_free": (None, [c_void_p]),
    "condyle_estimator_push": (c_int, [c_void_p, c_double, _DOUBLES, c_size_t, c_double]),
    "condyle_estimator_finish": (c_int, [c_void_p]),
    "condyle_estimator_take": (c_int, [c_void_p, POINTER(CEstimate), c_size_t]),
    "condyle_estimator_conclude": (c_int, [c_void_p, POINTER(CValue), POINTER(CValue)]),
    "condyle_estimator_column_count": (c_size_t, [c_void_p]),
    "condyle_estimator_column_name": (c_char_p, [c_void_p, c_size_t]),
    "condyle_estimator_run": (
        c_int,
        [c_void_p, c_size_t, _DOUBLES, _TIMES, _DOUBLES, c_size_t, _DOUBLES, POINTER(_DOUBLES),
         c_size_t],
    ),
    "condyle_median_step": (c_int, [c_size_t, _DOUBLES, _TIMES, _DOUBLES]),
    "condyle_analyse": (c_int, [c_char_p, _WORDS, c_size_t, POINTER(c_void_p)]),
    "condyle_readings_free": (None, [c_void_p]),
    "condyle_readings_count": (c_size_t, [c_void_p]),
    "condyle_readings_get": (c_int, [c_void_p, c_size_t, POINTER(CReading), c_size_t]),
    "condyle_readings_unusable": (c_char_p, [c_void_p]),
    "condyle_readings_file": (c_char_p, [c_void_p, c_char_p]),
}


def _load() -> Any:
    path = os.environ.get("CONDYLE_LIBRARY", _SONAME)
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise ImportError(
            f"{path} cannot be loaded ({error}); install the package libcondyle0, or set "
            "CONDYLE_LIBRARY to the path of the library"
        ) from None
    for name, (result, arguments) in _FUNCTIONS.items():
        try:
            function = getattr(library, name)
        except AttributeError:
            raise ImportError(
                f"{path} has no {name}; install libcondyle0 and python3-condyle of one version"
            ) from None
        function.restype = result
        function.argtypes = arguments
    return library


library = _load()

OK, NONE, BAD_CALL, BAD_INPUT = range(4)


def check(status: int) -> bool:
    """True for OK, False for NONE; else raises."""
    if status in (OK, NONE):
        return status == OK
    text = library.condyle_last_error().decode("utf-8", "replace")
    if status == BAD_INPUT:
        raise InputError(text)
    if status == BAD_CALL:
        raise TypeError(text)
    raise Error(text)


def version() -> str:
    """Version of the library."""
    return library.condyle_version().decode()


def text_of(text: bytes) -> str:
    """A text of the library."""
    return text.decode("utf-8", "replace")


class Handle:
    """An object of the library, which ends with this one."""

    def __init__(self, free: Any) -> None:
        self.pointer = c_void_p()
        self._free = free

    def __del__(self) -> None:
        if self.pointer:
            self._free(self.pointer)
            self.pointer = c_void_p()


# Options that are given once for each value; each of --task takes three words.
_SEVERAL = {"marker", "ignore_column", "columns", "task"}


def option_words(options: dict[str, Any]) -> List[str]:
    """The words of the command line for keywords: lag=8 is --lag=8."""
    words: List[str] = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, dict):
            words += [f"{option}={new}={old}" for new, old in value.items()]
        elif isinstance(value, (str, bytes, os.PathLike)) or not hasattr(value, "__iter__"):
            words.append(f"{option}={os.fspath(value) if isinstance(value, os.PathLike) else value}")
        elif name in _SEVERAL:
            for one in value:
                if isinstance(one, str):
                    words.append(f"{option}={one}")
                else:
                    words += [option, *(str(word) for word in one)]
        else:
            words += [option, *(str(word) for word in value)]
    return words


def word_array(options: dict[str, Any]) -> tuple[Any, int]:
    """The same for the library."""
    words = [os.fsencode(word) for word in option_words(options)]
    return (c_char_p * len(words))(*words), len(words)
