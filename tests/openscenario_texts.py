"""Small OpenSCENARIO files and a straight road, for tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

ROAD = """<?xml version="1.0"?>
<OpenDRIVE>
  <header revMajor="1" revMinor="6" name="straight" version="1.0" north="10" south="-10" east="1000" west="0"/>
  <road name="main" length="1000" id="1" junction="-1">
    <type s="0" type="town"><speed max="50" unit="km/h"/></type>
    <planView><geometry s="0" x="0" y="0" hdg="0" length="1000"><line/></geometry></planView>
    <elevationProfile/><lateralProfile/>
    <lanes>
      <laneSection s="0">
        <left><lane id="1" type="driving" level="false"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></left>
        <center><lane id="0" type="none" level="false"/></center>
        <right>
          <lane id="-1" type="driving" level="false"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>
          <lane id="-2" type="driving" level="false"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>
          <lane id="-3" type="sidewalk" level="false"><width sOffset="0" a="2" b="0" c="0" d="0"/></lane>
        </right>
      </laneSection>
    </lanes>
  </road>
</OpenDRIVE>
"""

VEHICLE = """<Vehicle name="{model}" vehicleCategory="car">
  <BoundingBox><Center x="1.4" y="0" z="0.9"/><Dimensions width="1.8" length="4.4" height="1.6"/></BoundingBox>
  <Performance maxSpeed="60" maxAcceleration="10" maxDeceleration="10"/>
  <Axles><FrontAxle maxSteering="0.5" wheelDiameter="0.6" trackWidth="1.6" positionX="2.7" positionZ="0.3"/>
    <RearAxle maxSteering="0" wheelDiameter="0.6" trackWidth="1.6" positionX="0" positionZ="0.3"/></Axles>
  <Properties/>
</Vehicle>"""


def vehicle(name: str, model: str = "car") -> str:
    """Return the element of a vehicle."""
    return f'<ScenarioObject name="{name}">{VEHICLE.format(model=model)}</ScenarioObject>'


def lane_position(s: object, lane: object = -1, offset: float = 0.0) -> str:
    """Return the element of a place in a lane of the straight road."""
    return f'<Position><LanePosition roadId="1" laneId="{lane}" s="{s}" offset="{offset}"/></Position>'


def begins(entity: str, s: object, speed: object, lane: object = -1) -> str:
    """Return the init actions of an entity: its place and its speed."""
    return f"""<Private entityRef="{entity}">
      <PrivateAction><TeleportAction>{lane_position(s, lane)}</TeleportAction></PrivateAction>
      <PrivateAction>{speed_action(speed)}</PrivateAction>
    </Private>"""


def speed_action(speed: object, shape: str = "step", value: object = 0, dimension: str = "time") -> str:
    """Return a change of speed."""
    return f"""<LongitudinalAction><SpeedAction>
      <SpeedActionDynamics dynamicsShape="{shape}" dynamicsDimension="{dimension}" value="{value}"/>
      <SpeedActionTarget><AbsoluteTargetSpeed value="{speed}"/></SpeedActionTarget>
    </SpeedAction></LongitudinalAction>"""


def lane_change(lane: object, seconds: object, shape: str = "sinusoidal") -> str:
    """Return a change to a lane."""
    return f"""<LateralAction><LaneChangeAction>
      <LaneChangeActionDynamics dynamicsShape="{shape}" dynamicsDimension="time" value="{seconds}"/>
      <LaneChangeTarget><AbsoluteTargetLane value="{lane}"/></LaneChangeTarget>
    </LaneChangeAction></LateralAction>"""


def at_time(seconds: object, rule: str = "greaterThan") -> str:
    """Return a trigger at a time."""
    return f"""<ConditionGroup><Condition name="at" delay="0" conditionEdge="none"><ByValueCondition>
      <SimulationTimeCondition value="{seconds}" rule="{rule}"/>
    </ByValueCondition></Condition></ConditionGroup>"""


def event(name: str, action: str, start: str = "") -> str:
    """Return an event with one private action."""
    return f"""<Event name="{name}" priority="parallel">
      <Action name="{name}Action"><PrivateAction>{action}</PrivateAction></Action>
      <StartTrigger>{start or at_time(0)}</StartTrigger>
    </Event>"""


def story(entity: str, *events: str) -> str:
    """Return a story in which one entity does events."""
    return f"""<Story name="story"><Act name="act"><ManeuverGroup name="group" maximumExecutionCount="1">
      <Actors selectTriggeringEntities="false"><EntityRef entityRef="{entity}"/></Actors>
      <Maneuver name="maneuver">{"".join(events)}</Maneuver>
    </ManeuverGroup><StartTrigger>{at_time(0, "greaterOrEqual")}</StartTrigger></Act></Story>"""


def scenario(
    *,
    entities: str = vehicle("Ego"),
    init: str = begins("Ego", 50, 10),
    stories: str = "",
    stop: object = 10,
    parameters: str = "",
    catalogs: str = "",
    revision: tuple[int, int] = (1, 2),
    road: str = "straight.xodr",
) -> str:
    """Return the text of a file; by default the ego drives along the straight road for ten seconds."""
    return f"""<?xml version="1.0"?>
<OpenSCENARIO>
  <FileHeader revMajor="{revision[0]}" revMinor="{revision[1]}" date="2026-01-01T00:00:00" author=""
    description="a test"/>
  <ParameterDeclarations>{parameters}</ParameterDeclarations>
  <CatalogLocations>{catalogs}</CatalogLocations>
  <RoadNetwork><LogicFile filepath="{road}"/></RoadNetwork>
  <Entities>{entities}</Entities>
  <Storyboard>
    <Init><Actions>{init}</Actions></Init>
    {stories}
    <StopTrigger>{at_time(stop)}</StopTrigger>
  </Storyboard>
</OpenSCENARIO>
"""


def written(folder: Path, text: str, name: str = "test.xosc") -> Path:
    """Write a file with the straight road beside it, and return its path."""
    (folder / "straight.xodr").write_text(ROAD, encoding="utf-8")
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path
