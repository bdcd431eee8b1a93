"""Schema of the HDF5 files between the two methods; one table writes, reads, checks and documents them.

`case.h5` carries the assembly and its limit analysis to YADE; `run.h5` carries YADE's record back.
This module runs in both interpreters: standard library, numpy >= 1.24 and h5py >= 3.7 only.

Conventions: SI units, z up. Twist = (vx, vy, vz, wx, wy, wz), wrench likewise (force, moment), about the block's
centroid unless a field says otherwise. Contact (a, b) has its normal from a to b; the contact force is the force on b,
compression positive along the normal. An undefined number is NaN, never 0.
"""

from dataclasses import dataclass

FREE, FIXED, SUPPORT = 0, 1, 2
GRAVITY, SETTLEMENT = 0, 1  # stages of a run in YADE; the second is that of a live load, too
EARLIER_ATTEMPT = "; before, "  # in `result/message`: precedes each attempt but the last
LEFT_PLATEAU = " leaves it before "  # in `result/message`: the value left the plateau that the run states


@dataclass(frozen=True)
class Field:
    """One dataset of a file.

    Attributes
    ----------
    path : str
        Path in the file.
    dtype : str
        "f8", "i8", "u1" or "str".
    shape : tuple of str and int
        Size of each dimension, or a letter for it; equal letters are equal sizes. () is a scalar.
    unit : str
        SI unit; "" for none.
    meaning : str
        Meaning of the values.
    """

    path: str
    dtype: str
    shape: tuple[str | int, ...]
    unit: str
    meaning: str


