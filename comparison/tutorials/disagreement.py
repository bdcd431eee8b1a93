# %% [markdown]
# # 5. Reading disagreement
#
# A cross-check pays off when it finds an error. This tutorial makes three common mistakes, and the cross-check notices each of them.
# After a run of both methods a structure that stands gets one of three verdicts. *Agree*: every check passed. *Disagree*: a check failed,
# so something is wrong. *Inconclusive*: nothing is known to be wrong, but agreement cannot be claimed. The reason of the verdict says
# what to look at.

# %%
import comparison
import la_core

pads, blocks = la_core.load("two_pads"), la_core.load("two_blocks")

# %% [markdown]
# ## A hand calculation that is wrong
#
# A colleague puts the forces of the two pads at their middles, x = 0.2 m and x = 0.75 m, and writes down the expected reaction:
# R = W (0.5 - 0.2) / (0.75 - 0.2).

# %%
middles = (0.5 - 0.2) / (0.75 - 0.2)
expected = {"expected": {"reaction_over_weight": middles, "kind": "computed"}}
first = comparison.run(la_core.variant(pads, expected, "pads_at_their_middles"), "results", yade=False, quiet=True)
print(first)
assert first.verdict == "unexpected"

# %% [markdown]
# The program is not at fault. The colleague's state is in equilibrium. Its reaction lies between the bounds, and the pads may carry the
# block in this way before anything moves. But the state belongs to no mechanism: once the pad settles, the block touches the pads at
# edges, and R = W / 6.

# %%
answer = first.answer
assert answer.least < middles * pads.weight < answer.greatest

# %% [markdown]
# ## A model that leaves out what happens
#
# Heyman assumed that joints do not slide. This is a good assumption for arches. Apply it to the two blocks side by side.

# %%
assumed = {"title": "Two blocks, sliding excluded in limit analysis", "effects.friction": "none-slides", "path": None}
glued = la_core.variant(blocks, assumed, "blocks_that_do_not_slide")
second = comparison.run(glued, "results", quiet=True)
print(second)
assert second.verdict == "inconclusive"
second.plot("mechanisms").save("disagreement-mechanisms.png")

# %% [markdown]
# Without sliding the right block cannot slip down along its neighbour. It hangs on the joint and tips about it: moments about the joint
# give R = W_b / 2. In YADE it slides, and the pad carries all of W_b. Three things reveal the mistake: the reason says that joints
# slide, the mechanisms differ in the figure, and the reactions differ by a factor of two.
#
# Why not *disagree*? A calculation without sliding is a lower bound here, and YADE's reaction lies above it. The two do not contradict
# each other: the bound is just not a prediction.

# %%
block = 0.5 * blocks.weight
assert second.yade is not None
print(f"R/W_b: {second.answer.least_sharp / block:.4f} without sliding, {second.yade.reaction / block:.4f} in YADE")
assert abs(second.answer.least_sharp / block - 0.5) < 1e-5
assert abs(second.yade.reaction / block - 1.0) < 2e-3

# %% [markdown]
# ## A run that is too fast
#
# YADE's answer is that of a slow settlement only if the settlement is slow. Drive the pad at 20 mm/s instead of 0.4 mm/s.

# %%
third = comparison.run(la_core.variant(pads, {"yade.speed": 0.02}, "pads_in_a_hurry"), "results", quiet=True)
print(third)
assert third.verdict == "inconclusive"
third.plot("reaction").save("disagreement-too-fast.png")

# %% [markdown]
# The support moves away before the block can follow. The force on the support is steady, at 0, but the block is in the air: its weight is
# not in balance with the forces on it. A steady value alone is no answer, so the verdict is *inconclusive*. Run the scene again at a lower
# speed before you blame either method: at 0.4 mm/s the two agree, as the first tutorial shows.

# %% [markdown]
# ## Question
#
# Is Heyman's assumption right on the two blocks if friction is high, say mu = 0.9?
#
# **Answer.** No. The joint between the blocks carries no normal force, so it carries no friction either: the pad carries W_b, as with
# mu = 0.3. The assumption needs joints that a thrust presses together. Rough joints are not enough.

# %%
for friction in (0.3, 0.6, 0.9):
    carried = la_core.solve(la_core.variant(blocks, {"joint.friction": friction, "path": None})).coulomb / block
    print(f"mu = {friction:.1f}: R/W_b = {carried:.4f}")
    assert abs(carried - 1.0) < 2e-3
