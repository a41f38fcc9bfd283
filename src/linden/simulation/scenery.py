"""What stands on a map before anybody comes: its lights and signs, and what is in the way, as yet their posts."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from linden.ground import Ground
from linden.physics.contact.statics import STATIC_BOX, Statics
from linden.traffic.actors import Signals, TrafficActor
from linden.values.enums import SemanticTag
from linden.world.maps import LoadedMap

POST_HALF_WIDTH_M = 0.05
"""Half the width of a sign's square steel post, and about that of a light's pole where a bumper meets it."""

POST_HEIGHT_M = 2.5


class Scenery(NamedTuple):
    """What every episode on a map begins with; nothing in it ever changes."""

    signals: Signals
    statics: Statics


@lru_cache(maxsize=1)
def scenery_of(world_map: LoadedMap) -> Scenery:
    """Return the scenery of a map; the last one is kept, for most loads load the same map again."""
    signals = Signals.of(world_map.signals, world_map.controllers, world_map.give_way)
    return Scenery(signals, signal_posts(signals.actors, world_map.ground))


def signal_posts(actors: tuple[TrafficActor, ...], ground: Ground) -> Statics:
    """Return one upright box under every light and sign, standing on the ground; its id is the place in ``actors``."""
    if not actors:
        return Statics.none()
    posts = np.zeros(len(actors), STATIC_BOX)
    centres = np.array([actor.transform.location for actor in actors])
    height_m, _ = ground.surfaces_under(centres)
    posts["centre"] = np.column_stack([centres[:, :2], height_m + 0.5 * POST_HEIGHT_M])
    posts["half"] = (POST_HALF_WIDTH_M, POST_HALF_WIDTH_M, 0.5 * POST_HEIGHT_M)
    posts["tag"] = SemanticTag.POLES
    posts["id"] = np.arange(len(posts))
    return Statics.of(posts)
