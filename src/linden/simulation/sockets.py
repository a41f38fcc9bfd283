"""Actors attached to a bone or socket of their parent: every frame they go where it goes."""

from typing import TYPE_CHECKING

from linden.errors import Refusal
from linden.geometry import compose
from linden.simulation.bones import sockets_of
from linden.values.space import Transform
from linden.world.skeleton import transform_of

if TYPE_CHECKING:
    from linden.simulation.episode import Episode


class Sockets:
    """Who is attached where, by the child's actor id."""

    def __init__(self) -> None:
        self._attached: dict[int, tuple[str, Transform, Transform]] = {}  # socket, pose in it, and what was shown last

    def attach(self, episode: "Episode", child_id: int, socket: str, pose: Transform) -> None:
        """Let an actor follow a socket of its parent from now on, at ``pose`` in the socket's frame."""
        self._attached[child_id] = (socket, pose, episode.actors.relative_transform(child_id))

    def follow(self, episode: "Episode") -> None:
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


def in_parent(episode: "Episode", parent_id: int, socket: str, pose: Transform) -> Transform:
    """Return a pose in a socket's frame in that of the actor whose socket it is.

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
