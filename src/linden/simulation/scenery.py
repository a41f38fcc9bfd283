"""What stands on a map before anybody comes: its lights and signs, and the scene that they are part of."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from linden.physics.contact.statics import STATIC_BOX, Statics
from linden.scene.home import home
from linden.scene.neighbourhood import furnish
from linden.scene.objects import Scene, join
from linden.scene.signs import Post, posts
from linden.scene.walls import walls
from linden.traffic.actors import NO_LIGHT, Signals
from linden.world.maps import GENERATED_MAP, HOME_MAP, LoadedMap


class Scenery(NamedTuple):
    """What every episode on a map begins with; nothing in it ever changes.

    The first things of the scene are those of the signals' actors, in their order.
    """

    signals: Signals
    scene: Scene
    statics: Statics


@lru_cache(maxsize=1)
def scenery_of(world_map: LoadedMap) -> Scenery:
    """Return the scenery of a map; the last one is kept, for most loads load the same map again.

    Of Linden it is known what stands beside its streets; other maps have plainer houses where there is room. What a
    client sent as OpenDRIVE has none, as in CARLA: lights, signs, and the walls it asked for.
    """
    signals = Signals.of(world_map.signals, world_map.controllers, world_map.give_way)
    standing = [Post(actor.transform, actor.light != NO_LIGHT) for actor in signals.actors]
    scene = posts(standing, world_map.ground)
    if len(world_map.walls.feet_m):
        scene = join([scene, walls(*world_map.walls)])
    if world_map.name == HOME_MAP:
        scene = join([scene, home(world_map)])
    elif world_map.name != GENERATED_MAP:
        scene = join([scene, furnish(world_map.lots, world_map.ground)])
    return Scenery(signals, scene, solid(scene, np.ones(len(scene.boxes), bool)))


def solid(scene: Scene, present: NDArray[np.bool_]) -> Statics:
    """Return the boxes of a scene that are present as physics takes them; their ids are their rows in the scene."""
    rows = np.flatnonzero(present)
    if not len(rows):
        return Statics.none()
    boxes = np.zeros(len(rows), STATIC_BOX)
    for name in ("centre", "half", "yaw_rad", "tag"):
        boxes[name] = scene.boxes[name][rows]
    boxes["id"] = rows
    return Statics.of(boxes)
