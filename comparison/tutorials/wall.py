# %% [markdown]
# # 4. The settling wall
#
# A wall in running bond stands on a base in two parts. The right part settles. A stepped wedge of blocks goes down with it. The wall
# above spans over the wedge, as masons know. The settling part carries the weight of the wedge, less the friction that holds the wedge
# back at its flanks. The size of this friction depends on all earlier motions.

# %%
import comparison
import la_core

block, friction = (0.4, 0.3, 0.2), 0.6
tables = {
    "title": "Wall of 4 courses in running bond, its right end settles",
    "stone": {"density": 2000.0},
    "joint": {"friction": friction},
    "wall": [{"bond": "running", "origin": [0.0, 0.0, 0.0], "block": block, "per_course": 4, "courses": 4}],
    "block": [
        {"name": "fixed base", "role": "fixed", "box": {"from": [0.0, 0.0, -0.2], "to": [1.2, 0.3, 0.0]}},
        {"name": "settling base", "role": "support", "box": {"from": [1.2, 0.0, -0.2], "to": [1.6, 0.3, 0.0]}},
    ],
    "settlement": {"direction": [0.0, 0.0, -1.0]},
    "path": {"increments": 12},
}
scene = la_core.build(tables, "small_wall")
comparison.draw(scene).save("wall-structure.png")

# %% [markdown]
# ## By hand
#
# Every course is shifted by half a block, so the wedge loses half a block a course: it has one block in the lowest course, half a block in
# the next, and nothing above. The wall weighs as much as 16 blocks, the wedge as much as 1.5.
#
# - If its flanks carry nothing, R = 1.5 / 16 W. Friction can only hold back a wedge that goes down, so this is the greatest reaction.
# - If they slide by the associated rule, R = 1.5 / 16 W / (1 + mu²), as for the two blocks side by side. This bound is the least reaction.

# %%
wedge = 1.5 / 16.0 * scene.weight
answer = la_core.solve(scene)
low, high = answer.interval
print(f"least (associated): {answer.least:.1f} N, by hand {wedge / (1.0 + friction**2):.1f} N")
print(f"interval of the mechanism: {low:.1f} to {high:.1f} N, wedge alone {wedge:.1f} N")
print(f"prediction: {answer.coulomb:.1f} ± {answer.uncertainty:.1f} N")
assert abs(answer.least / wedge * (1.0 + friction**2) - 1.0) < 1e-5
assert abs(high / wedge - 1.0) < 1e-3

# %% [markdown]
# Between the two values the mechanism is the same, and statics does not decide: the forces at the flanks may lie anywhere within
# Coulomb's cone. The prediction is the state that elastic joints reach when the base settles steadily from rest. Its uncertainty comes
# from paths of different viscosity and from the remaining change of their curves.
#
# ## The second opinion
#
# YADE follows one history, too: the wall comes to rest under gravity, then the base goes down slowly.

# %%
result = comparison.run(scene, "results", quiet=True)
print(result)
assert result.yade is not None
assert result.verdict == "agree"
assert answer.least < result.yade.reaction < wedge
result.plot("mechanisms").save("wall-mechanisms.png")

# %%
result.plot("reaction").save("wall-reaction.png")

# %% [markdown]
# The figure shows the whole settlement: at rest the base carries its share of the wall, then the reaction falls and stays constant. Limit
# analysis followed the same settlement without inertia. Its curve is dashed.
#
# ## Another history
#
# Lift the same base by a twentieth of a millimetre before the wall comes to rest, then let it settle. The stones, the joints and the
# mechanism are the same. The friction at the flanks is different.

# %%
lifted = comparison.run(la_core.variant(scene, {"yade.wedging": 5e-5, "path": None}, "lifted_wall"), "results", quiet=True)
print(lifted)
assert lifted.yade is not None
assert lifted.verdict == "inconclusive"
assert result.yade.reaction < lifted.yade.reaction < wedge * 1.001
more = lifted.yade.reaction / result.yade.reaction - 1.0
print(f"YADE's base carries {100.0 * more:.0f} % more than without the lift")

# %% [markdown]
# The program does not call this a disagreement: after the lift the two methods came to rest in different states, so they follow different
# histories of friction. It does not call it agreement either. Both numbers lie within the interval, because the mechanism is
# the same. Another history may even lead to another mechanism, so an engineer who does not know the history should work with the bounds.
#
# ## Question
#
# The joints are wet, mu = 0.3. Between which values does history decide now?
#
# **Answer.** The wedge still weighs as much as 1.5 blocks: the upper end stays at 1.5 / 16 = 0.0938 W. The lower end is
# 0.0938 / (1 + 0.3²) = 0.0860 W. With less friction, the history has less influence.

# %%
wet = la_core.solve(la_core.variant(scene, {"joint.friction": 0.3, "path": None}))
low, high = (end / scene.weight for end in wet.interval)
print(f"{low:.4f} to {high:.4f} W")
assert abs(low - 1.5 / 16.0 / 1.09) < 1e-4
assert abs(high - 1.5 / 16.0) < 1e-4
