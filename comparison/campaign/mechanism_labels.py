"""Short labels of mechanisms, equal for equal ones, for tables and maps."""

import hashlib

import numpy as np

from la_core.geometry import Blocks
from la_core.measures import block_speeds

SLOWEST, FASTEST = 0.03, 0.1  # of the fastest block: what is slower is elastic strain, what is faster takes part in the mechanism


def mechanism_label(blocks: Blocks, twists: np.ndarray) -> str | None:
    """Number of moving blocks and a digest of their names, for twists (B, 6); None where there is no mechanism.

    What moves is parted from what stands at the widest gap between speeds, as ratios, from SLOWEST to FASTEST: round-off does not
    carry a block across it.
    """
    if not np.isfinite(twists).all():
        return None
    speed = np.where(blocks.free, block_speeds(blocks, twists), 0.0)
    if not speed.max() > 0.0:
        return None
    share = speed / speed.max()
    between = np.sort(share[(share > SLOWEST) & (share < FASTEST)])
    edges = np.concatenate([[SLOWEST], between, [FASTEST]])
    widest = int(np.argmax(edges[1:] / edges[:-1]))
    moving = np.flatnonzero(share >= np.sqrt(edges[widest] * edges[widest + 1]))
    names = "\n".join(sorted(blocks.names[i] for i in moving))
    return f"{len(moving)}-{hashlib.sha256(names.encode()).hexdigest()[:6]}"
