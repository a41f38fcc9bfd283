"""``basu service falls``: how many of 100 standing passengers lose balance in a recorded drive."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from basu.errors import UserError
from basu.metrics.passengers.felt import felt
from basu.records.history.files import read_history
from basu_service.falls import of_hundred

if TYPE_CHECKING:
    import argparse


def run(arguments: argparse.Namespace) -> int:
    """Print the answer for passengers without and with a handhold.

    Raises:
        UserError: the folder has no record, or one that is too short.
    """
    sensed = felt(read_history(arguments.folder))
    if sensed is None:
        raise UserError(f"the record in {arguments.folder} has fewer than four frames, in which nothing can be felt")
    pushes_mps2 = sensed.horizontal_mps2()
    worst = int(np.argmax(pushes_mps2))
    strongest_mps2 = float(pushes_mps2[worst])
    print(
        f"strongest push    {strongest_mps2:.2f} m/s² at {sensed.t_s[worst]:.1f} s, "
        f"at {abs(sensed.speed_mps[worst]):.1f} m/s"
    )
    for name, holds_on in (("standing free", False), ("holding on", True)):
        found = of_hundred(strongest_mps2, holds_on=holds_on)
        print(
            f"{name:<18}{found.value:.0f} of 100 lose balance "
            f"(95 % interval of the model: {found.low:.0f} to {found.high:.0f})"
        )
    return 0
