"""Answers of a model to one query or an array of queries."""

from __future__ import annotations

from typing import Literal, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

Singles = NDArray[np.float32]
Frame = Literal["laboratory", "centroid"]


class Observables(NamedTuple):
    """Lengths (in l) and velocity (in V) at an instant; arrays of the shape `B + T`."""

    axial_length: Singles
    """Extent along the channel."""
    half_width: Singles
    """Greatest distance from the axis in the plane z = 0."""
    half_diagonal: Singles
    """Greatest distance from the axis in the plane y = z."""
    rear_depth: Singles
    """Depth of the rear cavity."""
    velocity: Singles
    """Velocity of the volume centroid."""
    centroid: Singles
    """Position of the volume centroid in the laboratory frame."""


class Totals(NamedTuple):
    """Integrals over the membrane; arrays of the shape `B + T`."""

    area: Singles
    """Area, in l^2."""
    energy: Singles
    """Elastic energy, in G_s l^2."""
    pressure_drop: Singles
    """Additional pressure drop that the capsule causes, in mu V / l."""


class Fields(NamedTuple):
    """Mechanics of the membrane at the nodes: scalars `B + T + (nodes,)`, vectors `B + T + (nodes, 3)`."""

    stretch_1: Singles
    stretch_2: Singles
    area_dilation: Singles
    tension_1: Singles
    """Greater principal tension, in G_s."""
    tension_2: Singles
    energy_density: Singles
    """Elastic energy per stress-free area, in G_s."""
    direction_1: Singles
    direction_2: Singles
    load: Singles
    """Jump of the fluid's traction across the membrane, in mu V / l."""


