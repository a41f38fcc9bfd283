"""Options of the conditions of a drive: seed, weather, vehicle and the simulator's own traffic."""

from __future__ import annotations

from dataclasses import dataclass

from basu.settings.option import Settings, option


@dataclass(frozen=True, kw_only=True)
class ConditionOptions(Settings):
    """The conditions of a drive, without SUMO."""

    GROUP = "conditions"

    seed: int = option(0, "seed of everything random in the first repetition; each further one has the next")
    weather: str | None = option(
        None, "one of CARLA's presets", metavar="NAME", default_text="as the route or the agent says"
    )
    vehicle: str | None = option(None, "blueprint to drive", metavar="BLUEPRINT", default_text="as the agent says")
    vehicles: int = option(0, "other vehicles, driven by the Traffic Manager", least=0, rival="traffic")
    traffic_density: float | None = option(
        None,
        "other vehicles on a km of driving lane within 300 m of the route",
        unit="1/km",
        least=0.0,
        rival="traffic",
    )
    walkers: int = option(0, "walkers on the pavements near the route", least=0)
    stop_after_s: float | None = option(
        None,
        "end the drive after this simulated time; its score is not comparable",
        above=0.0,
        default_text="at the end of the route",
    )
    repetitions: int = option(1, "drives of each route or case", least=1)
