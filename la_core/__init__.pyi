from la_core.analysis import Answer as Answer
from la_core.analysis import solve as solve
from la_core.errors import SceneError as SceneError
from la_core.limit import Status as Status
from la_core.scene import Scene as Scene
from la_core.scene import build as build
from la_core.scene import load as load
from la_core.scene import names as names
from la_core.scene import variant as variant

__all__ = ["Answer", "Scene", "SceneError", "Status", "build", "load", "names", "solve", "variant"]
