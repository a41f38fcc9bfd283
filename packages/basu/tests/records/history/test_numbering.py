"""A record names actors by numbers of its own: runs that differ in the simulator's ids alone leave the same record."""

from dataclasses import replace

import numpy as np

from basu.records.history import History
from basu.records.history.model import OTHER
from basu.records.history.numbering import Numbering
from fakes.drives import at, driven, hit


def recorded(first_id: int) -> History:
    history = driven(at(5.0, 1.0), collisions=[replace(hit(3), other_id=first_id + 9), replace(hit(4), other_id=0)])
    others = np.zeros(3, OTHER)
    others["tick"], others["id"] = [0, 0, 1], [first_id + 4, first_id, first_id + 4]
    types = {first_id + 4: "vehicle.a", first_id: "walker.b"}
    facts = replace(history.facts, actor_types=types, actor_sizes={first_id: (0.3, 0.3)})
    return replace(history, others=others, facts=facts)


def test_actors_are_counted_in_the_order_in_which_they_are_named() -> None:
    numbered = Numbering().applied(recorded(551))
    assert numbered.others["id"].tolist() == [1, 2, 1]
    assert [event.other_id for event in numbered.collisions] == [3, 0]
    assert numbered.facts.actor_types == {1: "vehicle.a", 2: "walker.b"}
    assert numbered.facts.actor_sizes == {2: (0.3, 0.3)}


def test_other_ids_of_the_simulator_leave_the_same_record() -> None:
    first, second = Numbering().applied(recorded(60)), Numbering().applied(recorded(7000))
    assert first.others.tobytes() == second.others.tobytes()
    assert (first.collisions, first.facts.actor_types) == (second.collisions, second.facts.actor_types)
