"""Small OpenDRIVE texts for tests: one road of any shape, and a street through a junction, with slots for more."""

GEO_REFERENCE = "+proj=tmerc +lat_0=40 +lon_0=-83 +datum=WGS84"
PLAIN_ROAD = """<?xml version="1.0" standalone="yes"?>
<OpenDRIVE>
  <header revMajor="1" revMinor="4" name="Plain" north="0" south="0" east="200" west="0">
    <geoReference><![CDATA[+proj=tmerc +lat_0=39.68 +lon_0=-104.96]]></geoReference>
  </header>
  <road name="Only Street" length="200.0" id="1" junction="-1">
    <planView><geometry s="0.0" x="0.0" y="0.0" hdg="0.0" length="200.0"><line/></geometry></planView>
    <elevationProfile><elevation s="0.0" a="0.0" b="0.0" c="0.0" d="0.0"/></elevationProfile>
    <lanes>
      <laneSection s="0.0">
        <left><lane id="1" type="driving" level="false"><width sOffset="0.0" a="3.5" b="0.0" c="0.0" d="0.0"/>
          <roadMark sOffset="0.0" type="solid" weight="standard" color="standard" width="0.12" laneChange="none"/>
        </lane></left>
        <center><lane id="0" type="none" level="false">
          <roadMark sOffset="0.0" type="broken" weight="standard" color="yellow" width="0.12" laneChange="none"/>
        </lane></center>
        <right><lane id="-1" type="driving" level="false"><width sOffset="0.0" a="3.5" b="0.0" c="0.0" d="0.0"/>
          <roadMark sOffset="0.0" type="solid" weight="standard" color="standard" width="0.12" laneChange="none"/>
        </lane></right>
      </laneSection>
    </lanes>
  </road>
</OpenDRIVE>
"""
LANE_MARK = '<roadMark sOffset="0" type="broken" color="white" width="0.12" laneChange="none"/>'
CENTRE = f'<center><lane id="0" type="none" level="false">{LANE_MARK}</lane></center>'


def opendrive(*parts: str, geo_reference: str = GEO_REFERENCE) -> str:
    header = f'<header revMajor="1" revMinor="4" name="Test"><geoReference>{geo_reference}</geoReference></header>'
    return f'<?xml version="1.0"?>\n<OpenDRIVE>\n{header}\n' + "\n".join(parts) + "\n</OpenDRIVE>"


def line(s: float, x: float, y: float, heading: float, length: float, shape: str = "<line/>") -> str:
    return f'<geometry s="{s!r}" x="{x!r}" y="{y!r}" hdg="{heading!r}" length="{length!r}">{shape}</geometry>'


def lane(
    lane_id: int, kind: str = "driving", width: float = 3.5, link: str = "", more: str = "", widths: str = ""
) -> str:
    widths = widths or f'<width sOffset="0" a="{width}" b="0" c="0" d="0"/>'
    return f'<lane id="{lane_id}" type="{kind}" level="false"><link>{link}</link>{widths}{LANE_MARK}{more}</lane>'


def section(s: float = 0.0, left: str = "", right: str = "") -> str:
    sides = (f"<left>{left}</left>" if left else "") + CENTRE + (f"<right>{right}</right>" if right else "")
    return f'<laneSection s="{s!r}">{sides}</laneSection>'


def road(
    road_id: int,
    length: float,
    plan: str,
    sections: str,
    *,
    junction: int = -1,
    link: str = "",
    elevation: str = "",
    offsets: str = "",
    more: str = "",
    speed: str = '<type s="0" type="town"><speed max="25" unit="mph"/></type>',
    rule: str = "RHT",
) -> str:
    return (
        f'<road name="Street {road_id}" length="{length!r}" id="{road_id}" junction="{junction}" rule="{rule}">\n'
        f"<link>{link}</link>{speed}<planView>{plan}</planView>"
        f"<elevationProfile>{elevation}</elevationProfile>\n<lanes>{offsets}{sections}</lanes>{more}</road>"
    )


