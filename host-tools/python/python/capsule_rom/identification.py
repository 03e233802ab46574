"""Membrane properties from an outline or a few lengths."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, field
from typing import Any, Literal, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

Interval = tuple[Optional[float], Optional[float]]
Measured = tuple[float, float]
Direction = Literal["right", "left", "up", "down", "found"]


@dataclass(frozen=True)
class Estimate:
    """A quantity with its intervals. None is an end at the edge of the sampled domain: nothing is known beyond."""

    value: float
    interval_68: Interval
    interval_95: Interval


@dataclass(frozen=True)
class Identification:
    """What an outline or a few lengths say of a capsule. Made by `Model.identify`."""

    verdict: str
    """"identified", "bounded-on-one-side", "several-solutions", "outside-domain", "undetermined",
    "not-such-a-capsule" or "scale-or-channel-inconsistent"."""
    verdict_text: str
    """The same in a sentence."""
    ca: Estimate
    """Capillary number mu V / G_s."""
    confinement: Estimate
    """a/l."""
    radius_um: Estimate
    """Radius a at rest, in um."""
    gs_n_per_m: Estimate
    """Surface shear modulus G_s, in N/m."""
    warnings: tuple[str, ...]
    fit_um: NDArray[np.float64] = field(repr=False)
    """Outline of the best fit in the contour's coordinates, in um, `(points, 2)`, closed."""
    details: dict[str, Any] = field(repr=False)
    """All of the answer, with the keys of `capsule-rom identify --json`."""

    @property
    def identified(self) -> bool:
        """Whether there is one answer, with closed intervals."""
        return self.verdict == "identified"


def _points(given: Union[ArrayLike, str, os.PathLike[str], None]) -> Any:
    if given is None:
        return None
    if isinstance(given, (str, os.PathLike)):
        with open(given, "rb") as file:
            return os.fspath(given), file.read()
    points = np.asarray(given, dtype=np.float64)
    if points.ndim != 2:
        raise _core.MeasurementError(f"the points have the shape {points.shape}, they must be (points, 2)")
    return points


def identify(
    identifier: _core.Identifier,
    contour: Union[ArrayLike, str, os.PathLike[str], None],
    dent_line: Union[ArrayLike, str, os.PathLike[str], None],
    *,
    half_width_um: float,
    viscosity_pa_s: float,
    velocity_mm_s: Optional[float],
    flow_rate_ul_min: Optional[float],
    capsule_velocity_mm_s: Optional[float],
    unit: Optional[Literal["um", "px"]],
    pixel_um: Optional[float],
    flow: Direction,
    capsule: Optional[int],
    noise_um: Optional[float],
    edge_px: Optional[float],
    scale_error: Optional[float],
    axial_length_um: Optional[Measured],
    width_um: Optional[Measured],
    rear_depth_um: Optional[Measured],
    radius_um: Optional[Measured],
    velocity_ratio: Optional[Measured],
) -> Identification:
    flows = {
        "mean_velocity": velocity_mm_s,
        "rate": flow_rate_ul_min,
        "capsule_velocity": capsule_velocity_mm_s,
    }
    given = [(kind, number) for kind, number in flows.items() if number is not None]
    if len(given) != 1:
        raise TypeError("give one of velocity_mm_s, flow_rate_ul_min and capsule_velocity_mm_s")
    half = None if width_um is None else (0.5 * width_um[0], 0.5 * width_um[1])
    text, fit = identifier.identify(
        _points(contour),
        _points(dent_line),
        half_width_um,
        given[0],
        viscosity_pa_s,
        unit,
        pixel_um,
        flow,
        capsule,
        noise_um,
        edge_px,
        scale_error,
        [axial_length_um, half, rear_depth_um, radius_um, velocity_ratio],
    )
    details = json.loads(text)

    def estimate(name: str) -> Estimate:
        return Estimate(details[name], tuple(details[f"{name}_68"]), tuple(details[f"{name}_95"]))

    return Identification(
        verdict=details["verdict"],
        verdict_text=details["verdict_text"],
        ca=estimate("ca"),
        confinement=estimate("confinement"),
        radius_um=estimate("radius_um"),
        gs_n_per_m=estimate("gs_n_per_m"),
        warnings=tuple(details.get("warnings", ())),
        fit_um=fit,
        details=details,
    )
