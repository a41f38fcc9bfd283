"""A town of one straight road to the east with one lane, as the official client reads it without any server."""

import carla

from basu.routing import Route, plan
from basu.routing.route_file import RouteDescription, RoutePoint

OPENDRIVE = """<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4" name="OneRoad">
<geoReference><![CDATA[+proj=tmerc +lat_0=39.99 +lon_0=-82.98 +k=1 +ellps=WGS84]]></geoReference></header>
<road name="r" length="50.0" id="1" junction="-1"><planView><geometry s="0.0" x="0.0" y="0.0" hdg="0.0" length="50.0">
<line/></geometry></planView><lanes><laneSection s="0.0"><center><lane id="0" type="none" level="false"/></center>
<right><lane id="-1" type="driving" level="false"><width sOffset="0.0" a="3.5" b="0.0" c="0.0" d="0.0"/></lane></right>
</laneSection></lanes></road></OpenDRIVE>"""


def one_road() -> carla.Map:
    """The town's map."""
    return carla.Map("OneRoad", OPENDRIVE)


def way_along(town: carla.Map) -> Route:
    """40 m along the road, in the middle of its lane."""
    points = (RoutePoint(2.0, 1.75, 0.0), RoutePoint(42.0, 1.75, 0.0))
    return plan(town, RouteDescription(id="1", town="OneRoad", points=points, stops=(), source="nowhere"))
