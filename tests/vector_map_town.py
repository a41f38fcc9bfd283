"""Small OpenDRIVE maps, written by hand."""

_HEAD = """<?xml version="1.0"?>
<OpenDRIVE><header revMajor="1" revMinor="4" name="Small">{geo}</header>
"""
GEO = "<geoReference><![CDATA[+proj=tmerc +lat_0=40 +lon_0=-83 +k=1 +x_0=0 +y_0=0]]></geoReference>"


def lane(lane_id, width=3.5, kind="driving", mark="broken", links="", extra=""):
    return (
        f'<lane id="{lane_id}" type="{kind}" level="false"><link>{links}</link>'
        f'<width sOffset="0" a="{width}" b="0" c="0" d="0"/>'
        f'<roadMark sOffset="0" type="{mark}" weight="standard" color="white" width="0.12"/>{extra}</lane>'
    )


def road(number, x, length, lanes, *, link="", geometry="<line/>", z=100.0):
    left = "".join(text for lane_id, text in lanes if lane_id > 0)
    right = "".join(text for lane_id, text in lanes if lane_id < 0)
    return (
        f'<road name="Street {number}" length="{length}" id="{number}" junction="-1"><link>{link}</link>'
        f'<type s="0" type="town"><speed max="25" unit="mph"/></type>'
        f'<planView><geometry s="0" x="{x}" y="0" hdg="0" length="{length}">{geometry}</geometry></planView>'
        f'<elevationProfile><elevation s="0" a="{z}" b="0.02" c="0" d="0"/></elevationProfile>'
        f'<lanes><laneSection s="0"><left>{left}</left>'
        '<center><lane id="0" type="none" level="false">'
        '<roadMark sOffset="0" type="solid solid" weight="standard" color="yellow" width="0.12"/></lane></center>'
        f"<right>{right}</right></laneSection></lanes></road>"
    )


def document(*roads, junctions="", geo=GEO):
    return _HEAD.format(geo=geo) + "".join(roads) + junctions + "</OpenDRIVE>"


def two_roads(geo=GEO):
    """Two straight roads in a row, with two lanes to the east and one to the west, kerbs and pavements."""

    def lanes(to_west, to_east):
        kerb = '<height sOffset="0" inner="0.15" outer="0.15"/>'
        return [
            (2, lane(2, 1.5, "sidewalk", "none", extra=kerb)),
            (1, lane(1, mark="none", links=to_west)),
            (-1, lane(-1, mark="broken", links=to_east.format(-1))),
            (-2, lane(-2, mark="none", links=to_east.format(-2))),
            (-3, lane(-3, 1.5, "sidewalk", "none", extra=kerb)),
        ]

    first = road(
        1,
        0.0,
        40.0,
        lanes('<successor id="1"/>', '<successor id="{}"/>'),
        link='<successor elementType="road" elementId="2" contactPoint="start"/>',
    )
    second = road(
        2,
        40.0,
        30.0,
        lanes('<predecessor id="1"/>', '<predecessor id="{}"/>'),
        link='<predecessor elementType="road" elementId="1" contactPoint="end"/>',
        geometry='<arc curvature="0.02"/>',
        z=100.8,
    )
    return document(first, second, geo=geo)