def touches(end: str, kind: str, element_id: int, contact: str = "") -> str:
    contact = f' contactPoint="{contact}"' if contact else ""
    return f'<{end} elementType="{kind}" elementId="{element_id}"{contact}/>'


def follows(predecessor: int | None = None, successor: int | None = None) -> str:
    before = "" if predecessor is None else f'<predecessor id="{predecessor}"/>'
    return before + ("" if successor is None else f'<successor id="{successor}"/>')


def signal(
    signal_id: str,
    s: float,
    t: float,
    kind: str = "206",
    *,
    lanes: str = '<validity fromLane="-1" toLane="-1"/>',
    more: str = "",
) -> str:
    return (
        f'<signal name="sign {signal_id}" id="{signal_id}" s="{s}" t="{t}" zOffset="0" hOffset="0" pitch="0" roll="0" '
        f'orientation="+" dynamic="{"yes" if kind == "1000001" else "no"}" country="US" type="{kind}" subtype="-1" '
        f'value="-1" {more}>{lanes}</signal>'
    )


def street_through_junction(signals: str = "", objects: str = "", more: str = "", controllers: str = "") -> str:
    """Road 1 runs 50 m east, junction 100 takes 20 m, road 2 runs on for 60 m; one lane and a pavement each way."""
    pavement = '<height sOffset="0" inner="0.15" outer="0.15"/>'
    lanes = {
        "left": lane(2, "sidewalk", 1.5, more=pavement) + lane(1),
        "right": lane(-1) + lane(-2, "sidewalk", 1.5, more=pavement),
    }
    furniture = f"<objects>{objects}</objects><signals>{signals}</signals>"
    west = road(
        1, 50.0, line(0, 0, 0, 0, 50), section(**lanes), link=touches("successor", "junction", 100), more=furniture
    )
    east = road(2, 60.0, line(0, 70, 0, 0, 60), section(**lanes), link=touches("predecessor", "junction", 100))
    eastward = road(
        10,
        20.0,
        line(0, 50, 0, 0, 20),
        section(right=lane(-1, link=follows(-1, -1))),
        junction=100,
        link=touches("predecessor", "road", 1, "end") + touches("successor", "road", 2, "start"),
    )
    westward = road(
        11,
        20.0,
        line(0, 70, 0, 3.141592653589793, 20),
        section(right=lane(-1, link=follows(1, 1))),
        junction=100,
        link=touches("predecessor", "road", 2, "start") + touches("successor", "road", 1, "end"),
    )
    junction = (
        '<junction id="100" name="crossing">'
        '<connection id="0" incomingRoad="1" connectingRoad="10" contactPoint="start">'
        '<laneLink from="-1" to="-1"/></connection>'
        '<connection id="1" incomingRoad="2" connectingRoad="11" contactPoint="start">'
        '<laneLink from="1" to="-1"/></connection>'
        f"{controllers and controllers.partition('|')[2]}</junction>"
    )
    return opendrive(west, east, eastward, westward, controllers.partition("|")[0], junction, more)


_CORNERS = "".join(f'<cornerLocal u="{u}" v="{v}" z="0" height="0"/>' for u, v in ((-2, -3), (2, -3), (2, 3), (-2, 3)))
_THINGS = "".join(
    f'<object id="{n}" name="{name}" type="{kind}" s="{10 * n}" t="0" zOffset="0" hdg="0" orientation="none" '
    f'width="3" length="6"><outline>{_CORNERS}</outline></object>'
    for n, (name, kind) in enumerate(
        [("Crosswalk", "crosswalk"), ("YieldLine", "roadMark"), ("StopLine", "roadMark"), ("Isle", "trafficIsland")], 1
    )
)
SIGNS_AND_LIGHTS = street_through_junction(
    objects=_THINGS,
    signals=signal("7", 45.0, -4.0, "206") + signal("8", 45.0, 4.0, "1000001"),
    controllers='<controller id="1" name="c" sequence="0"><control signalId="8" type="0"/></controller>'
    '|<controller id="1" type="0"/>',
)
"""A street through a junction with a stop sign, a light, a crosswalk, lines and an island."""
