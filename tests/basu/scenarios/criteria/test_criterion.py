"""Claims about the base: phases as frames, and a criterion of one's own."""

import numpy as np
import pytest

from basu.scenarios.criteria import Criterion, Judgement, Played
from fakes.drives import at, driven
from fakes.played import played


class NeverBacks(Criterion):
    """As the documentation has it."""

    name = "never backs"

    def judge(self, played: Played) -> Judgement:
        backing = np.flatnonzero(played.history.frames["reverse"])
        if len(backing) == 0:
            return self.says(played, True, "it never backed")
        return self.says(played, False, "it put the gear in reverse", tick=int(backing[0]))


def test_a_criterion_of_ones_own_says_when_where_and_how_fast() -> None:
    history = driven(at(5.0, 4.0))
    assert NeverBacks().judge(played(history)).passed is True
    history.frames["reverse"][40:] = 1
    said = NeverBacks(deciding=False).judge(played(history))
    assert (said.criterion, said.passed, said.deciding) == ("never backs", False, False)
    assert (said.t_s, said.x_m, said.y_m, said.speed_mps) == pytest.approx((2.0, 10.0, 0.0, 5.0))


@pytest.mark.parametrize(
    ("phases_s", "phase", "tick"),
    [({}, None, 0), ({"end": 1.0}, "end", 20), ({}, "end", None), ({"end": 99.0}, "end", None)],
)
def test_a_phase_begins_in_its_frame(phases_s: dict[str, float], phase: str | None, tick: int | None) -> None:
    assert played(driven(at(5.0, 4.0)), phases_s=phases_s).first_tick(phase) == tick
