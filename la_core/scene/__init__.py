"""Scene files: their schema and error messages, generators of blocks, variants, and the shipped scenes."""

from la_core.scene import key_paths, shipped
from la_core.scene.changes import change_rows, geometry_changes
from la_core.scene.from_file import SOURCE_FORMATS, scene_from_file
from la_core.scene.given_keys import GivenKey, given_keys
from la_core.scene.loads.dead_loads import GROUND
from la_core.scene.loads.friction import friction_of_joints, joints_per_class, refuse_idle_classes
from la_core.scene.loads.summary import classes_as_dicts, loads_as_dicts, motions_as_dicts, ties_as_dicts
from la_core.scene.loads.tilt import tilt_angles
from la_core.scene.reading import tables_of
from la_core.scene.scene import Scene, load_scene, scene_of_text
from la_core.scene.schema.json_schema import part_of_schema, scene_schema, tables_of_schema
from la_core.scene.schema.key_words import default_words, value_words
from la_core.scene.schema.mesh import FOLDER_FORMATS
from la_core.scene.schema.scene_file import LEAST_ACCURACY, MOST_ACCURACY, Expected, RequestedPath
from la_core.scene.schema.types import LARGEST_FILE, Name, Positive, Table, Text, described
from la_core.scene.shipped import load, names, starter_names, starter_purpose, starter_text
from la_core.scene.validation import as_scene_error
from la_core.scene.variants import build, full_model, override, same_structure, variant

__all__ = [
    "FOLDER_FORMATS",
    "GROUND",
    "LARGEST_FILE",
    "LEAST_ACCURACY",
    "MOST_ACCURACY",
    "SOURCE_FORMATS",
    "Expected",
    "GivenKey",
    "Name",
    "Positive",
    "RequestedPath",
    "Scene",
    "Table",
    "Text",
    "as_scene_error",
    "build",
    "change_rows",
    "classes_as_dicts",
    "default_words",
    "described",
    "friction_of_joints",
    "full_model",
    "geometry_changes",
    "given_keys",
    "joints_per_class",
    "key_paths",
    "load",
    "load_scene",
    "loads_as_dicts",
    "motions_as_dicts",
    "names",
    "override",
    "part_of_schema",
    "refuse_idle_classes",
    "same_structure",
    "scene_from_file",
    "scene_of_text",
    "scene_schema",
    "shipped",
    "starter_names",
    "starter_purpose",
    "starter_text",
    "tables_of",
    "tables_of_schema",
    "ties_as_dicts",
    "tilt_angles",
    "value_words",
    "variant",
]
