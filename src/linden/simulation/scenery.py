"""What of the map stands in the way of a vehicle: as yet the posts of traffic lights and signs."""

import numpy as np

from linden.ground import Ground
from linden.physics.contact.statics import STATIC_BOX, Statics
from linden.traffic.actors import TrafficActor
from linden.values.enums import SemanticTag

POST_HALF_WIDTH_M = 0.05
"""Half the width of a sign's square steel post, and about that of a light's pole where a bumper meets it."""

POST_HEIGHT_M = 2.5


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