# Dimensions: B blocks, V vertices, L face-loop entries, F faces, I interfaces, C contact points.
CASE_FIELDS = (
    Field("scene/name", "str", (), "", "scene file's stem"),
    Field("scene/title", "str", (), "", "title for people"),
    Field("scene/gravity", "f8", (3,), "m/s2", "acceleration of gravity"),
    Field("scene/plane", "u1", (), "", "1: motion in the xz plane only; contact points lie at mid depth"),
    Field("scene/effects", "str", (), "", "decided effects with their reasons, a JSON object"),
    Field("scene/displacement", "str", (), "", "small: only the listed contacts; finite: YADE searches for new ones"),
    Field("scene/least_gap", "f8", (), "m", "lower bound of the gap between blocks without a joint; NaN where it was not computed"),
    Field("scene/recording", "str", (), "", "states stored: plateau (at rest and on the plateau) or states (over the whole run)"),
    Field("scene/inset", "f8", (), "m", "inset of the contact points stored here"),
    Field("scene/support_twist", "f8", (6,), "-", "support's unit motion: velocity of the origin, angular velocity"),
    Field("scene/settings", "str", (), "", "YADE settings of the scene, in place of derived ones, a JSON object"),
    Field("scene/accuracy", "str", (), "", "attempts at the requested accuracy, a JSON object; null where none was requested"),
    Field("blocks/name", "str", ("B",), "", "unique block names"),
    Field("blocks/role", "i8", ("B",), "", "0 free, 1 fixed, 2 support"),
    Field(
        "blocks/aside", "u1", ("B",), "", "1: a free block of the scene that is held here, because the support's motion does not affect it"
    ),
    Field("blocks/mass", "f8", ("B",), "kg", "density times volume"),
    Field("blocks/centroid", "f8", ("B", 3), "m", "centre of mass"),
    Field("blocks/inertia", "f8", ("B", 3, 3), "kg m2", "inertia about the centroid, global axes"),
    Field("blocks/vertices", "f8", ("V", 3), "m", "vertices of all blocks, block after block"),
    Field("blocks/vertex_start", "i8", ("B1",), "", "block i owns vertices[start[i]:start[i+1]]; B+1 entries"),
    Field("blocks/face_vertex", "i8", ("L",), "", "face loops: rows of vertices, counter-clockwise from outside"),
    Field("blocks/face_start", "i8", ("F1",), "", "face j owns face_vertex[start[j]:start[j+1]]; F+1 entries"),
    Field("blocks/face_block", "i8", ("F",), "", "block that owns the face"),
    Field("interfaces/block_a", "i8", ("I",), "", "lower block index"),
    Field("interfaces/block_b", "i8", ("I",), "", "higher block index"),
    Field("interfaces/normal", "f8", ("I", 3), "-", "unit normal from a to b"),
    Field("interfaces/area", "f8", ("I",), "m2", "area of the overlap, not inset"),
    Field("contacts/interface", "i8", ("C",), "", "interface of the contact point"),
    Field("contacts/position", "f8", ("C", 3), "m", "contact point, inset"),
    Field("contacts/friction", "f8", ("C",), "-", "friction coefficient tan(phi)"),
    Field("joints/normal_stiffness", "f8", (), "N/m", "stiffness of one contact point along its normal"),
    Field("joints/shear_stiffness", "f8", (), "N/m", "stiffness of one contact point across its normal"),
    Field("joints/travel", "f8", (), "m or rad", "largest motion of the support; under a live load, of the fastest block"),
    Field("joints/sag", "f8", (), "m", "largest displacement of a centroid under the weights, joints glued at normal_stiffness all ways"),
)
# Optional: only where a block consists of several convex parts, and only where the inset of a joint is not that of the scene.
PART_FIELDS = (
    Field("parts/block", "i8", ("Q",), "", "block of each convex part; the parts of a block move as one"),
    Field("parts/vertex_start", "i8", ("Q1",), "", "part i owns blocks/vertices[start[i]:start[i+1]]; Q+1 entries"),
    Field("parts/face_start", "i8", ("Q1",), "", "part i owns the faces start[i] to start[i+1]-1; Q+1 entries"),
)
JOINT_INSET = Field("contacts/inset", "f8", ("C",), "m", "inset of each contact point: that of the scene, but less in a short joint")
# Optional: files of version 0.2.0 do not have it.
SWAY = Field("joints/sway", "f8", (), "m", "joints/sag if the weights acted sideways, in the direction of the slowest sway")
# Optional: only where the path of limit analysis was long.
LONG_RUN_SETTINGS = Field(
    "scene/settings_of_long_run",
    "str",
    (),
    "",
    "settings in place of scene/settings for a case whose run would take long with those, a JSON object",
)
# Optional: only where a live load drives the structure; no support moves then.
LIVE_DIRECTION = Field("scene/live", "f8", (3,), "-", "unit direction of a load in proportion to the weights of the free blocks")
# Optional: only where supports move by different shares of the settlement.
SUPPORT_TWISTS = Field(
    "blocks/support_twist", "f8", ("B", 6), "-", "unit motion of each support: velocity of the origin, angular velocity; 0 for other blocks"
)
# Optional: only where loads or ties act on blocks.
LOAD_FIELDS = (
    Field(
        "blocks/applied_load",
        "f8",
        ("B", 6),
        "N, N m",
        "dead loads and ties on each block, a wrench that never changes; 0 for blocks/aside",
    ),
    Field(
        "blocks/load_weight",
        "f8",
        ("B",),
        "N",
        "part of the dead loads along gravity, which counts in W; 0 for blocks/aside, although W contains their loads, too",
    ),
    Field(
        "blocks/live_load", "f8", ("B", 6), "N, N m", "live load of multiplier 1 that the dead loads on each block add; 0 for a settlement"
    ),
)
# Fields that only some structures have: convex parts, insets of short joints, own motions of supports, a live load, dead loads and ties.
OWN_FIELDS = (*PART_FIELDS, JOINT_INSET, SUPPORT_TWISTS, LIVE_DIRECTION, *LOAD_FIELDS)
# Optional: only where an effect was restored after a run in YADE.
FIRST_PREDICTION = Field(
    "scene/first_prediction",
    "str",
    (),
    "",
    "answers of limit analysis before the run in YADE that showed an effect to be needed, a JSON object",
)
_SOLUTION = (
    ("status", "str", (), "", "solved, infeasible, unbounded, inaccurate or failed"),
    ("value", "f8", (), "N, N m or -", "reaction for a settlement, multiplier for a live load"),
    ("twists", "f8", ("B", 6), "m/s per unit motion", "mechanism, every block, under a live load per N m of its work; NaN for none"),
    ("forces", "f8", ("C", 3), "N", "contact force on b, global axes; NaN where there is none"),
    ("equilibrium_residual", "f8", (), "-", "largest unbalanced force over the mean free-block weight"),
    ("cone_violation", "f8", (), "-", "largest friction-cone violation over the mean free-block weight"),
    ("mechanism_violation", "f8", (), "-", "largest violation of the flow rule over the largest speed of a block"),
    ("duality_gap", "f8", (), "-", "value from forces less value from work, over the mean free-block weight"),
    ("seconds", "f8", (), "s", "solver time"),
    ("iterations", "i8", (), "", "solver iterations"),
    ("falling", "str", ("K",), "", "blocks that fall, where the structure cannot stand"),
    ("error", "f8", (), "N, N m or -", "estimated error of the value, by its duality gap and by the forces out of balance"),
)
_COULOMB = (
    ("status", "str", (), "", "solved, inaccurate or failed; the status of the associated answer where that one has no value"),
    ("value", "f8", (), "N, N m or -", "reaction or multiplier with friction that does not dilate"),
    ("interval", "f8", (2,), "N, N m or -", "least and greatest value that the mechanism allows"),
    ("twists", "f8", ("B", 6), "m/s per unit motion", "mechanism, every block, under a live load per N m of its work; NaN for none"),
    ("forces", "f8", ("C", 3), "N", "contact force on b on the plateau, global axes; NaN where there is none"),
    ("at_rest", "f8", (), "N, N m or -", "value before the support moves"),
    ("drift", "f8", (), "-", "relative change of the mean value from the second quarter of the travel to its second half"),
    ("dilatancy_residual", "f8", (), "-", "power of normal forces at parting joints over the power put in"),
    ("strain_residual", "f8", (), "-", "power of weights less dissipation less power of the reaction, over the power put in"),
    ("equilibrium_residual", "f8", (), "-", "largest unbalanced force over the mean free-block weight"),
    ("cone_violation", "f8", (), "-", "largest friction-cone violation over the mean free-block weight"),
    ("seconds", "f8", (), "s", "time of the paths"),
    ("iterations", "i8", (), "", "Newton iterations of all paths"),
    ("steps", "i8", (), "", "steps of all paths; 0 where no path was followed"),
    ("uncertainty", "f8", (), "N, N m or -", "stated uncertainty of the value"),
    ("plateaus", "f8", ("K",), "N, N m or -", "values of all plateaus where there are several, that of the answer first; else empty"),
    ("sliding_residual", "f8", (), "-", "dissipation less power of friction against slip, over the power put in"),
    ("travel", "f8", (), "-", "end of the path over the travel"),
    ("viscosities", "f8", ("V",), "-", "first viscosity of each path, over the weight at unit rate"),
    ("path_settlement", "f8", ("P",), "m or rad", "curve of the finest path: motion of the support, or displacement along the live load"),
    ("path_value", "f8", ("P",), "N, N m or -", "curve of the finest path: reaction or multiplier"),
)
# Dimension P of a path: rest, then one entry an increment.
PATH_FIELDS = (
    Field("path/settlement", "f8", ("P",), "m or rad", "motion of the support, or mean displacement along the live load"),
    Field("path/value", "f8", ("P",), "N, N m or -", "reaction or multiplier"),
    Field("path/strain_residual", "f8", ("P",), "-", "part of the value that replaces the drag of the path, over the value"),
    Field("path/converged", "u1", ("P",), "", "1: the path reached the increment"),
    Field("path/solves", "i8", ("P",), "", "Newton iterations of the increment"),
    Field("path/seconds", "f8", (), "s", "time of the path"),
)


