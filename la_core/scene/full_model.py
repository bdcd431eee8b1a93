"""The same scene with nothing left out: what a reduced model is held against."""

import re
import tomllib

from la_core.errors import SceneError
from la_core.scene.scene import Scene, scene_of_text

EVERY_EFFECT = {
    "plane": "false",
    "friction": '"coulomb"',
    "reach": "false",
    "displacement": '"finite"',
    "recording": '"states"',
}
SUFFIX = "_full"
_EFFECTS_TABLE = re.compile(r"^[ \t]*\[[ \t]*effects[ \t]*\].*?(?=^[ \t]*\[|\Z)", re.MULTILINE | re.DOTALL)


def full_model(scene: Scene) -> Scene:
    """The scene with every effect on, under its name with SUFFIX; another law of friction that it asks for stays.

    Raises SceneError where its effects are not written as a table of their own, so that they cannot be replaced.
    """
    if "effects" in tomllib.loads(scene.text) and not _EFFECTS_TABLE.search(scene.text):
        raise SceneError(
            f"{scene.path}: effects", "cannot be replaced by those of the full model", hint="write [effects] as a table of its own"
        )
    law = scene.effects.friction
    effects = EVERY_EFFECT | ({"friction": f'"{law}"'} if law in ("associated", "none-slides") else {})
    table = "\n".join(["[effects]", *(f"{name} = {value}" for name, value in effects.items())])
    text = f"{_EFFECTS_TABLE.sub('', scene.text).rstrip()}\n\n{table}\n"
    return scene_of_text(text, scene.path, f"{scene.name}{SUFFIX}")
