# %% [markdown]
# # 1. Statics of two pads
#
# A block lies on two pads. The right pad settles. How much does it still carry?
#
# Before anything moves, the answer is unknown: a rigid block on more than two points is statically indeterminate. As soon as the pad gives
# way, the block turns, and all but two contact points open. Statics alone then gives the reaction. Limit analysis finds such answers.

# %%
import comparison
import la_core

scene = la_core.load("two_pads")
comparison.draw(scene).save("pads-structure.png")

# %% [markdown]
# ## By hand
#
# The block is 1 m long; its weight W acts at x = 0.5 m. The fixed pad ends at 0.4 m. The settling pad ends at 1.0 m.
# When the right pad goes down, the block turns about the end of the fixed pad and follows with its far end. Moments about x = 0.4 m:
#
#     W (0.5 - 0.4) = R (1.0 - 0.4), so R = W / 6.
#
# Push the pad up instead, and the block turns about its left end, x = 0, on the near edge of the pad, x = 0.5 m, under the centroid.
# Then R = W. Every reaction between W / 6 and W is in equilibrium. Only a motion selects one of them.

# %%
least, greatest = (0.5 - 0.4) / (1.0 - 0.4), (0.5 - 0.0) / (0.5 - 0.0)
answer = la_core.solve(scene)
print(answer)
assert abs(answer.least_sharp / scene.weight - least) < 1e-6
assert abs(answer.greatest_sharp / scene.weight - greatest) < 1e-6

# %% [markdown]
# *Sharp* means a block with perfect edges. Real edges are rounded, and a computer needs a little room, so both methods draw the contact
# points in by an *inset* of 1 mm. The lever arms change by up to 1 mm. The hand calculation can take this into account:

# %%
inset = scene.inset
rounded = (0.5 - (0.4 - inset)) / ((1.0 - inset) - (0.4 - inset))
print(f"R/W by hand with the inset: {rounded:.6f}, by limit analysis: {answer.least / scene.weight:.6f}")
assert abs(answer.least / scene.weight - rounded) < 1e-6

# %% [markdown]
# ## The second opinion
#
# YADE knows nothing of moments about a point. It lays the block on both pads, lets it come to rest, drives the right pad down and
# records the force. The reaction falls from its value at rest to a plateau. The plateau is the answer.

# %%
result = comparison.run(scene, "results", quiet=True)
print(result)
assert result.verdict == "agree"
result.plot("reaction").save("pads-reaction.png")

# %%
result.plot("mechanisms").save("pads-mechanisms.png")

# %% [markdown]
# In both mechanisms the block turns about the end of the fixed pad. Open circles mark the points that open. No point slides, so friction
# plays no part, and another friction coefficient must give the same reaction:

# %%
slippery = la_core.solve(la_core.variant(scene, {"joint.friction": 0.2}))
assert abs(slippery.least_sharp - answer.least_sharp) < 1e-6 * scene.weight

# %% [markdown]
# ## Question
#
# The fixed pad is cut back to 0.2 m. What does the settling pad carry now?
#
# **Answer.** Moments about x = 0.2 m: R = W (0.5 - 0.2) / (1.0 - 0.2) = 0.375 W. With less support on the left, the right pad carries more,
# although it settles.

# %%
shorter = la_core.variant(scene, {"block[0].box.to": [0.2, 0.2, 0.0]})
found = la_core.solve(shorter).least_sharp / shorter.weight
print(f"R/W = {found:.4f}")
assert abs(found - 0.375) < 1e-6
