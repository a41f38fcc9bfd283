"""Elements of actions on traffic, for tests."""

from __future__ import annotations

from openscenario_texts import lane_position


def traffic_action(inside: str, name: str = "") -> str:
    """Return the XML of a global action on traffic."""
    named = f' trafficName="{name}"' if name else ""
    return f"<GlobalAction><TrafficAction{named}>{inside}</TrafficAction></GlobalAction>"


def source(
    s: object,
    *,
    lane: object = -1,
    rate: object = 1,
    radius: object = 0,
    speed: object = 10,
    mix: str = "",
    name: str = "in",
) -> str:
    """Return a source of vehicles in a lane of the straight road."""
    given = "" if speed is None else f' speed="{speed}"'
    position = lane_position(s, lane)
    return traffic_action(
        f'<TrafficSourceAction radius="{radius}" rate="{rate}"{given}>{position}{mix}</TrafficSourceAction>', name
    )


def sink(s: object, *, lane: object = -1, rate: object = None, radius: object = 10, mix: str = "") -> str:
    """Return the XML of a sink that removes vehicles."""
    given = "" if rate is None else f' rate="{rate}"'
    return traffic_action(
        f'<TrafficSinkAction radius="{radius}"{given}>{lane_position(s, lane)}{mix}</TrafficSinkAction>', "out"
    )


def swarm(
    entity: str,
    *,
    count: object = 10,
    inner: object = 20,
    major: object = 100,
    minor: object = 50,
    offset: object = 0,
    velocity: object = None,
    speeds: tuple[object, object] | None = None,
    directions: tuple[object, object] | None = None,
    mix: str = "",
) -> str:
    """Return the XML of a swarm of vehicles around an entity."""
    given = "" if velocity is None else f' velocity="{velocity}"'
    limits = "" if speeds is None else f'<InitialSpeedRange lowerLimit="{speeds[0]}" upperLimit="{speeds[1]}"/>'
    ways = ""
    if directions is not None:
        ways = f'<DirectionOfTravelDistribution same="{directions[0]}" opposite="{directions[1]}"/>'
    return traffic_action(
        f'<TrafficSwarmAction innerRadius="{inner}" semiMajorAxis="{major}" semiMinorAxis="{minor}" '
        f'numberOfVehicles="{count}" offset="{offset}"{given}><CentralObject entityRef="{entity}"/>'
        f"{mix}{limits}{ways}</TrafficSwarmAction>",
        "swarm",
    )


def polygon(*corners: tuple[object, object]) -> str:
    """Return a polygon of points of the world."""
    inside = "".join(f'<Position><WorldPosition x="{x}" y="{y}"/></Position>' for x, y in corners)
    return f"<Polygon>{inside}</Polygon>"


def area(inside: str, *, count: object = 5, continuous: object = True) -> str:
    """Return the traffic of an area: a polygon, or ranges of roads."""
    return traffic_action(
        f'<TrafficAreaAction numberOfEntities="{count}" continuous="{str(continuous).lower()}">'
        f"<TrafficArea>{inside}</TrafficArea></TrafficAreaAction>",
        "area",
    )


def stop(name: str) -> str:
    """Return the end of actions on traffic."""
    return traffic_action("<TrafficStopAction/>", name)


def categories(
    roles: dict[str, object] | None = None, controllers: tuple[str, ...] | list[str] = ("driver",), **weights: object
) -> str:
    """Return a definition of traffic by categories with their weights."""
    shares = "".join(
        f'<VehicleCategoryDistributionEntry category="{one}" weight="{weight}"/>' for one, weight in weights.items()
    )
    uses = "".join(
        f'<VehicleRoleDistributionEntry role="{one}" weight="{weight}"/>' for one, weight in (roles or {}).items()
    )
    drivers = "".join(
        f'<ControllerDistributionEntry weight="1"><Controller name="{one}"><Properties/></Controller>'
        "</ControllerDistributionEntry>"
        for one in controllers
    )
    return f"""<TrafficDefinition name="mix">
      <VehicleCategoryDistribution>{shares}</VehicleCategoryDistribution>
      {f"<VehicleRoleDistribution>{uses}</VehicleRoleDistribution>" if roles else ""}
      <ControllerDistribution>{drivers}</ControllerDistribution></TrafficDefinition>"""
