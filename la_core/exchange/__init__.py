"""The HDF5 contract with YADE: what `case.h5` and `run.h5` hold, how they are written, read and checked."""

from la_core.exchange.checksummed_file import ExchangeError, write_whole
from la_core.exchange.dem_settings import LATER_SETTINGS, PLATEAU_SHARE, POSES, RADIUS_OVER_INSET, SETTINGS, TRAVEL_PERIODS
from la_core.exchange.fields import (
    CASE_FIELDS,
    FIRST_PREDICTION,
    FIXED,
    FREE,
    JOINT_INSET,
    LIVE_DIRECTION,
    PART_FIELDS,
    PATH_FIELDS,
    RUN_FIELDS,
    SUPPORT,
    UNCERTAINTY_PARTS,
    Field,
    coulomb_fields,
    schema_table,
    solution_fields,
)
from la_core.exchange.hdf5 import holds, inputs_digest, read, values_of, write

__all__ = [
    "CASE_FIELDS",
    "FIRST_PREDICTION",
    "FIXED",
    "FREE",
    "JOINT_INSET",
    "LATER_SETTINGS",
    "LIVE_DIRECTION",
    "PART_FIELDS",
    "PATH_FIELDS",
    "PLATEAU_SHARE",
    "POSES",
    "RADIUS_OVER_INSET",
    "RUN_FIELDS",
    "SETTINGS",
    "SUPPORT",
    "TRAVEL_PERIODS",
    "UNCERTAINTY_PARTS",
    "ExchangeError",
    "Field",
    "coulomb_fields",
    "holds",
    "inputs_digest",
    "read",
    "schema_table",
    "solution_fields",
    "values_of",
    "write",
    "write_whole",
]
