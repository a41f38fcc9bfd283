"""Spring arms: where something hangs that is attached to its parent by one. Source: ActorAttacher.cpp.

Its place says how long the arm is and where to; it looks back along the arm, and its own rotation adds to that. These
arms are stiff: they take part in their parent's pitch and roll, turn without lag, and go through what is in the way.
"""

import math

from linden.errors import Refusal
from linden.geometry import compose
from linden.values.enums import AttachmentType
from linden.values.space import Rotation, Transform, Vector3D

LIFT_M = 0.3
"""By how much CARLA raises an arm that minds the ground, so that bumps do not draw it in."""


def hung(pose: Transform, attachment: int) -> Transform:
    """Return where in its parent's frame something is that was attached with ``pose``.

    Raises:
        Refusal: there is no such kind of attachment.
    """
    if attachment not in tuple(AttachmentType):
        known = ", ".join(f"{kind.value} ({kind.name})" for kind in AttachmentType)
        raise Refusal(f"unable to attach actor: {attachment} is no kind of attachment; there are {known}")
    if attachment == AttachmentType.RIGID:
        return pose
    x_m, y_m, z_m = pose.location
    # Unreal's MakeFromX leaves the nose ahead where the arm has no length
    pitch_deg = math.degrees(math.atan2(-z_m, math.hypot(x_m, y_m)))
    yaw_deg = math.degrees(math.atan2(-y_m, -x_m)) if (x_m, y_m) != (0.0, 0.0) else 0.0
    lift_m = LIFT_M if attachment == AttachmentType.SPRING_ARM else 0.0
    along_arm = Transform(Vector3D(x_m, y_m, z_m + lift_m), Rotation(pitch_deg, yaw_deg, 0.0))
    return compose(along_arm, Transform(Vector3D(), pose.rotation))
