"""Motion of a microcapsule in a square microchannel from a reduced-order model.

>>> import capsule_rom
>>> model = capsule_rom.load()
>>> answer = model.predict(0.10, 0.90)          # capillary number, confinement a/l
>>> float(answer.observables(3.0).axial_length) # in l, half the channel's side
1.98...

Lengths are in l (half the channel's side), velocities in V (mean velocity of the undisturbed flow), time in l/V. All
numbers are single precision: the bits of the command line, the browser and a microcontroller.
"""

from . import fom
from ._core import DataError, MeasurementError, ModelFileError, QueryError, SolverError, __version__
from .identification import Estimate, Identification
from .model import Model, Parameter, load
from .own_data import build
from .prediction import Fields, Observables, Prediction, Totals

__all__ = [
    "DataError",
    "Estimate",
    "Fields",
    "Identification",
    "MeasurementError",
    "Model",
    "ModelFileError",
    "Observables",
    "Parameter",
    "Prediction",
    "QueryError",
    "SolverError",
    "Totals",
    "__version__",
    "build",
    "fom",
    "load",
]
