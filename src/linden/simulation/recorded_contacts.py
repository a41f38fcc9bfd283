"""The contacts of a frame as collisions of a recording: one a pair, whoever matters more named first.

CARLA records what collision sensors notice; here nobody needs to carry one. A query for two kinds of actors looks at
the first and the second of a collision, so the order is the one that CARLA's users see: the hero or the vehicle, then
what it ran into.
"""

import numpy as np
from numpy.typing import NDArray

from linden.recording import layouts
from linden.sensors.collision import SCENERY
from linden.simulation.episode import Episode
from linden.world.actors import ActorRecord
from linden.world.blueprints import Kind

_RANK = {Kind.VEHICLE: 1, Kind.WALKER: 2}
_LAST_RANK = 3


def collisions(episode: Episode, first_number: int) -> NDArray[np.void]:
    """Return the collisions of the last step, numbered from ``first_number``."""
    pairs: dict[tuple[int, int], tuple[bool, bool]] = {}
    for slot, other_slot in episode.contacts[["a", "b"]].tolist():
        actor = episode.actors.of_slot(slot)
        if other_slot == SCENERY:
            pairs[actor.id, layouts.SCENERY] = (_is_hero(actor), False)
            continue
        first, second = sorted((actor, episode.actors.of_slot(other_slot)), key=_rank)
        pairs[first.id, second.id] = (_is_hero(first), _is_hero(second))
    found = [(first_number + place, *pair, *heroes) for place, (pair, heroes) in enumerate(pairs.items())]
    return np.array(found, layouts.COLLISION)


def _is_hero(actor: ActorRecord) -> bool:
    return actor.description.attribute("role_name") == "hero"


def _rank(actor: ActorRecord) -> tuple[int, int]:
    return 0 if _is_hero(actor) else _RANK.get(actor.kind, _LAST_RANK), actor.id
