"""Traffic lights and signs as actors of the world: made from the map's signals, never spawned."""

from collections import defaultdict
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from linden.blueprints.library import DOT
from linden.geometry import compose
from linden.maps.opendrive.roadside import SPEED_LIMIT_TYPE, STOP_SIGN_TYPE, YIELD_SIGN_TYPE, Controller
from linden.maps.records import PlacedSignal
from linden.protocol.values.enums import SemanticTag, TrafficLightState
from linden.protocol.values.space import BoundingBox, Transform
from linden.structured import StructuredArray
from linden.traffic.cycle import RED_OF_A_SINGLE_LIGHT_S, TIMES_S, LightPlan, plan
from linden.traffic.signs import SignRules, sign_rules
from linden.traffic.trigger_volumes import TriggerGrid, trigger_grid

NO_LIGHT = -1

PAINTED = "Stencil_STOP"
"""Name of a stop only painted on the road; CARLA makes no actor of it (TrafficLightManager.cpp, SpawnSignals)."""


class TrafficActor(NamedTuple):
    """A light or a sign.

    ``volumes`` are local, x across the lanes, one for each approach; ``box``, the first of them, is what the client
    calls the trigger volume. Where the signal concerns no lane it is a dot. ``light`` counts the lights; it is
    ``NO_LIGHT`` for a sign.
    """

    type_id: str
    sign_id: str
    transform: Transform
    box: BoundingBox
    volumes: tuple[BoundingBox, ...]
    semantic_tags: bytes
    light: int = NO_LIGHT


class Signals(NamedTuple):
    """What the signals of a map come to; nothing in it ever changes, so every episode on the map begins with the same.

    Attributes:
        actors: every light, then every sign, limits after the others, each in the order of the map.
        plan: which lights change together.
        grid: where a vehicle is under which light.
        rules: the zones of stop and yield signs, and the squares to give way to.
    """

    actors: tuple[TrafficActor, ...]
    plan: LightPlan
    grid: TriggerGrid
    rules: SignRules

    @staticmethod
    def of(placed: Sequence[PlacedSignal], controllers: Sequence[Controller], give_way: StructuredArray) -> "Signals":
        """Make the actors of a map's signals; ``controllers`` and ``give_way`` stand in the order of the file."""
        lights = [signal for signal in placed if signal.is_light]
        signs = [signal for signal in placed if not signal.is_light and signal.name != PAINTED]
        signs.sort(key=lambda signal: signal.type == SPEED_LIMIT_TYPE)  # limits last: they come and go with the survey
        actors = (
            *(_actor(signal, light) for light, signal in enumerate(lights)),
            *(_actor(signal, NO_LIGHT) for signal in signs),
        )
        return Signals(
            actors,
            _plan(lights, controllers),
            trigger_grid(_world_volumes(actors[: len(lights)])),
            _rules(placed, give_way),
        )


def _rules(placed: Sequence[PlacedSignal], give_way: StructuredArray) -> SignRules:
    """Number the stop and yield signs as they stand in the file; one only painted on the road has no effect."""
    kinds = (STOP_SIGN_TYPE, YIELD_SIGN_TYPE)
    numbered = [nth for nth, signal in enumerate(placed) if signal.type in kinds and signal.name != PAINTED]
    signs = [_actor(placed[nth], NO_LIGHT) for nth in numbered]
    first, behind = (np.searchsorted(give_way["signal"], numbered, side) for side in ("left", "right"))
    return sign_rules(
        trigger_grid(_world_volumes(signs)),
        np.array([placed[nth].type == STOP_SIGN_TYPE for nth in numbered], bool),
        [give_way[begin:end] for begin, end in zip(first, behind, strict=True)],
    )


def _world_volumes(actors: Sequence[TrafficActor]) -> list[tuple[int, BoundingBox]]:
    """Return the volumes of all actors as boxes in the world, each with the number of its actor."""
    return [
        (number, _in_world(actor.transform, volume)) for number, actor in enumerate(actors) for volume in actor.volumes
    ]


def _in_world(transform: Transform, volume: BoundingBox) -> BoundingBox:
    pose = compose(transform, Transform(volume.location, volume.rotation))
    return BoundingBox(pose.location, volume.extent, pose.rotation)


def _actor(signal: PlacedSignal, light: int) -> TrafficActor:
    tag = SemanticTag.TRAFFIC_SIGNS if light == NO_LIGHT else SemanticTag.TRAFFIC_LIGHT
    return TrafficActor(
        type_id=_type_id(signal),
        sign_id=signal.signal_id,
        transform=signal.transform,
        box=signal.trigger_volumes[0] if signal.trigger_volumes else DOT,
        volumes=signal.trigger_volumes,
        semantic_tags=bytes([tag]),
        light=light,
    )


def _type_id(signal: PlacedSignal) -> str:
    """Return CARLA's name; that of a speed limit ends in the number on the sign, whatever its unit."""
    if signal.is_light:
        return "traffic.traffic_light"
    if signal.type == SPEED_LIMIT_TYPE and (signal.value is not None or signal.subtype.isdigit()):
        return f"traffic.speed_limit.{signal.value if signal.value is not None else int(signal.subtype):g}"
    return {STOP_SIGN_TYPE: "traffic.stop", YIELD_SIGN_TYPE: "traffic.yield"}.get(signal.type, "traffic.unknown")


def _plan(lights: list[PlacedSignal], controllers: Sequence[Controller]) -> LightPlan:
    """Group the lights as CARLA's TrafficLightManager does: by their first controller, and controllers by junction.

    Controllers take turns in their ``sequence``, then as they stand in the file. A light without controller is alone.
    """
    rank = {item.id: (item.sequence, order) for order, item in enumerate(controllers)}
    members: dict[str, list[int]] = defaultdict(list)
    junction: dict[str, str] = {}
    for light, signal in enumerate(lights):
        controller = signal.controllers[0] if signal.controllers else f"light {signal.signal_id}"
        members[controller].append(light)
        in_junction = signal.controllers and signal.junction_id >= 0
        junction[controller] = f"junction {signal.junction_id}" if in_junction else controller
    groups: dict[str, list[str]] = defaultdict(list)
    for controller in members:
        groups[junction[controller]].append(controller)
    turns = [sorted(group, key=lambda name: rank.get(name, (0, 0))) for group in groups.values()]
    times_s = np.array([TIMES_S] * len(members)).reshape(len(members), 3)
    alone = [name not in rank for group in turns for name in group]
    times_s[alone, TrafficLightState.RED] = RED_OF_A_SINGLE_LIGHT_S
    return plan([[members[name] for name in group] for group in turns], times_s)
