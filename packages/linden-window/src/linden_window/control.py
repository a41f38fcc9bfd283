"""Orders of pages that change a running world: pause, step, speed, weather, spawn, send, destroy."""

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from linden.blueprints.library import BlueprintKind
from linden.errors import Refusal
from linden.protocol.values.actors import ActorDescription, AttributeValue
from linden.protocol.values.enums import AttributeType
from linden.protocol.values.episode import WeatherParameters
from linden.protocol.values.space import Rotation, Transform, Vector3D
from linden.server.rpc import scene

if TYPE_CHECKING:
    from linden.server.frame_clock import FrameClock
    from linden.server.rpc.context import Context
    from linden_window.errands import Errands

    _Action = Callable[[dict[str, Any], Context, FrameClock], str]

SLOWEST, FASTEST = 0.1, 8.0
_ABOVE_M = 0.3
"""How far above the clicked ground a vehicle is spawned, so that its wheels are not in it."""


def carry_out(order: dict[str, Any], context: "Context", clock: "FrameClock", errands: "Errands") -> str:
    """Carry out an order; return a sentence for the pages, "" if there is nothing to say."""
    if order["order"] == "send":
        action: _Action | None = partial(_send, errands)
    else:
        action = _ACTIONS.get(order["order"])
    if action is None:
        return ""
    try:
        return action(order, context, clock)
    except Refusal as refusal:
        return str(refusal)
    except (IndexError, KeyError, TypeError, ValueError) as error:
        return f"The page sent an order that cannot be read ({error!r}); load it again."


def _refuse_in_synchronous_mode(context: "Context", action: str) -> None:
    """Raise Refusal where clients tick the world; ``action`` is what the page wants to do with the time."""
    if context.world.settings.synchronous_mode:
        raise Refusal(f"A client decides when time passes (synchronous mode), so the page {action}.")


def _pause(order: dict[str, Any], context: "Context", clock: "FrameClock") -> str:
    _refuse_in_synchronous_mode(context, "can neither pause nor step")
    clock.is_paused = bool(order["on"])
    return "The world is paused." if clock.is_paused else "The world goes on."


def _step(_order: dict[str, Any], context: "Context", clock: "FrameClock") -> str:
    _refuse_in_synchronous_mode(context, "can neither pause nor step")
    clock.is_paused = True
    clock.one_step()
    return ""


def _speed(order: dict[str, Any], context: "Context", clock: "FrameClock") -> str:
    _refuse_in_synchronous_mode(context, "cannot set the speed")
    wanted = _number(order["value"])
    clock.speed = min(FASTEST, max(SLOWEST, wanted))
    return f"The world runs at {clock.speed:g} times real time."


def _weather(order: dict[str, Any], context: "Context", _clock: "FrameClock") -> str:
    values = {name: _number(order["values"][name]) for name in WeatherParameters._fields if name in order["values"]}
    scene.set_weather_parameters(context, context.world.episode.weather._replace(**values))
    context.frame_is_due = True
    return ""


def _spawn(order: dict[str, Any], context: "Context", _clock: "FrameClock") -> str:
    blueprint = context.world.library.find(str(order["type"]))
    if blueprint.kind not in (BlueprintKind.VEHICLE, BlueprintKind.WALKER, BlueprintKind.PROP):
        return f"{order['type']} cannot be spawned with a click; choose a vehicle, a walker or a prop."
    x, y = (_number(value) for value in order["place"][:2])
    above = order["place"][2]  # a click on a map in two dimensions names no height
    heights, _ = context.world.episode.map.ground.surfaces_under([[x, y, 0.0]])
    z = float(heights[0]) if above is None else _number(above)
    above_m = _ABOVE_M + (blueprint.box.extent.z if blueprint.kind is BlueprintKind.WALKER else 0.0)
    place = Transform(Vector3D(x, y, z + above_m), Rotation(0.0, _number(order["yaw"]), 0.0))
    role = AttributeValue("role_name", AttributeType.STRING, "window")
    record = context.world.spawn(ActorDescription(blueprint.definition.uid, blueprint.definition.id, (role,)), place)
    context.frame_is_due = True
    return f"{blueprint.definition.id} is spawned; its id is {record.id}."


def _destroy(order: dict[str, Any], context: "Context", _clock: "FrameClock") -> str:
    context.world.destroy(int(order["id"]))
    context.frame_is_due = True
    return f"Actor {int(order['id'])} is destroyed."


def _send(errands: "Errands", order: dict[str, Any], context: "Context", _clock: "FrameClock") -> str:
    """Send an actor along the way that the process of the pages has found."""
    errands.send(int(order["id"]), np.array([[_number(value) for value in point] for point in order["way"]]))
    context.frame_is_due = True
    return f"Actor {int(order['id'])} is on its way."


def _number(value: object) -> float:
    number = float(value)  # type: ignore[arg-type] # what is no number raises TypeError
    if not math.isfinite(number):
        raise ValueError(f"{value!r} is no finite number")
    return number


_ACTIONS: "dict[str, _Action]" = {
    "pause": _pause,
    "step": _step,
    "speed": _speed,
    "weather": _weather,
    "spawn": _spawn,
    "destroy": _destroy,
}
