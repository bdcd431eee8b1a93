# %% [markdown]
# # 6. What pushes a wall over
#
# An earthquake shakes a wall sideways. As a first step engineers push the wall instead: they push every block by the same share of its
# weight. The share at which the wall fails is the *multiplier*. This tutorial finds it for a block, a wall, a block with a tie, a tilted
# block and a block under a floor.

# %%
import math

import comparison
import la_core

b, h, inset = 0.5, 0.7, 0.001  # m


def block(friction: float, **more: object) -> la_core.Scene:
    """A block on a plane, pushed along x."""
    ground = {"name": "ground", "role": "fixed", "box": {"from": [-0.5, 0.0, -0.2], "to": [1.0, 0.3, 0.0]}}
    stone = {"name": "block", "box": {"from": [0.0, 0.0, 0.0], "to": [b, 0.3, h]}}
    push = {} if "tilt" in more else {"live": {"direction": [1.0, 0.0, 0.0]}}
    tables = {"title": "Block pushed along x", "stone": {"density": 2000.0}, "joint": {"friction": friction, "inset": inset}}
    return la_core.build(tables | {"block": [ground, stone]} | push | more, "pushed_block")


comparison.draw(block(0.9)).save("push-structure.png")

# %% [markdown]
# ## By hand: a block
#
# The push is the multiplier a times the weight W. The block *slides* when a W = mu W, so at a = mu. It *tips* about its lower corner when
# the moment of the push about this corner, a W h / 2, equals that of the weight, W b / 2, so at a = b / h. The smaller a decides. Here
# the edges are a little rounded, by an inset i, so the lever arm of the weight is b / 2 - i.

# %%
tips = (b / 2.0 - inset) / (h / 2.0)
print("   mu   by hand   limit analysis")
for mu in (0.3, 0.5, 0.7, 0.9):
    found = la_core.solve(block(mu))
    print(f"  {mu:.1f}    {min(mu, tips):.4f}    {found.coulomb:.4f}  ({'slides' if mu < tips else 'tips'})")
    assert abs(found.coulomb - min(mu, tips)) < 1e-3

# %% [markdown]
# ## The second opinion
#
# YADE pulls the block at constant speed and records the necessary force. The multiplier rises, and stays constant while the block tips.

# %%
result = comparison.run(block(0.9), "results", quiet=True)
print(result)
assert result.yade is not None
assert result.verdict == "agree"
assert abs(result.yade.reaction - tips) < 1e-3
result.plot("reaction").save("push-multiplier.png")

# %% [markdown]
# ## A wall is not one block
#
# If the wall below were one stone, it would tip at a multiplier of its breadth over its height. But its joints open and slide: a part of
# the wall stays behind, and the wall fails at a smaller multiplier. Associated friction, which dilates, gives an upper bound.

# %%
masonry = {
    "bond": "running",
    "origin": [0.0, 0.0, 0.0],
    "block": [0.4, 0.3, 0.2],
    "per_course": 3,
    "courses": 6,
    "footing": {"height": 0.2},
}
live, joint = {"direction": [1.0, 0.0, 0.0]}, {"friction": 0.6, "inset": inset}
wall = la_core.build(
    {"title": "Wall pushed along x", "stone": {"density": 2000.0}, "joint": joint, "wall": [masonry], "live": live}, "wall"
)
monolith = (3 * 0.4) / (6 * 0.2)
pushed = comparison.run(wall, "results", quiet=True)
print(pushed)
answer = la_core.solve(wall)
print(f"one stone {monolith:.3f} or, if it slides, 0.6; associated bound {answer.multiplier:.4f}; without dilatancy {answer.coulomb:.4f}")
assert pushed.verdict == "agree"
assert answer.coulomb < answer.multiplier + 1e-6 < min(monolith, 0.6)
pushed.plot("mechanisms").save("push-mechanisms.png")

# %% [markdown]
# ## A tie
#
# A rod under the tension T holds the top of the block against the push. The moment of T about the corner is T h, so that
#
#     a W h / 2 = W b / 2 + T h,   a = b / h + 2 T / W.

# %%
weight = 2000.0 * 9.81 * b * 0.3 * h
rod = {"name": "rod", "blocks": ["block"], "from": [0.0, 0.15, h], "to": [-0.5, 0.15, h], "force": 0.05 * weight}
held = la_core.solve(block(0.9, tie=[rod]))
print(f"with a tie of 0.05 W: by hand {tips + 0.1:.4f}, by limit analysis {held.coulomb:.4f}")
assert abs(held.coulomb - (tips + 0.1)) < 1e-3

# %% [markdown]
# ## A tilting table
#
# In a laboratory the table on which the model stands is tilted. At the angle t the weight has a component W sin t along the table and a
# component W cos t across it. Their ratio, tan t, is the multiplier. A hinge and a jack are thus enough to measure it.

# %%
tilted = la_core.solve(block(0.9, tilt={"axis": [0.0, 1.0, 0.0]}))
angle = tilted.values["coulomb"]["angle"]
print(f"the block tips at {angle:.3f} degrees; by hand {math.degrees(math.atan(tips)):.3f}")
assert abs(angle - math.degrees(math.atan(tips))) < 0.05

# %% [markdown]
# ## Question
#
# A floor as heavy as the block lies on the middle of its top. It presses the block down. Does the block bear more push, or less?
#
# **Answer.** Less. The floor doubles the moment of the weight that holds the block, to 2 W b / 2. But the floor is pushed, too, and its
# lever arm is h instead of h / 2: a (W h / 2 + W h) = 2 W b / 2, so a = 2/3 b / h. Mass high up makes a wall fall at a smaller push. A tie
# from the floor to the wall behind would hold it.

# %%
floor = {"name": "floor", "blocks": ["block"], "mass": weight / 9.81, "at": [b / 2.0, 0.15, h]}
loaded = la_core.solve(block(0.9, load=[floor]))
print(f"with a floor: {loaded.coulomb / tips:.4f} of the multiplier without it")
assert abs(loaded.coulomb / tips - 2.0 / 3.0) < 1e-3
