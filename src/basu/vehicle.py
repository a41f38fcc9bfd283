"""The vehicle under test: made from its blueprint, put at the beginning of the route, and let come to rest."""

from __future__ import annotations

import contextlib
import difflib
from typing import TYPE_CHECKING

import carla

from basu.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from basu.routing import Route

ROLE = "hero"  # as the leaderboard and CARLA's replayer call the vehicle under test
DROP_M = 0.3  # above the road, so that no wheel begins inside of it
SETTLE_TICKS = 20  # from the drop to rest


@contextlib.contextmanager
def vehicle_at_start(world: carla.World, route: Route, blueprint_id: str) -> Iterator[carla.Vehicle]:
    """The vehicle at rest at the first point of ``route``; taken away afterwards.

    Raises:
        UserError: there is no such vehicle, or the place is taken.
    """
    blueprint = _blueprint(world.get_blueprint_library(), blueprint_id)
    blueprint.set_attribute("role_name", ROLE)
    pose = route.waypoints[0].transform
    pose.location.z += DROP_M
    try:
        vehicle = world.spawn_actor(blueprint, pose)
    except RuntimeError as error:
        raise UserError(f"{blueprint_id} cannot be put at the beginning of route '{route.id}': {error}") from error
    try:
        vehicle.apply_control(carla.VehicleControl(brake=1.0))
        for _ in range(SETTLE_TICKS):
            world.tick()
        yield vehicle
    finally:
        with contextlib.suppress(RuntimeError):  # where the simulator is gone, so is the vehicle
            vehicle.destroy()


def _blueprint(library: carla.BlueprintLibrary, blueprint_id: str) -> carla.ActorBlueprint:
    """A vehicle's blueprint by its whole id."""
    known = [blueprint.id for blueprint in library.filter("vehicle.*")]
    if blueprint_id not in known:
        close = difflib.get_close_matches(blueprint_id, known, 1)
        hint = f"did you mean '{close[0]}'?" if close else f"it has {', '.join(sorted(known))}"
        raise UserError(f"the simulator has no vehicle '{blueprint_id}'; {hint}")
    return library.find(blueprint_id)
