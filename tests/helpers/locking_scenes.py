"""Small structures between held walls, which lock by the dilatancy of their joints: a slot, a lifted pad, and random structures."""

import numpy as np
import scenes

from la_core.scene.scene import Scene

KINDS = ("slot", "wedge", "two blocks", "stack", "lifted pad", "channel")
INSET = 1e-3  # m
WALL = 1.0  # m, thickness of the held blocks


def slot(height: float = 0.5, depth: float = 0.2) -> tuple[str, ...]:
    """A block of 1 by 0.5 m on the ground, which touches two held walls. height: of the walls, depth: along y, m.

    Pulled obliquely, along (1, 0, 1), out of walls of its own height, the block presses one wall with N = lambda W / sqrt 2 and slides up
    this wall: lambda W / sqrt 2 = W + mu N.
    """
    ground = _box("ground", (-WALL, -0.2), (1.0 + WALL, 0.0), depth, "fixed")
    walls = _box("left", (-WALL, 0.0), (0.0, height), depth, "fixed"), _box("right", (1.0, 0.0), (1.0 + WALL, height), depth, "fixed")
    return ground, *walls, _box("block", (0.0, 0.0), (1.0, 0.5), depth)


def lifted_pad() -> tuple[str, ...]:
    """A block on a moving pad, which touches two held walls."""
    walls = (_box(f"wall {x:g}", (x, -0.2), (x + WALL, 0.5), 0.2, "fixed") for x in (-WALL, 1.0))
    return *walls, _box("pad", (0.0, -0.2), (1.0, 0.0), 0.2, "support"), _box("block", (0.0, 0.0), (1.0, 0.5), 0.2)


def drawn(random: np.random.Generator) -> tuple[str, Scene]:
    """Draw kind and scene of a random structure: one or two blocks, walls of random height, friction 0.2 to 0.8, a push or a lift."""
    kind = str(random.choice(KINDS))
    width, height = random.uniform(0.5, 1.5), random.uniform(0.3, 0.8)
    depth = random.uniform(0.5, 1.5) if kind == "channel" else 0.2
    left, right = random.uniform(0.05, 1.0, 2) * height
    push = (float(random.choice((-1.0, 1.0)) * random.uniform(0.05, 1.0)), 0.0, random.uniform(-0.2, 1.0))
    parts = [_box("ground", (-WALL, -0.2), (width + WALL, 0.0), depth, "fixed")]
    if kind == "wedge":
        parts += _wedge(width, height, random.uniform(-0.15, 0.15, 2))
    else:
        tall = 2.0 if kind == "stack" else 1.0
        parts.append(_box("left", (-WALL, 0.0), (0.0, tall * left), depth, "fixed"))
        parts.append(_box("right", (width, 0.0), (width + WALL, tall * right), depth, "fixed"))
    if kind == "two blocks":
        split, lean = width * random.uniform(0.3, 0.7), random.uniform(-0.15, 0.15)
        parts.append(_prism("first", ((0.0, 0.0), (split, 0.0), (split + lean, height), (0.0, height))))
        parts.append(_prism("second", ((split, 0.0), (width, 0.0), (width, height), (split + lean, height))))
    elif kind != "wedge":
        parts += [_box(f"block {k}", (0.0, k * height), (width, (k + 1) * height), depth) for k in range(2 if kind == "stack" else 1)]
    friction = random.uniform(0.2, 0.8)
    if kind == "lifted pad":
        parts[0] = _box("ground", (0.0, -0.2), (width, 0.0), depth, "support")
        lift = (random.uniform(-1.0, 1.0), 0.0, random.uniform(0.2, 1.0))
        return kind, scenes.build(*parts, friction=friction, inset=INSET, settlement=lift, model="auto")
    if kind == "channel":
        push = (push[0], random.uniform(0.2, 1.0), push[2])
    return kind, scenes.build(*parts, friction=friction, inset=INSET, live=push, model="auto")


def _wedge(width: float, height: float, leans: np.ndarray) -> list[str]:
    """A block with inclined sides, between walls of the same inclination."""
    left, right = (float(lean) for lean in leans)
    return [
        _prism("left", ((-WALL, 0.0), (0.0, 0.0), (left, height), (-WALL, height)), "fixed"),
        _prism("right", ((width, 0.0), (width + WALL, 0.0), (width + WALL, height), (width + right, height)), "fixed"),
        _prism("block", ((0.0, 0.0), (width, 0.0), (width + right, height), (left, height))),
    ]


def _box(name: str, low: tuple[float, float], high: tuple[float, float], depth: float, role: str = "free") -> str:
    return scenes.box(name, (low[0], 0.0, low[1]), (high[0], depth, high[1]), role)


def _prism(name: str, profile: tuple[tuple[float, float], ...], role: str = "free") -> str:
    return scenes.block(name, role, prism=(profile, (0.0, 0.2)))
