"""The page of every key of a scene file, with a scene for each table, written from the schema that reads scenes and from the starters.

`.venv/bin/python tests/benchmarks/scene_keys.py` rewrites the marked part of the page. A test fails when the page is out of date.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from la_core import exchange
from la_core.scene import starter_names, starter_text
from la_core.scene.schema.key_words import default_words, value_words
from la_core.scene.schema.scene_file import SceneFile

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "la_core" / "scenes" / "keys.md"
YADE_SETTINGS = ROOT / "yade_scripts" / "settings.py"

HEADINGS = {  # by table of the schema: its spelling in a scene file, in the order of the page
    "SceneFile": "Top of the file", "Stone": "`[stone]`", "Joint": "`[joint]`", "Block": "`[[block]]`",
    "Box": "`box` of a block, `region` of a load",
    "Prism": "`prism` of a block", "Polyhedron": "`polyhedron` of a block", "Settlement": "`[settlement]`", "Live": "`[live]`",
    "Zone": "`zone` of a settlement", "Tilt": "`[tilt]`",
    "RequestedPath": "`[path]`", "RequestedEffects": "`[effects]`", "Expected": "`[expected]`",
    "Wall": "`[[wall]]`", "Opening": "`opening` of a wall",
    "Footing": "`footing` of a wall or of rubble",
    "Building": "`[[building]]`", "BuildingOpening": "`opening` of a building", "Floor": "`floor` of a building",
    "Foundation": "`foundation` of a building", "Region": "`settling` of a foundation", "Arch": "`[[arch]]`", "Vault": "`[[vault]]`",
    "Springers": "`springers` of an arch or a vault", "Dome": "`[[dome]]`", "Rubble": "`[[rubble]]`",
    "Mesh": "`[[mesh]]`", "Turn": "`turn` of a mesh", "Drawing": "`[[drawing]]`", "Geometry": "`[geometry]`",
    "JointFriction": "`[[friction]]`", "Load": "`[[load]]`", "Tie": "`[[tie]]`",
}  # fmt: skip
EXAMPLES = {  # by table: the starter or shipped scene that shows it
    "SceneFile": "curve", "Block": "blocks", "Zone": "zones", "Live": "push", "Tilt": "tilt", "Wall": "gable", "Opening": "facade",
    "Footing": "buttress",
    "Building": "building", "Arch": "pointed_arch", "Vault": "vault", "Dome": "dome", "Rubble": "rubble", "Mesh": "rubble_wall",
    "Load": "floors",
}  # fmt: skip
SHOWN_BY = {  # by table: the table whose example shows it, too
    **dict.fromkeys(("Stone", "Joint", "Settlement", "RequestedPath", "RequestedEffects", "Expected"), "SceneFile"),
    **dict.fromkeys(("Box", "Prism", "Polyhedron"), "Block"),
    **dict.fromkeys(("BuildingOpening", "Floor", "Foundation", "Region"), "Building"),
    "Springers": "Arch", "Turn": "Mesh", "JointFriction": "Load", "Tie": "Load",
}  # fmt: skip
EXPLAINED = {  # by table whose example needs another file: the page on the table
    "Drawing": "../drawing/README.md", "Geometry": "../drawing/README.md#the-tolerance",
}  # fmt: skip


def page_part() -> str:
    """Every table of the scene file with its example, one under the other, as Markdown."""
    schema = SceneFile.model_json_schema()
    tables = {"SceneFile": schema, **schema["$defs"]}
    assert set(tables) == set(HEADINGS), "a table of the schema has no heading here"
    assert sorted(tables) == sorted([*EXAMPLES, *SHOWN_BY, *EXPLAINED]), "every table has one example"
    parts = [part for name, heading in HEADINGS.items() for part in (f"## {heading}", *described(tables[name]), example(name))]
    return "\n\n".join([*parts, "## `[yade]`", *yade_part(), example("Stone")])


def example(table: str) -> str:
    """Return the scene that shows a table, or a link to the scene or to the page on the table."""
    if table in SHOWN_BY:
        heading = HEADINGS[SHOWN_BY[table]]
        return f"Example: that of [{heading}](#{re.sub(r'[^a-z -]', '', heading.lower()).replace(' ', '-')})."
    if table in EXPLAINED:
        return f"Example: [drawings]({EXPLAINED[table]})."
    name = EXAMPLES[table]
    if name not in starter_names():
        return f"Example: [`{name}.toml`]({name}.toml), which `crosscheck run {name}` runs."
    return f"Example, which `crosscheck new {name}` writes:\n\n```toml\n{starter_text(name)}```"


def described(table: dict[str, Any], headings: dict[str, str] = HEADINGS) -> Iterator[str]:
    """Yield a table's description, where it has one, and its keys."""
    if "description" in table:
        yield " ".join(table["description"].split())
    rows = ["| key | value | default | meaning |", "|---|---|---|---|"]
    for key, entry in table["properties"].items():
        value = ", ".join(part for part in (value_words(entry, table_of(headings)), entry.get("unit", "")) if part)
        default = "needed" if key in table.get("required", ()) else default_words(entry)
        rows.append(f"| `{key}` | {value} | {default} | {entry['description']} |")
    yield "\n".join(rows)


def table_of(headings: dict[str, str]) -> Callable[[str], str]:
    """Return a function that names a table of the schema by the first words of its heading."""
    return lambda name: headings[name].split(" of ")[0]


def yade_part() -> Iterator[str]:
    """Yield the settings of a run in YADE: name, unit, default and meaning. The comments in `yade_scripts/settings.py` must be the same."""
    source = YADE_SETTINGS.read_text(encoding="utf-8")
    comments = dict(re.findall(r"^    (\w+): (?:float|int)  # (.+)$", source, re.MULTILINE))
    assert tuple(comments) == tuple(exchange.SETTINGS), "settings and their comments differ"
    rows = ["| key | unit | default | meaning |", "|---|---|---|---|"]
    for name, comment in comments.items():
        unit = exchange.SETTING_UNITS.get(name, "")
        assert comment.startswith(f"{unit}, " if unit else ""), f"{name}: its comment begins with another unit than {unit}"
        meaning = exchange.SETTING_MEANINGS[name]
        assert comment.removeprefix(unit).removeprefix(",").strip() == meaning, f"{name}: its comment has another meaning than the schema"
        rows.append(f"| `{name}` | {unit} | {exchange.setting_default(name)} | {meaning} |")
    source_of_defaults = "../../yade_scripts/README.md#settings-and-where-they-come-from"
    yield f"Settings of YADE in place of derived ones; [how they are derived]({source_of_defaults})."
    yield "\n".join(rows)


def with_part(page: str, name: str, part: str) -> str:
    """Return the page with the text between its two comments of this name replaced."""
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    before, found, rest = page.partition(begin)
    _, closed, after = rest.partition(end)
    assert found and closed, f"the page lacks {begin} or {end}"
    return f"{before}{begin}\n\n{part}\n\n{end}{after}"


MARK = "keys, written by tests/benchmarks/scene_keys.py"

if __name__ == "__main__":
    PAGE.write_text(with_part(PAGE.read_text(encoding="utf-8"), MARK, page_part()), encoding="utf-8")
    print(f"written: {PAGE}")
