"""How often the interval of a rare failure holds the truth, and how often it warns, on regions that are known.

usage: rare_events.py [--repetitions N] [--drives N] [--learn N]

No simulator is needed. ``covers`` is the share of repetitions whose 95 % interval holds the truth; ``warns`` the share
with a caution; ``misses, no warning`` the share that does neither. ``value`` is the mean estimate over the truth, and
``error`` the median standard error over the estimate.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from basu.campaigns.settings import EstimateSettings
from rare_regions import REGIONS


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repetitions", type=int, default=200)
    parser.add_argument("--drives", type=int, default=500)
    parser.add_argument("--learn", type=int, default=400)
    given = parser.parse_args()
    settings = EstimateSettings(drives=given.drives, learn=given.learn, batch=min(100, given.drives))
    print(
        f"{'region':<32} {'truth':>8} {'covers':>7} {'warns':>6} {'misses, no warning':>18} {'value':>6} {'error':>6}"
    )
    for name, region in REGIONS.items():
        found = [region.estimated(settings, seed) for seed in range(given.repetitions)]
        covers = np.array([each.low <= region.exact <= each.high for each in found])
        warns = np.array([bool(each.cautions) for each in found])
        missed = (~covers & ~warns).mean()
        line = f"{name:<32} {region.exact:>8.2g} {covers.mean():>7.1%} {warns.mean():>6.1%} {missed:>18.1%}"
        values = np.array([each.value for each in found])
        errors = [each.deviation / each.value for each in found if each.failures]
        if region.exact > 0.0:
            line += f" {values.mean() / region.exact:>6.2f} {np.median(errors):>6.2f}"
        print(line, flush=True)


if __name__ == "__main__":
    main()
