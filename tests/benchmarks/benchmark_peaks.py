"""Peaks of the multiplier of pushed walls before their plateaus: the stated uncertainty compared with a path of almost no drag.

    python tests/benchmarks/benchmark_peaks.py [--walls N]

Prints one line for each wall whose peak is known, and a summary.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import math

import numpy as np
from pushed_walls import ALONG, OBLIQUE, peak_without_drag, pushed_wall, seconds_of_peak

from la_core.errors import SceneError

WALLS = 100


def main() -> None:
    """Push the walls along their length and obliquely, and print their peaks."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--walls", type=int, default=WALLS)
    walls, pushed, shares, lifts, apart, costs = parser.parse_args().walls, 0, [], [], [], []
    for seed in range(walls):
        for live in (ALONG, OBLIQUE):
            try:
                coulomb = (analysis := pushed_wall(seed, live)).coulomb
            except SceneError as error:
                print(f"{seed:3} {live}: refused, {error}")
                continue
            if coulomb is None or math.isnan(coulomb.value):
                continue
            pushed += 1
            if not len(coulomb.peak):
                continue
            (peak, uncertainty), true, usual = coulomb.peak, peak_without_drag(analysis), float(coulomb.path_value.max())
            shares.append(abs(peak - true) / uncertainty)
            apart.append(abs(peak - true) / true)
            lifts.append(usual / true - 1.0)
            costs.append(seconds_of_peak(analysis) / coulomb.seconds)
            answer = f"plateau {coulomb.value:.5f}, peak {peak:.5f} ± {uncertainty:.5f}"
            print(f"{seed:3} {live}: {answer}, without drag {true:.5f}, usual path {usual:.5f}", flush=True)
    held = int((np.array(shares) <= 1.0).sum())
    off, lift = max(apart, default=0.0), max(lifts, default=0.0)
    print(f"{len(shares)} peaks of {pushed} pushed walls; {held} hold, at most {off:.2%} off, and usual paths {lift:.2%}; ", end="")
    print(f"of the time of a prediction they take {np.median(costs or [0.0]):.0%} in the median, {max(costs, default=0.0):.0%} at most")


if __name__ == "__main__":
    main()
