"""`WorldObserver`: packs each frame of a running world for the pages, and facts when they change."""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from linden.blueprints.library import BlueprintKind
from linden.protocol.values.debug_shapes import Arrow, Box, HudArrow, HudBox, HudLine, HudPoint, Line, Point, Text
from linden.protocol.values.snapshot import VEHICLE_ROW
from linden.scenery.scene.debug_shapes import KeptShape
from linden.simulation.actor_table import NO_BODY, ActorRecord
from linden_window import poses
from linden_window.link import PageLink
from linden_window.poses import POSE

if TYPE_CHECKING:
    from linden.world import World

_SHOWN = (BlueprintKind.VEHICLE, BlueprintKind.WALKER, BlueprintKind.PROP, BlueprintKind.SENSOR)
MOST_SHAPES = 2000
"""More debug shapes a frame than this are not sent: encoding them would take longer than the tick."""
_SHORT_MPS = 327.0
_CHOICES = ("driver_id", "use_wheelchair")


class WorldObserver:
    """Sends a world's frames over a link, only while there are pages."""

    def __init__(self, world: "World", link: PageLink) -> None:
        self._world, self._link = world, link
        self._episode: object = None
        self._pages = 0
        self._forget()

    def _forget(self) -> None:
        """Send every fact anew with the next frame."""
        self._version = -1
        self._told: dict[str, object] = {}
        self._drawn, self._cleared = 0, -1

    def has_pages(self, count: int) -> None:
        """Note how many pages there are; a new one gets the present state at once."""
        is_new, self._pages = count > self._pages, count
        if is_new:
            self._forget()
            self.after_frame()

    def after_frame(self) -> None:
        """Send the frame that the world has just made, and what has changed with it."""
        world = self._world
        jumps = self._episode is not world.episode
        if jumps:
            self._episode = world.episode
            self._link.note({"type": "map", "name": world.episode.map.name, "text": world.opendrive_text})
            self._forget()
        if not self._pages:
            return
        if not self._link.is_behind:
            self._facts()
            self._link.frame(poses.message(world.frame, world.elapsed_s, self._packed(), jumps=jumps))
        else:
            self._link.miss()

    # -- facts that seldom change ---------------------------------------------------------------------------------

    def _facts(self) -> None:
        episode = self._world.episode
        if self._version != episode.actors.version:
            self._survey()
        lamps = episode.surroundings.lamps
        self._tell("weather", episode.weather, lambda: {"weather": episode.weather._asdict()})
        colours = episode.traffic.state.colour
        self._tell("lights", colours.tobytes(), lambda: {"states": colours.tolist()})
        self._tell("lamps", lamps.changes, lambda: {"lamps": [(int(s.active), *s.color) for s in lamps.states()]})
        settings = self._world.settings
        self._tell("settings", settings, lambda: {"synchronous": settings.synchronous_mode})
        self._shapes(episode.surroundings.debug)

    def _tell(self, kind: str, value: object, note: Any) -> None:  # noqa: ANN401 - a function without arguments
        if self._told.get(kind, self) != value:
            self._told[kind] = value
            self._link.note({"type": kind, **note()})

    def _survey(self) -> None:
        """Note the rows of the actors that are shown, and send what they are."""
        episode = self._world.episode
        actors = episode.actors
        self._records = [r for r in actors if r.kind in _SHOWN or r.id == episode.spectator_id]
        self._rows = np.array([actors.row(record.id) for record in self._records], np.intp)
        vehicles = [i for i, r in enumerate(self._records) if r.kind is BlueprintKind.VEHICLE and r.slot != NO_BODY]
        self._vehicles = np.array(vehicles, np.intp)
        self._rows_of_vehicles = self._rows[self._vehicles]
        self._lit = [self._records[index] for index in vehicles]
        self._slots = np.array([record.slot for record in self._lit], np.intp)
        self._walkers = [(i, r.id) for i, r in enumerate(self._records) if r.kind is BlueprintKind.WALKER]
        self._out = np.zeros(len(self._records), POSE)
        self._out["id"] = [record.id for record in self._records]
        self._version = actors.version
        spectator = episode.spectator_id
        self._link.note({"type": "actors", "spectator": spectator, "actors": [_described(r) for r in self._records]})

    # -- poses ----------------------------------------------------------------------------------------------------

    def _packed(self) -> NDArray[Any]:
        """Return the rows of this frame."""
        episode, out, rows = self._world.episode, self._out, self._rows
        actors = episode.actors
        pose = actors.pose[rows]
        out["place"] = pose[:, :3]
        out["rotation"] = poses.turns(pose[:, 3:])
        velocity = actors.rows["velocity"][rows]
        out["speed"] = np.minimum(np.sqrt(np.einsum("ij,ij->i", velocity, velocity)), _SHORT_MPS) * 100.0
        if len(self._vehicles):
            at, state, of = self._vehicles, actors.rows.view(VEHICLE_ROW), self._rows_of_vehicles
            out["lights"][at] = [record.light_state & 0xFFFF for record in self._lit]
            steer = episode.bodies.wheel_steer[self._slots, 0] * 100.0
            out["steer"][at] = np.maximum(np.minimum(steer, 127.0), -127.0)
            out["throttle"][at] = state["throttle"][of] * 255.0
            out["brake"][at] = state["brake"][of] * 255.0
            limit = state["speed_limit"][of]
            out["limit"][at] = np.where(limit > 0.0, np.minimum(limit, 255.0), 0.0)  # nan is no limit
            out["state"][at] = state["reverse"][of] * np.uint8(poses.REVERSES)
        dead = [index for index, actor_id in self._walkers if episode.walkers.is_dead(actor_id)]
        if dead:
            out["state"][dead] = poses.DEAD
        return out

    # -- world.debug ----------------------------------------------------------------------------------------------

    def _shapes(self, debug: Any) -> None:  # noqa: ANN401 - DebugShapes of the scenery
        """Send the shapes that were drawn since the last frame, or all of them after a clearing."""
        if debug.cleared != self._cleared:
            new, reset = list(debug.shapes), True
        else:
            count = debug.drawn - self._drawn
            new, reset = (list(debug.shapes[-count:]) if count else []), False
        self._drawn, self._cleared = debug.drawn, debug.cleared
        if new or reset:
            dropped = max(0, len(new) - MOST_SHAPES)
            shapes = [_shape(kept) for kept in new[-MOST_SHAPES:]]
            self._link.note({"type": "debug", "reset": reset, "dropped": dropped, "shapes": shapes})