def solution_fields(group: str, with_error: bool = True) -> tuple[Field, ...]:
    """Fields of one associated solution below `limit_analysis/<group>`; its number of contact points is independent.

    with_error: False for files of earlier versions, which state no error of a bound.
    """
    return _below(group, _SOLUTION if with_error else _SOLUTION[:-1])


def coulomb_fields(group: str, with_path: bool = True) -> tuple[Field, ...]:
    """Fields of one Coulomb solution below `limit_analysis/<group>`; its number of contact points is independent.

    with_path: False for files of version 0.2.0, which state no uncertainty and hold no curve.
    """
    return _below(group, _COULOMB if with_path else _COULOMB[: [name for name, *_ in _COULOMB].index("uncertainty")])


def _below(group: str, rows: tuple[tuple[str, str, tuple[str | int, ...], str, str], ...]) -> tuple[Field, ...]:
    dimensions = {name: f"{name} of {group}" for name in "CKPV"}
    return tuple(
        Field(f"limit_analysis/{group}/{name}", dtype, tuple(dimensions.get(str(n), n) for n in shape), unit, meaning)
        for name, dtype, shape, unit, meaning in rows
    )


# Optional: only where a path went on with turning blocks.
RELEASE_FIELDS = _below(
    "coulomb",
    (
        ("released", "f8", (), "N, N m or -", "value after turning blocks have released the thrusts that friction locked in"),
        ("released_uncertainty", "f8", (), "N, N m or -", "stated uncertainty of that value"),
    ),
)
# Optional: only where the curve of a live load rises above its plateau.
PEAK_FIELDS = _below(
    "coulomb",
    (("peak", "f8", (2,), "-", "greatest multiplier on the way to the plateau, and its stated uncertainty"),),
)

