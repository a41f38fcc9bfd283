"""RPC named tuples for actors, blueprints and their attributes. Source: ``carla/rpc/Actor*.h``."""

from typing import NamedTuple

from linden.protocol.values.space import BoundingBox


class ActorAttribute(NamedTuple):
    """One attribute of a blueprint; values are always text, ``type`` is an AttributeType."""

    id: str
    type: int
    value: str
    recommended_values: tuple[str, ...] = ()
    is_modifiable: bool = True
    restrict_to_recommended: bool = False


class ActorDefinition(NamedTuple):
    """A blueprint; ``tags`` are the words of the id, comma separated."""

    uid: int
    id: str
    tags: str
    attributes: tuple[ActorAttribute, ...]


class AttributeValue(NamedTuple):
    """One attribute with the value that a client chose at the spawn."""

    id: str
    type: int
    value: str


class ActorDescription(NamedTuple):
    """What to spawn: the blueprint and all its attributes, in any order."""

    uid: int
    id: str
    attributes: tuple[AttributeValue, ...] = ()

    def attribute(self, name: str, default: str = "") -> str:
        """Return the text of an attribute, ``default`` where the description lacks it."""
        return next((a.value for a in self.attributes if a.id == name), default)

    def number(self, name: str) -> float:
        """Return an attribute as a number, 0 where the description lacks it."""
        return float(self.attribute(name, "0"))

    def flag(self, name: str) -> bool:
        """Return whether an attribute is true; it is not where the description lacks it."""
        return self.attribute(name).lower() == "true"


class Actor(NamedTuple):
    """A living actor as the client learns of it; the box is local, the token empty or of 24 bytes."""

    id: int
    parent_id: int
    description: ActorDescription
    bounding_box: BoundingBox
    semantic_tags: bytes = b""
    stream_token: bytes = b""
