"""Short labels of mechanisms for tables and maps; equal mechanisms have equal labels."""

import hashlib

import numpy as np

from la_core.measures import block_speeds, fastest_speed
from la_core.model import Assembly

# Shares of `fastest_speed`: slower blocks only strain elastically, faster ones belong to the mechanism.
SLOWEST, FASTEST = 0.03, 0.1


def mechanism_label(assembly: Assembly, twists: np.ndarray) -> str | None:
    """Return a label for twists (B, 6): the number of moving blocks and a digest of their names; None without a mechanism.

    The widest gap between speeds (as a ratio) from SLOWEST to FASTEST separates moving from resting blocks, so round-off does not
    change a label. Where the support moves alone, the rest is round-off, and no block moves.
    """
    if not np.isfinite(twists).all():
        return None
    blocks, fastest = assembly.blocks, fastest_speed(assembly, twists)
    if not fastest > 0.0:
        return None
    share = np.where(blocks.free, block_speeds(blocks, twists) / fastest, 0.0)
    between = np.sort(share[(share > SLOWEST) & (share < FASTEST)])
    edges = np.concatenate([[SLOWEST], between, [FASTEST]])
    widest = int(np.argmax(edges[1:] / edges[:-1]))
    moving = np.flatnonzero(share >= np.sqrt(edges[widest] * edges[widest + 1]))
    names = "\n".join(sorted(blocks.names[i] for i in moving))
    return f"{len(moving)}-{hashlib.sha256(names.encode()).hexdigest()[:6]}"
