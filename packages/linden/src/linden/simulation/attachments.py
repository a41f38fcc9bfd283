"""Attachment to spring arms (pose computed once at spawn) and to sockets or bones of a parent (followed every frame).

The pose of a child on a spring arm gives the arm's length and direction. The child looks back along the arm, and its
own rotation adds to that (ActorAttacher.cpp). These arms are stiff: they take part in their parent's pitch and roll,
turn without lag, and pass through obstacles. A child on a bone or socket follows it in every frame.
"""

import math

from linden.blueprints.skeleton import transform_of
from linden.errors import Refusal
from linden.geometry import compose
from linden.protocol.values.enums import AttachmentType
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.simulation.bones import sockets_of
from linden.simulation.state import EpisodeState

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


class Sockets:
    """The sockets of attached actors, by the child's actor id."""

    def __init__(self) -> None:
        self._attached: dict[int, tuple[str, Transform, Transform]] = {}  # socket, pose in it, and what was shown last

    def attach(self, episode: EpisodeState, child_id: int, socket: str, pose: Transform) -> None:
        """Let an actor follow a socket of its parent from now on, at ``pose`` in the socket's frame."""
        self._attached[child_id] = (socket, pose, episode.actors.relative_transform(child_id))

    def follow(self, episode: EpisodeState) -> None:
        """Put every attached actor where its socket is now; called once a frame."""
        for child_id, (socket, pose, shown) in list(self._attached.items()):
            record = episode.actors.find(child_id)
            if record is None or record.parent_id not in episode.actors:
                del self._attached[child_id]
                continue
            if episode.actors.relative_transform(child_id) != shown:
                del self._attached[child_id]  # a client put it elsewhere on its parent, and there it stays
                continue
            episode.actors.place(child_id, in_parent(episode, record.parent_id, socket, pose))
            self._attached[child_id] = (socket, pose, episode.actors.relative_transform(child_id))


def in_parent(episode: EpisodeState, parent_id: int, socket: str, pose: Transform) -> Transform:
    """Return a pose in a socket's frame in the frame of the parent actor.

    Raises:
        Refusal: there is no such actor, or it has no such socket.
    """
    if parent_id not in episode.actors:
        raise Refusal(f"unable to attach actor: parent actor not found (no actor has id {parent_id})")
    sockets = sockets_of(episode, parent_id)
    if socket not in sockets.names:
        offered = f"it has {', '.join(sockets.names[:8])} …" if sockets.names else "it has none, attach without one"
        raise Refusal(f"unable to attach actor: the parent has no socket or bone '{socket}'; {offered}")
    return compose(transform_of(sockets.in_actor[sockets.names.index(socket)]), pose)
