# %% [markdown]
# # 2. Why associated friction is wrong
#
# Limit analysis is strongest with an *associated* flow rule: then bounds exist and one optimisation finds them. For friction this
# rule says that a joint which slides also opens, by mu times the slip. Stone does not do that. Two blocks show the error.

# %%
import comparison
import la_core

scene = la_core.load("two_blocks")
comparison.draw(scene).save("friction-structure.png")

# %% [markdown]
# ## By hand, as stone does it
#
# Two equal blocks stand side by side, each on a pad of its own. The right pad settles. Nothing presses the blocks together, so the joint
# between them carries no normal force and no friction. The right pad carries its block: R = W_b.
#
# ## By hand, by the associated rule
#
# The pad moves down by 1, the block by v. The block slides down along its neighbour by v, so it must move off sideways by mu v. Then it
# slides on its pad by mu v, so it must rise from the pad by mu² v. Hence 1 = v + mu² v. The work of the weight, W_b v, equals the work of
# the reaction, R times 1:
#
#     R = W_b / (1 + mu²)
#
# For mu = 0.6 that is 0.735 W_b. The rule hangs a quarter of the block on its neighbour, by friction that does not exist.

# %%
friction = scene.friction
block = 0.5 * scene.weight
associated, coulomb = block / (1.0 + friction**2), block
answer = la_core.solve(scene)
print(f"associated:       by hand {associated:.2f} N, by limit analysis {answer.least:.2f} N")
print(f"without dilation: by hand {coulomb:.2f} N, by limit analysis {answer.coulomb:.2f} N")
assert abs(answer.least - associated) < 1e-6 * scene.weight
assert abs(answer.coulomb - coulomb) < 1e-3 * scene.weight  # joints are a little elastic in the prediction

# %% [markdown]
# The mechanism of the associated rule shows the error: the right block moves sideways, and rises from its pad while it slides on the pad.

# %%
rule = {"title": "The same, friction that dilates", "effects.friction": "associated", "path": None}
bound = la_core.solve(la_core.variant(scene, rule))
comparison.draw(bound).save("friction-associated.png")

# %% [markdown]
# ## The second opinion
#
# YADE's contacts obey Coulomb's law and do not dilate.

# %%
result = comparison.run(scene, "results", quiet=True)
print(result)
assert result.yade is not None
assert result.verdict == "agree"
assert abs(result.yade.reaction - block) < 2e-3 * scene.weight
result.plot("mechanisms").save("friction-mechanisms.png")

# %%
result.plot("reaction").save("friction-reaction.png")

# %% [markdown]
# The associated answer is not useless. It is a bound: no state within Coulomb's cone has a smaller reaction. It is just not a prediction.
# The difference between bound and prediction grows with the friction:

# %%
print("   mu   associated R/W_b   Coulomb R/W_b")
for mu in (0.2, 0.4, 0.6, 0.8):
    other = la_core.solve(la_core.variant(scene, {"joint.friction": mu}))
    print(f"  {mu:.1f}             {other.least / block:.4f}          {other.coulomb / block:.4f}")
    assert abs(other.least / block - 1.0 / (1.0 + mu**2)) < 1e-6

# %% [markdown]
# ## Question
#
# Which share of the right block does the associated rule hang on its neighbour when mu = 0.75?
#
# **Answer.** 1 - 1 / (1 + 0.75²) = 0.36. The true share is 0. (From mu = 1 on, the block of the associated rule tips about the joint
# instead of sliding, and the share stays at one half.)

# %%
rough = la_core.solve(la_core.variant(scene, {"joint.friction": 0.75}))
share = 1.0 - rough.least / block
print(f"share that hangs on the neighbour: {share:.4f} by the associated rule, {1.0 - rough.coulomb / block:.4f} without dilation")
assert abs(share - 0.36) < 1e-6
assert abs(rough.coulomb / block - 1.0) < 2e-3
