"""Options of the conditions of a drive: seed, weather, vehicle and the simulator's own traffic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from basu.options.groups import CONDITIONS
from basu.settings.option import Option, Settings


@dataclass(frozen=True, kw_only=True)
class ConditionOptions(Settings):
    """The conditions of a drive, without SUMO."""

    seed: Annotated[
        int,
        Option(
            help="seed of everything random in the first repetition; each further one has the next",
            group=CONDITIONS,
            metavar="N",
        ),
    ] = 0
    weather: Annotated[
        str | None,
        Option(
            help="one of CARLA's presets",
            group=CONDITIONS,
            metavar="NAME",
            default_text="as the route or the agent says",
        ),
    ] = None
    vehicle: Annotated[
        str | None,
        Option(help="blueprint to drive", group=CONDITIONS, metavar="BLUEPRINT", default_text="as the agent says"),
    ] = None
    vehicles: Annotated[
        int,
        Option(
            help="other vehicles, driven by the Traffic Manager",
            group=CONDITIONS,
            metavar="N",
            least=0,
            rival="traffic",
        ),
    ] = 0
    traffic_density: Annotated[
        float | None,
        Option(
            help="other vehicles on a km of driving lane within 300 m of the route",
            group=CONDITIONS,
            metavar="N",
            unit="1/km",
            least=0.0,
            rival="traffic",
        ),
    ] = None
    walkers: Annotated[
        int, Option(help="walkers on the pavements near the route", group=CONDITIONS, metavar="N", least=0)
    ] = 0
    stop_after_s: Annotated[
        float | None,
        Option(
            help="end the drive after this simulated time; its score is not comparable",
            group=CONDITIONS,
            flag="--stop-after",
            metavar="S",
            unit="s",
            above=0.0,
            default_text="at the end of the route",
        ),
    ] = None
