"""Write docs/reference/openscenario.md from the reader's tables: `make_openscenario_page.py [--check]`."""

from __future__ import annotations

import sys
from pathlib import Path

from generated_page import write_or_check

from basu_openscenario.playing.building import MAKERS
from basu_openscenario.reading import actions
from basu_openscenario.reading.action_reading import PRIVATE_ACTIONS
from basu_openscenario.reading.conditions import ENTITY_CONDITIONS, VALUE_CONDITIONS
from basu_openscenario.reading.entities import KINDS
from basu_openscenario.reading.global_action_reading import GLOBAL_ACTIONS
from basu_openscenario.reading.position_reading import POSITIONS, SHAPES
from basu_openscenario.reading.scenario_file import VERSIONS
from basu_openscenario.reading.traffic import FARTHEST_M, MOST_ACTIONS, MOST_PER_S, MOST_VEHICLES
from basu_openscenario.reading.traffic_reading import TRAFFIC_ACTIONS
from basu_openscenario.staging.refusals import REFUSED

PAGE = Path(__file__).parent.parent / "docs" / "reference" / "openscenario.md"
HEAD = """# OpenSCENARIO XML

<!-- written by scripts/make_openscenario_page.py -->

Files of OpenSCENARIO XML {versions} are played as cases of BASU. They need the distribution `basu-openscenario`.

```console
$ basu scenario run cut-in.xosc --agent my_agent.py
$ basu scenario run cut-in.xosc --agent my_agent.py --ego Ego --set EgoSpeed=80
$ basu scenario run cut-in.xosc
```

With `--agent`, the agent drives the entity that `--ego` names. By default that is the vehicle called Ego or hero,
else the first vehicle. It begins at the place and with the speed that the file gives it. Its route takes the roads
that the entity takes as written, in the lanes that continue its first lane. The file's actions on it have no effect,
and its conditions see where the agent drives it. All other entities move as written, by velocities that BASU sets in
each frame.

Without `--agent`, the ego moves as written as well. The id of such a case ends in `driver=file`.

The road network of the file is loaded into the server that BASU starts. A server at `--host` must have it: start it
with `linden serve --maps DIR`, or send it with `--upload-map`. The town is the name of the OpenDRIVE file.

Parameters of the file that are numbers or truth values are parameters of the case, for `--set`, `--sweep` and
`--grid`. Constraints of the file are their ranges. The verdict follows from BASU's policy and from contacts: the file
has no criteria.

If a file is broken, or asks for what is refused below, the command ends before a server starts. The message names
file, line and what to do. The drive ends with the storyboard. A storyboard without an end is played for a minute as
written, and a minute longer with an agent.

## Distributions of parameters

A file with a `ParameterValueDistribution` is a case for each of its runs. `basu scenario run DIST.xosc` plays them as
one batch, with workers, matrix and `--resume`. The cases are called `DIST-1`, `DIST-2` and so on.

- A deterministic file gives all combinations, the last parameter changing fastest. It may have sets, ranges with steps,
  and sets of values of several parameters.
- A stochastic file gives `numberOfTestRuns` draws by its `randomSeed`, 0 without one. It may have the normal,
  log-normal, uniform and Poisson distribution, a histogram, and values with weights. Each parameter has a generator
  of its own.
- `expectedValue` and `variance` of a log-normal distribution are its own moments, not those of the logarithm.
- A file may have up to 10,000 runs. Runs outside the constraints of the scenario are left out, and `basu scenario list`
  says how many.

## Traffic

Sources, sinks, swarms and areas bring vehicles into a file while it plays, and remove them. They are called
`traffic-1`, `traffic-2` and so on, and are in the record, in contacts and in the film like the entities of the file.

- **They follow their lane**, slow down before bends, and choose at junctions by chance. Each keeps its distance to
  what is on its way by the intelligent driver model, also to entities of the file and to the agent. They leave at the
  end of the road. They change no lanes, give no right of way at junctions, and do not obey lights.
- **Chance** comes from the seed of the drive (`--seed`). The same command gives the same traffic.
- **A source** brings its first vehicle at once. A vehicle appears where neither it nor another one has to brake
  harshly; without such a place it waits. With a radius below 5 m, vehicles appear in the lane nearest to the position.
- **A sink** removes vehicles of traffic alone. With a definition, it removes the categories of that definition.
- **A swarm** has up to its number of vehicles. They appear between the inner circle and the ellipse about the central
  object. The major axis is along the heading of that object. Vehicles outside of the ellipse are removed.
- **An area** is filled once, or is kept full if it is continuous. Vehicles that leave a continuous area are removed.
- **`TrafficStopAction`** ends the actions of its `trafficName`, or all of them without one. Their vehicles drive on.
  Otherwise an action ends with its act or with the storyboard.
- **Speeds** are those of the file, otherwise the posted ones, otherwise 50 km/h.
- **Vehicles** are those of `TrafficDistribution`, or of the categories, roles and controllers of `TrafficDefinition`,
  by their weights. Without both they are cars. The roles ambulance, fire and police have blueprints. All controllers
  drive alike; those of esmini are refused.
- **Bounds.** All swarms and areas of a file may ask for {vehicles} vehicles, and all of its traffic has no more at a
  time. A source or a sink may have {rate:g} vehicles/s. Radius, axes and offset may have {far:g} m. A file may have
  {actions} actions on traffic. Above these bounds, the file is refused.

## Trailers

The kinematic mode plays trailers. A trailer is an entity of its own, or it is described inside of its vehicle. In that
case its name is the vehicle's with a `+` behind. Actions connect and disconnect trailers. The axle of a trailer is
pulled towards the hitch and does not slip. The simulator refuses a file with a towed trailer, because bodies that
overlap would collide there.

## Cases for other players

`basu scenario export CASE -o case.xosc` writes a case of BASU as OpenSCENARIO XML 1.2, with its road beside it. esmini
plays the file, and so does `basu scenario run case.xosc`. It needs `pip install "basu-openscenario[export]"`.
With `--for scenario-runner`, it writes the case for [ScenarioRunner](../how-to/scenario-runner.md#cases-of-basu).

```console
$ basu scenario export pedestrian_crossing_1 -o case.xosc
$ basu scenario export all -o exported
$ esmini --osc case.xosc --traj_filter 0 --window 60 60 800 400
```

- **Triggers are conditions.** The others wait for the ego, whatever drives it. A distance along the ego's route is a
  `TraveledDistanceCondition`. No condition has a time along a route. A time to a place is a distance for each band of
  the ego's speed, 0.5 m/s wide.
- **Motions are trajectories with times.** They come from a rehearsal in which the ego drives 6 m/s and brakes for what
  is in its lane. After its trigger, an actor moves as in the rehearsal. It does not brake for the ego, and it does not
  vary its speed to meet the ego, as it does in BASU.
- **The ego** is called `hero` and follows its way of the rehearsal. Give it a controller of your own.
- The reference point of each entity is the middle of its box, as in CARLA.
- Lights are set by `TrafficSignalStateAction`. In the road file they have the country `OpenDRIVE`, as esmini asks.
- Weather and criteria are not written.

What has no counterpart is refused by its name, and the other cases are written. These are disturbances of the ego's
controls, friction of a part of the road and open doors. Triggers of a user's own class are refused as well.
The page of [exported cases](exported-cases.md) has their number, and the distances to esmini. Without `--traj_filter 0`
esmini merges points of a trajectory within 5 cm. An actor that starts slowly can then be 0.6 m off.
[The decision](../decisions/0129-export-of-cases.md) has the reasons.

## What is supported

Words of the tables:

- played: the simulator plays it.
- kinematic: only the kinematic mode plays it. [A table](esmini-files.md) compares that mode with esmini, file by file.
- noted: the storyboard and its conditions know it, and the simulator does not show it.
- refused: a file with it is refused by this name.
"""

