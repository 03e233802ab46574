"""Models from the snapshots of any solver."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from typing import Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from .model import Model


def build(
    parameters: ArrayLike,
    times: ArrayLike,
    positions: ArrayLike,
    elements: ArrayLike,
    velocities: Optional[ArrayLike] = None,
    *,
    parameter_names: Union[Sequence[str], ArrayLike, None] = None,
    length_unit: Optional[str] = None,
    time_unit: Optional[str] = None,
    split: Optional[tuple[str, float]] = None,
    tolerance: Optional[float] = None,
) -> Model:
    """Builds a model from arrays, as `capsule-rom offline build --from` does from a file with them.

    - `parameters` `(Nc, P)`: a row for each configuration, P from 1 to 4
    - `times` `(Nt,)`: rising from 0, the same for all configurations
    - `positions` `(Nc, Nt, Nx, 3)`: nodes in the laboratory frame, x along the channel
    - `elements` `(Ne, 3)` or `(Ne, 6)`: nodes of each triangle from 0, counter-clockwise seen from outside; with 6 the
      mid-edges of (0, 1), (1, 2), (2, 0) last
    - `velocities` like `positions`; without them the derivatives of splines through the positions
    - `parameter_names` `(P,)`: else `parameter_1`, ...

    Any units do; `length_unit` and `time_unit` are their names. `split` is a parameter and its value, where the
    solution has a kink or a jump. `tolerance` is the error that the modes may leave, in the unit of length; without it
    a five thousandth of the radius. Equal arrays give equal files if the environment sets SOURCE_DATE_EPOCH.

    Raises `DataError` for arrays that are misshapen, of another type or not finite, and for surfaces that are not one
    closed surface that moves, with the array and the index.
    """
    given = {
        "parameters": parameters,
        "times": times,
        "positions": positions,
        "elements": elements,
        "velocities": velocities,
        "parameter_names": parameter_names,
        "length_unit": length_unit,
        "time_unit": time_unit,
    }
    arrays = [(name, np.asarray(values)) for name, values in given.items() if values is not None]
    created = int(os.environ.get("SOURCE_DATE_EPOCH") or time.time())
    return Model(_core.build(arrays, split, tolerance, created))
