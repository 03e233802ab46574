"""Model files."""

from __future__ import annotations

import os
from importlib import resources
from pathlib import Path
from typing import Literal, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core, identification
from .identification import Direction, Identification, Measured
from .prediction import Prediction


class Parameter(NamedTuple):
    """A parameter of a model with its sampled range."""

    name: str
    min: float
    max: float


class Model:
    """An opened model file. Use `load`."""

    def __init__(self, core: _core.Model) -> None:
        self._core = core
        self._identifiers: dict[str, _core.Identifier] = {}

    def __repr__(self) -> str:
        ranges = ", ".join(f"{name} {low:g} to {high:g}" for name, low, high in self.parameters)
        return f"<capsule_rom.Model {self.title!r}: {ranges}, digest {self.digest}>"

    @property
    def title(self) -> str:
        """Title for people."""
        return self._core.title

    @property
    def parameters(self) -> list[Parameter]:
        """Names and sampled ranges, in the order of `predict`."""
        return [Parameter(*parameter) for parameter in self._core.parameters]

    @property
    def units(self) -> tuple[str, str, str]:
        """Names of the units of length, velocity and time."""
        return self._core.units

    @property
    def end_time(self) -> float:
        """The last instant that can be asked for; the first is 0."""
        return self._core.end_time

    @property
    def method(self) -> str:
        """The method of a query that names none: "direct" or "paper"."""
        return self._core.method

    @property
    def membrane_law(self) -> str:
        """Constitutive law of the full-order model."""
        return self._core.membrane_law

    @property
    def bending_stiffness(self) -> Optional[float]:
        """Bending stiffness B of the full-order model, in G_s a^2; None where it is not known."""
        return self._core.bending_stiffness

    @property
    def errors_against(self) -> str:
        """The solution that errors are measured against, in words."""
        return self._core.errors_against

    @property
    def digest(self) -> str:
        """CRC-32 of the model in hexadecimal: identifies it."""
        return self._core.digest

    @property
    def node_count(self) -> int:
        """Number of nodes of the surface mesh."""
        return self._core.node_count

    @property
    def elements(self) -> NDArray[np.uint16]:
        """Elements `(elements, 3)` or `(elements, 6)`: the nodes of each triangle, counter-clockwise seen from outside;
        with 6 the mid-edges of (0, 1), (1, 2), (2, 0) last."""
        return self._core.elements()

    @property
    def samples(self) -> NDArray[np.float64]:
        """Sampled parameters `(samples, parameters)`."""
        return self._core.samples()

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the model file (.crom), whole or not at all. Raises OSError if it cannot be written."""
        self._core.save(path)

    def node_set(self, name: str) -> NDArray[np.uint16]:
        """Node numbers of a named outline ("midplane", "diagonal"), front to rear.

        Raises KeyError if the model has no such set.
        """
        nodes = self._core.node_set(name)
        if nodes is None:
            raise KeyError(name)
        return nodes

    def steady_limit(self, confinement: ArrayLike) -> Optional[NDArray[np.float64]]:
        """The largest Ca with a steady state at each confinement; None where the model has no steady limit."""
        values = np.asarray(confinement, dtype=np.float64)
        limits = self._core.steady_limit(values.ravel().tolist())
        return None if limits is None else limits.reshape(values.shape)

    def predict(
        self,
        *parameters: ArrayLike,
        method: Optional[Literal["direct", "paper"]] = None,
        extrapolate: bool = False,
        invalid: Literal["raise", "nan"] = "raise",
    ) -> Prediction:
        """Queries the model: `model.predict(ca, confinement)` for a capsule in the channel.

        The parameters are numbers or arrays of a common shape `B` after broadcasting; every answer has the shape
        `B + T + (...)`, with `T` the shape of its instants. Nothing is computed before an answer is asked for.

        With `extrapolate` queries outside the sampled domain are answered too, without a bound. With `invalid="nan"` a
        refused query gives NaN instead of a `QueryError`, for maps that reach beyond the domain.
        """
        if invalid not in ("raise", "nan"):
            raise ValueError(f'invalid is {invalid!r}: "raise" or "nan"')
        arrays = np.broadcast_arrays(*(np.asarray(values, dtype=np.float64) for values in parameters))
        shape = arrays[0].shape if arrays else ()
        size = int(np.prod(shape))
        flat = [values.ravel() for values in arrays]
        rows = np.ascontiguousarray(np.stack(flat, axis=1) if flat else np.empty((1, 0)))
        batch = _core.Batch(self._core, rows.reshape(size, len(arrays)), method, extrapolate, invalid == "nan")
        return Prediction(self._core, batch, shape)

    def identify(
        self,
        contour: Union[ArrayLike, str, os.PathLike[str], None] = None,
        *,
        observable: Literal["midplane", "silhouette"],
        dent_line: Union[ArrayLike, str, os.PathLike[str], None] = None,
        half_width_um: float,
        viscosity_pa_s: float,
        velocity_mm_s: Optional[float] = None,
        flow_rate_ul_min: Optional[float] = None,
        capsule_velocity_mm_s: Optional[float] = None,
        unit: Optional[Literal["um", "px"]] = None,
        pixel_um: Optional[float] = None,
        flow: Direction = "found",
        capsule: Optional[int] = None,
        noise_um: Optional[float] = None,
        edge_px: Optional[float] = None,
        scale_error: Optional[float] = None,
        axial_length_um: Optional[Measured] = None,
        width_um: Optional[Measured] = None,
        rear_depth_um: Optional[Measured] = None,
        radius_um: Optional[Measured] = None,
        velocity_ratio: Optional[Measured] = None,
    ) -> Identification:
        """Radius, Ca and surface shear modulus of a steady capsule, with intervals, as `capsule-rom identify`.

        `contour` is an array `(points, 2)` of points in order around the capsule, in um, or in pixels of the size
        `pixel_um`; or the path of a text or a picture. `dent_line` holds points along the line at which the dent behind
        is seen through a silhouette, in the same coordinates; or is the path of a text. Without a contour at least two
        lengths are needed, each a value and its standard deviation. `half_width_um` is half the channel's side; one of
        the three velocities is needed; `velocity_ratio` is the capsule's over the liquid's. `edge_px` and `scale_error`
        are the standard deviations of the edge (0.25 pixels) and the relative scale (0.005). `capsule` chooses one of
        several in a picture.

        Raises `MeasurementError` if the measurement cannot be one of a capsule in the channel.
        """
        if observable not in self._identifiers:
            self._identifiers[observable] = _core.Identifier(self._core, observable)
        return identification.identify(
            self._identifiers[observable],
            contour,
            dent_line,
            half_width_um=half_width_um,
            viscosity_pa_s=viscosity_pa_s,
            velocity_mm_s=velocity_mm_s,
            flow_rate_ul_min=flow_rate_ul_min,
            capsule_velocity_mm_s=capsule_velocity_mm_s,
            unit=unit,
            pixel_um=pixel_um,
            flow=flow,
            capsule=capsule,
            noise_um=noise_um,
            edge_px=edge_px,
            scale_error=scale_error,
            axial_length_um=axial_length_um,
            width_um=width_um,
            rear_depth_um=rear_depth_um,
            radius_um=radius_um,
            velocity_ratio=velocity_ratio,
        )


def load(path: Union[str, os.PathLike[str], None] = None) -> Model:
    """Opens a model file (.crom); without a path the model that comes with the package.

    Raises OSError if the file cannot be read and `ModelFileError` if it is no valid model.
    """
    file = resources.files(__package__).joinpath("capsule.crom") if path is None else Path(path)
    return Model(_core.Model.open(file.read_bytes()))
