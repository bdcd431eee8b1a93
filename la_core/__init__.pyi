from la_core.answer import Answer as Answer
from la_core.answer import solve as solve
from la_core.compose import build as build
from la_core.compose import variant as variant
from la_core.errors import SceneError as SceneError
from la_core.limit import Status as Status
from la_core.scene import Scene as Scene
from la_core.shipped import load as load
from la_core.shipped import names as names

__all__ = ["Answer", "Scene", "SceneError", "Status", "build", "load", "names", "solve", "variant"]