PRIVATE = [
    "SpeedAction",
    "SpeedProfileAction",
    "LongitudinalDistanceAction",
    "LaneChangeAction",
    "LaneOffsetAction",
    "LateralDistanceAction",
    "VisibilityAction",
    "SynchronizeAction",
    "AssignControllerAction",
    "ActivateControllerAction",
    "OverrideControllerValueAction",
    "TeleportAction",
    "AssignRouteAction",
    "FollowTrajectoryAction",
    "AcquirePositionAction",
    "RandomRouteAction",
    "AnimationAction",
    "LightStateAction",
    "TrailerAction",
]
GLOBAL = [
    "EnvironmentAction",
    "EntityAction",
    "ParameterAction",
    "VariableAction",
    "TrafficSignalStateAction",
    "TrafficSignalControllerAction",
    "TrafficSourceAction",
    "TrafficSinkAction",
    "TrafficSwarmAction",
    "TrafficStopAction",
    "TrafficAreaAction",
    "SetMonitorAction",
    "CustomCommandAction",
]
ENTITY = [
    "EndOfRoadCondition",
    "CollisionCondition",
    "OffroadCondition",
    "TimeHeadwayCondition",
    "TimeToCollisionCondition",
    "AccelerationCondition",
    "StandStillCondition",
    "SpeedCondition",
    "RelativeSpeedCondition",
    "TraveledDistanceCondition",
    "ReachPositionCondition",
    "DistanceCondition",
    "RelativeDistanceCondition",
    "RelativeClearanceCondition",
    "AngleCondition",
    "RelativeAngleCondition",
]
VALUE = [
    "ParameterCondition",
    "VariableCondition",
    "SimulationTimeCondition",
    "StoryboardElementStateCondition",
    "TimeOfDayCondition",
    "UserDefinedValueCondition",
    "TrafficSignalCondition",
    "TrafficSignalControllerCondition",
]
POSITION = [
    "WorldPosition",
    "RelativeWorldPosition",
    "RelativeObjectPosition",
    "RoadPosition",
    "RelativeRoadPosition",
    "LanePosition",
    "RelativeLanePosition",
    "RoutePosition",
    "TrajectoryPosition",
    "GeoPosition",
]
SHAPE = ["Polyline", "Clothoid", "ClothoidSpline", "Nurbs"]
OBJECT = ["Vehicle", "Pedestrian", "MiscObject", "ExternalObjectReference"]
REMARKS = {
    "VisibilityAction": "played where it makes the entity visible for all",
    "EnvironmentAction": "noted in the init, where `--weather` sets the weather; kinematic elsewhere",
    "EntityAction": "`DeleteEntityAction` is played, `AddEntityAction` is kinematic",
    "AssignControllerAction": "active controllers of esmini are refused; those of the ego do not count",
    "ActivateControllerAction": "likewise",
    "LightStateAction": "lights of vehicles are not shown",
    "TrafficSignalStateAction": "a word such as `green`, or two or three lamps such as `off;off;on`",
    "TrailerAction": "connects and disconnects",
    "TrafficAreaAction": "a polygon, or ranges of roads",
    "LateralDistanceAction": "without `DynamicConstraints`",
    "MiscObject": "shown as a barrier or a cone",
}
NOTED = {"LightStateAction", "AssignControllerAction", "ActivateControllerAction"}
ALONE = {element for kind, element in REFUSED.items() if kind in MAKERS or kind is actions.EnvironmentAction}