class Prediction:
    """A query, or an array of queries of the shape `B`. Made by `Model.predict`.

    Every method takes instants `t` (a number or an array of the shape `T`, in l/V) and returns float32 arrays. `out`, a
    contiguous float32 array of the answer's shape, is filled and returned instead of a new one.
    """

    def __init__(self, model: _core.Model, batch: _core.Batch, shape: tuple[int, ...]) -> None:
        self._model = model
        self._batch = batch
        self.shape = shape
        """Shape `B` of the queries."""

    @property
    def domain(self) -> NDArray[np.str_]:
        """Where each query lies: "inside", "beyond-steady-limit", "far-from-samples" or "outside"."""
        return np.array(self._batch.domains(), dtype=np.str_).reshape(self.shape)

    def observables(self, t: ArrayLike, out: Optional[Singles] = None) -> Observables:
        """Lengths, velocity and position. `out` has the shape `B + T + (6,)`."""
        times, out = self._prepare(t, (6,), out)
        self._batch.observables(times, out.reshape(-1))
        return Observables(*np.moveaxis(out, -1, 0))

    def volume(self, t: ArrayLike, out: Optional[Singles] = None) -> Singles:
        """Enclosed volume, in l^3."""
        return self._number("volume", t, out)

    def expected_error(self, t: ArrayLike, out: Optional[Singles] = None) -> Singles:
        """Expected distance to the solution that the model was made from (`Model.errors_against`), as a fraction of a.

        Outside the sampled domain it is a guess.
        """
        return self._number("expected_error", t, out)

    def bound(self, t: ArrayLike, out: Optional[Singles] = None) -> Singles:
        """The bound that 95 of 100 errors are below, as a fraction of a; NaN outside the sampled domain."""
        return self._number("error_bound", t, out)

    def totals(self, t: ArrayLike, out: Optional[Singles] = None) -> Totals:
        """Area, energy and pressure drop. `out` has the shape `B + T + (3,)`."""
        times, out = self._prepare(t, (3,), out)
        self._batch.totals(times, out.reshape(-1))
        return Totals(*np.moveaxis(out, -1, 0))

    def positions(
        self,
        t: ArrayLike,
        nodes: Optional[ArrayLike] = None,
        frame: Frame = "laboratory",
        out: Optional[Singles] = None,
    ) -> Singles:
        """Positions `B + T + (nodes, 3)` of the listed nodes or of all, in l."""
        return self._vectors("positions", t, nodes, frame, out)

    def velocities(
        self,
        t: ArrayLike,
        nodes: Optional[ArrayLike] = None,
        frame: Frame = "laboratory",
        out: Optional[Singles] = None,
    ) -> Singles:
        """Velocities `B + T + (nodes, 3)` of the listed nodes or of all, in V."""
        return self._vectors("velocities", t, nodes, frame, out)

    def outline(
        self,
        plane: Literal["midplane", "diagonal"],
        t: ArrayLike,
        frame: Frame = "laboratory",
        out: Optional[Singles] = None,
    ) -> Singles:
        """Points x, r of an outline, front to rear: `B + T + (points, 2)`, in l.

        "midplane" is the section z = 0, y >= 0, "diagonal" the section y = z >= 0; r is the distance from the axis.
        """
        nodes = self._model.node_set(plane)
        if nodes is None:
            raise ValueError(f"the model has no outline {plane!r}")
        times, out = self._prepare(t, (len(nodes), 2), out)
        self._batch.outline(plane, times, frame, out.reshape(-1))
        return out

    def silhouette(
        self,
        t: ArrayLike,
        angle: float = 0.0,
        points: int = 257,
        frame: Frame = "laboratory",
        out: Optional[Singles] = None,
    ) -> Singles:
        """Points x, w of the outline of the projection, front to rear, on the side w >= 0: `B + T + (points, 2)`, in l.

        w = cos(angle) y + sin(angle) z, seen along the axis across to it: with `angle` 0, in radians, along z. The
        other side is the mirror image.
        """
        if points < 3:
            raise ValueError(f"points is {points}: at least 3 are needed")
        times, out = self._prepare(t, (points, 2), out)
        self._batch.silhouette(angle, points, times, frame, out.reshape(-1))
        return out

    def fields(self, t: ArrayLike, out: Optional[Singles] = None) -> Fields:
        """Mechanics of the membrane at all nodes. `out` has the shape `B + T + (15 * nodes,)`; the answer's arrays are
        parts of it.
        """
        count = self._model.node_count
        times, out = self._prepare(t, (15 * count,), out)
        self._batch.fields(times, out.reshape(-1))
        scalars, vectors = out[..., : 6 * count], out[..., 6 * count :]
        return Fields(
            *np.moveaxis(scalars.reshape(scalars.shape[:-1] + (6, count)), -2, 0),
            *np.moveaxis(vectors.reshape(vectors.shape[:-1] + (3, count, 3)), -3, 0),
        )

    def _number(self, kind: str, t: ArrayLike, out: Optional[Singles]) -> Singles:
        times, out = self._prepare(t, (), out)
        self._batch.number(kind, times, out.reshape(-1))
        return out

    def _vectors(
        self, kind: str, t: ArrayLike, nodes: Optional[ArrayLike], frame: Frame, out: Optional[Singles]
    ) -> Singles:
        listed = None
        count = self._model.node_count
        if nodes is not None:
            numbers = np.asarray(nodes)
            if numbers.ndim != 1 or not np.issubdtype(numbers.dtype, np.integer):
                raise ValueError("nodes is a one-dimensional array of integers")
            if numbers.size and not (0 <= numbers.min() and numbers.max() < count):
                raise IndexError(f"nodes are numbered from 0 to {count - 1}")
            listed = numbers.tolist()
            count = len(listed)
        times, out = self._prepare(t, (count, 3), out)
        self._batch.vectors(kind, times, listed, frame, out.reshape(-1))
        return out

    def _prepare(
        self, t: ArrayLike, entry: tuple[int, ...], out: Optional[Singles]
    ) -> tuple[NDArray[np.float64], Singles]:
        """The instants in a row, and the array that the answer is written into."""
        times = np.asarray(t, dtype=np.float64)
        shape = self.shape + times.shape + entry
        if out is None:
            out = np.empty(shape, dtype=np.float32)
        elif out.shape != shape or out.dtype != np.float32 or not out.flags.c_contiguous or not out.flags.writeable:
            raise ValueError(
                f"out must be a writable C-contiguous float32 array of the shape {shape}, "
                f"not {out.dtype} of {out.shape}"
            )
        return np.ascontiguousarray(times.ravel()), out
