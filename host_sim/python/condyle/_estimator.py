# SPDX-License-Identifier: Apache-2.0
"""Estimates sample by sample, as a device delivers them."""

from __future__ import annotations

import ctypes
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

from ._estimates import Value, _new_estimator, value_of
from ._library import CAxisEstimate, CEstimate, InputError, check, library, text_of
from ._recording import KINDS, WIDTHS


class AxisEstimate(NamedTuple):
    """What is known of one axis at one instant."""

    position_m: Value
    velocity_m_s: Value
    acceleration_m_s2: Value
    noise_sd_m: float


class Estimate(NamedTuple):
    """What is known at one instant."""

    time_s: float
    lag_s: float
    """From this instant to the last sample given."""
    followed: AxisEstimate
    """The axis of the option ``axis``."""
    axes: Tuple[AxisEstimate, ...]
    force_N: Value
    friction_Ns_m: Value
    mass_kg: Value
    events: Tuple[str, ...]


def _axis(of: CAxisEstimate) -> AxisEstimate:
    return AxisEstimate(value_of(of.position_m), value_of(of.velocity_m_s),
                        value_of(of.acceleration_m_s2), of.noise_sd_m)


def _estimate(of: CEstimate) -> Estimate:
    return Estimate(
        of.time_s,
        of.lag_s,
        _axis(of.followed),
        tuple(_axis(of.axes[i]) for i in range(of.axis_count)),
        value_of(of.force_N),
        value_of(of.friction_Ns_m),
        value_of(of.mass_kg),
        tuple(
            text_of(library.condyle_event_name(bit))
            for bit in range(library.condyle_event_count())
            if of.events >> bit & 1
        ),
    )


class Estimator:
    """An estimator for samples as they come.

    kind: one_axis, one_point, three_points or pose. step_s: time between samples, for finding gaps;
    0: none are found. parameters: text of a parameter file. Options: as for ``estimate``.
    """

    def __init__(self, kind: str = "one_axis", *, has_drive: bool = False, step_s: float = 0.0,
                 parameters: Optional[str] = None, **options: Any) -> None:
        if kind not in KINDS:
            raise InputError(f"kind: must be one of {', '.join(KINDS)}, not {kind!r}")
        index = KINDS.index(kind)
        self._buffer = (ctypes.c_double * WIDTHS[index])()
        self._handle = _new_estimator(index, has_drive, step_s, parameters, options)

    def _take(self) -> Optional[Estimate]:
        taken = CEstimate()
        made = self._handle.pointer
        if not check(library.condyle_estimator_take(made, taken, ctypes.sizeof(taken))):
            return None
        return _estimate(taken)

    def push(self, time_s: float, position_m: Any, drive_N: float = float("nan")
             ) -> Optional[Estimate]:
        """Gives a sample; returns the estimate that is ready, or None while a lag fills."""
        values: Sequence[float] = (
            [float(position_m)] if not hasattr(position_m, "__len__")
            else [float(value) for value in position_m]
        )
        if len(values) != len(self._buffer):
            raise InputError(
                f"position_m: has {len(values)} coordinates, not {len(self._buffer)}"
            )
        self._buffer[:] = values
        check(library.condyle_estimator_push(self._handle.pointer, time_s, self._buffer,
                                             len(self._buffer), drive_N))
        return self._take()

    def finish(self) -> List[Estimate]:
        """After the last sample: the estimates that waited for later ones."""
        check(library.condyle_estimator_finish(self._handle.pointer))
        waiting = []
        while (estimate := self._take()) is not None:
            waiting.append(estimate)
        return waiting
