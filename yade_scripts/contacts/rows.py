"""Rows of arrays by the block that owns them, found for all blocks at once."""

import numpy as np


def rows_of(owner: np.ndarray, count: int) -> list[np.ndarray]:
    """Return the rows of each owner from 0 to `count` - 1, in ascending order.

    `owner` (N,) has the owner of every row. One sort is enough for all owners. A search through the N rows for each owner would take a
    time in proportion to the square of the structure's size.
    """
    order = np.argsort(owner, kind="stable")
    return np.split(order, np.searchsorted(owner[order], np.arange(1, count)))