def _described(record: ActorRecord) -> dict[str, Any]:
    """Return what the page needs to know of an actor."""
    about = record.description
    box = record.box
    chosen = next((value for name in _CHOICES if (value := about.attribute(name))), "")
    return {
        "id": record.id,
        "type": about.id,
        "choice": chosen,
        "kind": record.kind.name.lower(),
        "parent": record.parent_id,
        "role": about.attribute("role_name", ""),
        "colour": [int(part) for part in about.attribute("color", "128,128,128").split(",")],
        "box": [*box.location, *box.extent],
        "fov": about.attribute("fov", ""),
    }


def _shape(kept: KeptShape) -> dict[str, Any]:
    shape = kept.shape
    primitive = shape.primitive
    made: dict[str, Any] = {
        "colour": list(shape.color),
        "until": kept.until_s if math.isfinite(kept.until_s) else None,
    }
    if isinstance(primitive, Text):
        return made | {"form": "text", "at": list(primitive.location), "text": primitive.text[:200]}
    if isinstance(primitive, Point | HudPoint):
        return made | {"form": "point", "at": list(primitive.location), "size": primitive.size}
    if isinstance(primitive, Line | HudLine):
        return made | {
            "form": "line",
            "from": list(primitive.begin),
            "to": list(primitive.end),
            "width": primitive.thickness,
        }
    if isinstance(primitive, Arrow | HudArrow):
        line = primitive.line
        return made | {
            "form": "arrow", "from": list(line.begin), "to": list(line.end), "width": line.thickness,
            "tip": primitive.arrow_size,
        }  # fmt: skip
    assert isinstance(primitive, Box | HudBox)
    return made | {
        "form": "box", "at": list(primitive.box.location), "half": list(primitive.box.extent),
        "rotation": list(primitive.rotation), "width": primitive.thickness,
    }  # fmt: skip
