"""A small OpenDRIVE town without an end: two half circles that meet, with one lane in each direction."""

import math

RADIUS_M, LANE_M = 60.0, 3.5
MARK = '<roadMark sOffset="0" type="solid" weight="standard" color="white" width="0.12" laneChange="none"/>'


def _lane(number: int) -> str:
    link = f'<link><predecessor id="{number}"/><successor id="{number}"/></link>'
    width = f'<width sOffset="0" a="{LANE_M}" b="0" c="0" d="0"/>'
    return f'<lane id="{number}" type="driving" level="false">{link}{width}{MARK}</lane>'


def _half(number: int, east_m: float) -> str:
    """Road 1 is the southern half, driven from west to east; road 2 the northern one."""
    other, sign = 3 - number, -1.0 if number == 1 else 1.0
    return (
        f'<road name="half {number}" length="{math.pi * RADIUS_M}" id="{number}" junction="-1"><link>'
        f'<predecessor elementType="road" elementId="{other}" contactPoint="end"/>'
        f'<successor elementType="road" elementId="{other}" contactPoint="start"/></link>'
        '<type s="0" type="town"><speed max="25" unit="mph"/></type><planView>'
        f'<geometry s="0" x="{east_m + sign * RADIUS_M}" y="0" hdg="{sign * math.pi / 2.0}" '
        f'length="{math.pi * RADIUS_M}"><arc curvature="{1.0 / RADIUS_M}"/></geometry></planView><lanes>'
        f'<laneSection s="0"><left>{_lane(1)}</left><center><lane id="0" type="none" level="false">{MARK}</lane>'
        f"</center><right>{_lane(-1)}</right></laneSection></lanes></road>"
    )


def ring(east_m: float = 0.0) -> str:
    """The OpenDRIVE text; the ring's middle lies so far to the east."""
    return (
        '<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4" name="Ring"><geoReference>+proj=tmerc '
        "+lat_0=40 +lon_0=-83 +k=1 +x_0=0 +y_0=0 +datum=WGS84 +units=m +no_defs</geoReference></header>"
        f"{_half(1, east_m)}{_half(2, east_m)}</OpenDRIVE>"
    )
