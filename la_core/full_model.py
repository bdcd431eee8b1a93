"""The same scene with nothing left out: what a reduced model is held against."""

import re

from la_core.scene import Scene, scene_of_text

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
    """The scene with every effect on, under its name with SUFFIX; friction that it asks to be associated stays so.

    Raises SceneError where its effects are not written as a table of their own, so that they cannot be replaced.
    """
    effects = EVERY_EFFECT | ({"friction": '"associated"'} if scene.effects.friction == "associated" else {})
    table = "\n".join(["[effects]", *(f"{name} = {value}" for name, value in effects.items())])
    text = f"{_EFFECTS_TABLE.sub('', scene.text).rstrip()}\n\n{table}\n"
    return scene_of_text(text, scene.path, f"{scene.name}{SUFFIX}")