GLOBALS = {**GLOBAL_ACTIONS, **TRAFFIC_ACTIONS}
del GLOBALS["TrafficAction"]  # it only contains one of the others


def page() -> str:
    """Return the page of what is supported as Markdown."""
    parts = [
        HEAD.format(
            versions=", ".join(VERSIONS),
            vehicles=MOST_VEHICLES,
            rate=MOST_PER_S,
            far=FARTHEST_M,
            actions=MOST_ACTIONS,
        )
    ]
    for title, names, read in (
        ("Private actions", PRIVATE, PRIVATE_ACTIONS),
        ("Global actions", GLOBAL, GLOBALS),
        ("Conditions of entities", ENTITY, ENTITY_CONDITIONS),
        ("Conditions of values", VALUE, VALUE_CONDITIONS),
        ("Positions", POSITION, POSITIONS),
        ("Shapes of trajectories", SHAPE, SHAPES),
        ("Entities", OBJECT, KINDS),
    ):
        unlisted = sorted(set(read) - set(names))
        assert not unlisted, f"{title} lacks {unlisted}; add them to the list in this file"
        rows = [f"| `{name}` | {_support(name, read)} | {REMARKS.get(name, '')} |" for name in names]
        parts.append("\n".join([f"## {title}\n", "| element | support | remark |", "|---|---|---|", *rows]) + "\n")
    parts.append(TAIL)
    return "\n".join(parts)


def _support(name: str, read: object) -> str:
    """Return the word for an element."""
    if name not in read:  # type: ignore[operator]
        return "refused"
    if name in ALONE:
        return "kinematic"
    return "noted" if name in NOTED else "played"


TAIL = """## Other parts

| part | support |
|---|---|
| parameters, expressions, variables, catalogs, `EntitySelection` | played |
| `TrafficSignalController` with phases, delay and reference | played |
| priorities, `maximumExecutionCount`, triggers with edges and delays | played |
| `selectTriggeringEntities="true"` | refused |
| `Trailer`, `TrailerHitch`, `TrailerCoupler` | kinematic |
| `TrafficDefinition`, `TrafficDistribution` | played |
| `ParameterValueDistribution` | a case for each run, see above |
| `UserDefinedDistribution` | refused |
| monitors | refused |

Decisions: [two modes](../decisions/0126-openscenario.md), [esmini as the judge](../decisions/0127-esmini.md),
[files of plugins as cases](../decisions/0128-files-of-plugins.md),
[traffic and trailers](../decisions/0181-traffic.md).
"""


if __name__ == "__main__":
    sys.exit(write_or_check(__file__, __doc__, lambda: {PAGE: page()}))
