"""A small OpenDRIVE town: four streets of 60 m that meet in one crossing, every turn allowed but the one back."""

import math

ARM_M, REACH_M, LANE_M = 60.0, 10.0, 3.5  # street length, from the middle to a street's beginning, lane width
MARK = '<roadMark sOffset="0" type="solid" weight="standard" color="white" width="0.12" laneChange="none"/>'
WIDTH = f'<width sOffset="0" a="{LANE_M}" b="0" c="0" d="0"/>'


def _lane(number: int, link: str = "") -> str:
    return f'<lane id="{number}" type="driving" level="false"><link>{link}</link>{WIDTH}{MARK}</lane>'


def _section(left: str, right: str, s_m: float = 0.0) -> str:
    left = f"<left>{left}</left>" if left else ""
    centre = f'<center><lane id="0" type="none" level="false">{MARK}</lane></center>'
    return f'<laneSection s="{s_m}">{left}{centre}<right>{right}</right></laneSection>'


def _sign(number: int, code: str) -> str:
    """Beside the end of a street's inbound lane, its line 1 m before the crossing."""
    return (
        f'<signals><signal s="1.0" t="5" id="{100 + number}" name="sign" dynamic="no" orientation="-" zOffset="2" '
        f'country="US" type="{code}" subtype="" value="0" height="0.7" width="0.7" hOffset="0">'
        '<validity fromLane="1" toLane="1"/></signal></signals>'
    )


def _street(number: int, sections: int) -> str:
    """Street ``number`` (0 east, 1 north, 2 west, 3 south), from the crossing outwards; a stop sign on 1 and 3."""
    angle = number * math.pi / 2.0
    lanes = "".join(
        _section(
            _lane(1, '<predecessor id="1"/><successor id="1"/>'),
            _lane(-1, '<predecessor id="-1"/><successor id="-1"/>'),
            index * ARM_M / sections,
        )
        for index in range(sections)
    )
    sign = _sign(number, "206") if number % 2 else _sign(number, "205")
    return (
        f'<road name="street {number}" length="{ARM_M}" id="{number + 1}" junction="-1">'
        '<link><predecessor elementType="junction" elementId="50"/></link>'
        '<type s="0" type="town"><speed max="25" unit="mph"/></type>'
        f'<planView><geometry s="0" x="{REACH_M * math.cos(angle)}" y="{REACH_M * math.sin(angle)}" hdg="{angle}" '
        f'length="{ARM_M}"><line/></geometry></planView><lanes>{lanes}</lanes>{sign}</road>'
    )


def _turn(number: int, start: int, end: int) -> tuple[str, str]:
    """The connecting road from one street to another, and its entry in the junction."""
    angle, quarters = start * math.pi / 2.0, (end - start) % 4
    shape, length_m = "<line/>", 2.0 * REACH_M
    if quarters != 2:
        shape = f'<arc curvature="{(1.0 if quarters == 3 else -1.0) / REACH_M}"/>'
        length_m = REACH_M * math.pi / 2.0
    lane = _lane(-1, '<predecessor id="1"/><successor id="-1"/>')
    road = (
        f'<road name="" length="{length_m}" id="{number}" junction="50"><link>'
        f'<predecessor elementType="road" elementId="{start + 1}" contactPoint="start"/>'
        f'<successor elementType="road" elementId="{end + 1}" contactPoint="start"/></link>'
        f'<planView><geometry s="0" x="{REACH_M * math.cos(angle)}" y="{REACH_M * math.sin(angle)}" '
        f'hdg="{angle + math.pi}" length="{length_m}">{shape}</geometry></planView>'
        f"<lanes>{_section('', lane)}</lanes></road>"
    )
    connection = (
        f'<connection id="{number}" incomingRoad="{start + 1}" connectingRoad="{number}" contactPoint="start">'
        '<laneLink from="1" to="-1"/></connection>'
    )
    return road, connection


def crossing(sections: int = 1) -> str:
    """The OpenDRIVE text; each street has so many lane sections."""
    pairs = [(start, end) for start in range(4) for end in range(4) if start != end]
    turns = [_turn(number, start, end) for number, (start, end) in enumerate(pairs, start=10)]
    return (
        '<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4" name="Crossing"><geoReference>+proj=tmerc '
        "+lat_0=40 +lon_0=-83 +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs</geoReference></header>"
        + "".join(_street(number, sections) for number in range(4))
        + "".join(road for road, _ in turns)
        + f'<junction id="50" name="crossing">{"".join(connection for _, connection in turns)}</junction></OpenDRIVE>'
    )