UNCERTAINTY_PARTS = (
    Field("result/uncertainty_scatter", "f8", (), "N or N m", "part of the uncertainty: noise of the record"),
    Field("result/uncertainty_fit", "f8", (), "N or N m", "part of the uncertainty: line through the plateau, or its level"),
    Field("result/uncertainty_rate", "f8", (), "N or N m", "part of the uncertainty: difference from a quicker attempt; NaN without one"),
    Field("result/uncertainty_stiffness", "f8", (), "N or N m", "part of the uncertainty: strain of the joints, and settings"),
)
DAMPED_ENERGY = Field("record/damped_energy", "f8", ("T",), "J", "energy that the damping of the blocks' swing has taken so far")
LATER_RUN_FIELDS = (*UNCERTAINTY_PARTS, DAMPED_ENERGY)  # files of version 0.2.0 do not have these
# Dimensions besides those above: T recorded rows, P stored poses, E contacts YADE found and the case does not list.
RUN_FIELDS = (
    Field("result/status", "str", (), "", "plateau, no plateau, collapsed, timeout or failed"),
    Field("result/reaction", "f8", (), "N or N m", "plateau reaction, or multiplier, which has no unit, extrapolated to zero settlement"),
    Field(
        "result/uncertainty", "f8", (), "N or N m", "uncertainty of the plateau reaction, or multiplier; it and its parts then have no unit"
    ),
    *UNCERTAINTY_PARTS,
    Field("result/settlement", "f8", (), "m or rad", "achieved motion of the support, read from its pose"),
    Field(
        "result/asked_settlement",
        "f8",
        (),
        "m or rad",
        "imposed motion at the stop, of the support or of the point that pulls a live load",
    ),
    Field("result/plateau_start", "f8", (), "m or rad", "settlement where the fitted plateau begins"),
    Field("result/slope", "f8", (), "N/m", "slope of the fitted line; N m/rad for a rotation, 1/m for a multiplier"),
    Field("result/kinetic_ratio", "f8", (), "-", "largest kinetic energy on the plateau over the weights' work there"),
    Field("result/steps", "i8", (), "", "time steps taken"),
    Field("result/seconds", "f8", (), "s", "wall time inside YADE"),
    Field("result/version", "str", (), "", "YADE version"),
    Field(
        "result/message",
        "str",
        (),
        "",
        'how the last attempt ended, with " leaves it before " at a plateau that was left; then each earlier one after "; before, "',
    ),
    Field("settings/json", "str", (), "", "all settings as used, a JSON object"),
    Field("record/stage", "i8", ("T",), "", "0 gravity, 1 settlement or live load"),
    Field("record/time", "f8", ("T",), "s", "model time"),
    Field("record/settlement", "f8", ("T",), "m or rad", "support motion so far, or mean displacement along the live load"),
    Field(
        "record/reaction",
        "f8",
        ("T",),
        "N or N m",
        "minus support twist . wrench of the support on the structure; or the multiplier, which has no unit",
    ),
    Field("record/support_wrench", "f8", ("T", 6), "N, N m", "force and moment (about the origin) of supports on the structure"),
    Field("record/kinetic_energy", "f8", ("T",), "J", "kinetic energy of the free blocks"),
    DAMPED_ENERGY,
    Field(
        "record/unbalanced",
        "f8",
        ("T",),
        "-",
        "largest unbalanced force over the mean free-block weight; at stage 0, for a light block, over 20 times its own weight",
    ),
    Field("poses/settlement", "f8", ("P",), "m or rad", "support motion of each stored state; the first is rest under gravity"),
    Field("poses/displacement", "f8", ("P", "B", 3), "m", "displacement of the centroid from the case's geometry"),
    Field("poses/rotation", "f8", ("P", "B", 3), "rad", "rotation vector from the case's geometry"),
    Field("poses/forces", "f8", ("P", "C", 3), "N", "contact force on b at the case's contact points, global axes"),
    Field("extra_contacts/blocks", "i8", ("E", 2), "", "block pairs that touched in YADE at a point the case does not list"),
    Field("extra_contacts/position", "f8", ("E", 3), "m", "point where they touched first"),
)


def schema_table(fields: tuple[Field, ...]) -> str:
    """The schema as a Markdown table, for the documentation."""
    rows = ["| path | type | shape | unit | meaning |", "|---|---|---|---|---|"]
    rows += [f"| {f.path} | {f.dtype} | {' x '.join(map(str, f.shape)) or 'scalar'} | {f.unit} | {f.meaning} |" for f in fields]
    return "\n".join(rows)
