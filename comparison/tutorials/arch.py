# %% [markdown]
# # 3. Thrust of an arch
#
# An arch pushes its springings apart. The size of this thrust is unknown, because many lines of thrust fit into the thickness of the
# arch. When one springing gives way, the arch opens at hinges. The line of thrust has to pass through them, and the thrust is known.

# %%
import numpy as np

import comparison
import la_core

radius, thickness, voussoirs = 2.0, 0.3, 12  # an even number: the cut at the crown is a joint
changes = {"title": "Semicircular arch of 12 voussoirs, right springing spreads", "arch[0].voussoirs": voussoirs}
scene = la_core.variant(la_core.load("arch_spreading"), changes, "arch_of_12")
comparison.draw(scene).save("arch-structure.png")

# %% [markdown]
# ## By hand: the line of thrust
#
# Take one half of the arch and cut it at the crown. By symmetry the crown carries a horizontal force H only, at a height z_c. At joint k
# the blocks above it have the moments
#
#     M_i = sum of w_j (x_i - x_j) about its inner edge (x_i, z_i),   M_e about its outer edge (x_e, z_e).
#
# The line of thrust stays within the joint if
#
#     H (z_c - z_i) >= M_i   and   H (z_c - z_e) <= M_e.
#
# Subtract the condition of any outer edge from that of any inner edge. The height z_c cancels: H (z_e - z_i) >= M_i - M_e. Where z_e > z_i
# this is a lower limit of H, where z_e < z_i an upper limit. The largest lower limit is the least thrust, and the smallest upper limit
# is the greatest thrust.


# %%
def thrusts(thickness: float) -> tuple[float, float]:
    """Least and greatest thrust over the weight of the arch, by lines of thrust; no line fits where the least is above the greatest."""
    joint = np.linspace(0.0, np.pi / 2.0, voussoirs // 2 + 1)  # angle from the crown
    half, middle = joint[1] / 2.0, (joint[1:] + joint[:-1]) / 2.0
    inner, outer = radius - thickness / 2.0, radius + thickness / 2.0
    centroid = np.cos(half) * (inner + thickness / 3.0 * (inner + 2.0 * outer) / (inner + outer)) * np.sin(middle)  # of a trapezoid
    above = np.arange(len(middle)) < np.arange(len(joint))[:, None]  # voussoirs above each joint, each of weight 1 / voussoirs
    m_i, m_e = (np.sum(above * (edge * np.sin(joint)[:, None] - centroid), axis=1) / voussoirs for edge in (inner, outer))
    lever = outer * np.cos(joint) - inner * np.cos(joint)[:, None]
    limit = (m_i[:, None] - m_e) / lever
    return float(limit[lever > 0.0].max()), float(limit[lever < 0.0].min())


sharp = la_core.solve(la_core.variant(scene, {"joint.inset": 0.0}))
by_hand = thrusts(thickness)
print(f"least thrust over W:    {by_hand[0]:.6f} by hand, {sharp.least / scene.weight:.6f} by limit analysis")
print(f"greatest thrust over W: {by_hand[1]:.6f} by hand, {sharp.greatest / scene.weight:.6f} by limit analysis")
assert abs(sharp.least / scene.weight - by_hand[0]) < 1e-6
assert abs(sharp.greatest / scene.weight - by_hand[1]) < 1e-6

# %% [markdown]
# ## Which one is it?
#
# The springing spreads, so the arch pushes on it as little as it can: with the least thrust. Three hinges open, at the crown and at both
# haunches. At each hinge one of the two contact points of the joint opens. An arch with three hinges still stands and can follow the
# springing. This is why arches survive springings that spread. No joint slides.

# %%
result = comparison.run(scene, "results", quiet=True)
print(result)
assert result.yade is not None
assert result.verdict == "agree"
measures = result.summary["mechanism_measures"]["associated"]
print(f"contact points that open: {measures['opening']:.0f}, that slide: {measures['sliding']:.0f}")
assert (measures["opening"], measures["sliding"]) == (3, 0)
result.plot("mechanisms").save("arch-mechanisms.png")

# %% [markdown]
# The next figure shows the line of thrust itself, through the centres of pressure of all joints. It touches the outer edge at the crown
# and the inner edge at both haunches. These points are the hinges.

# %%
result.plot("forces").save("arch-thrust.png")

# %%
result.plot("reaction").save("arch-reaction.png")

# %% [markdown]
# ## How thin may it be?
#
# A thinner arch leaves less room for lines of thrust: the least and the greatest thrust approach each other. Where they meet, only one
# line of thrust fits. In a still thinner arch none fits, and limit analysis proves that the arch falls.

# %%
low, high = 0.1, thickness
while high - low > 1e-6:
    between = (low + high) / 2.0
    least, greatest = thrusts(between)
    low, high = (low, between) if least <= greatest else (between, high)
print(f"least thickness by lines of thrust: {high:.4f} m, {high / radius:.4f} of the radius")
for share, expected in ((1.002, la_core.Status.SOLVED), (0.998, la_core.Status.INFEASIBLE)):
    thin = la_core.variant(scene, {"arch[0].thickness": share * high, "joint.inset": 0.0})
    status = la_core.solve(thin).status
    print(f"{share:.3f} of that: {status}")
    assert status == expected

# %% [markdown]
# An arch that may crack anywhere, not at twelve joints only, needs a little more: 0.1075 of the radius (Milankovitch 1907).
#
# ## Question
#
# Build the same arch twice as large in all three directions, of the same stone. What becomes of its thrust?
#
# **Answer.** H over W does not change, because it depends only on ratios of lengths. W grows with the volume, by a factor of 8, and so does
# the thrust. The areas of the joints grow only by a factor of 4, so the stresses double. Stability does not depend on size. Strength does.

# %%
double = {"arch[0].radius": 2.0 * radius, "arch[0].thickness": 2.0 * thickness, "arch[0].depth": 0.8, "joint.inset": 0.0}
large = la_core.solve(la_core.variant(scene, double))
print(f"thrust of the large arch over that of the small one: {large.least / sharp.least:.4f}")
assert abs(large.least / sharp.least - 8.0) < 1e-4
