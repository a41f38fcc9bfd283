"""OpenDRIVE texts of one road or place with very many records of one kind: well formed, and far from any real map."""

from collections.abc import Callable

DEEP_S_M = 0.5  # between two records along a road


def section(s_m: float, inside: str = "", width: str = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>') -> str:
    """Return a lane section with one driving lane on the right, which holds ``inside`` too."""
    right = f'<right><lane id="-1" type="driving">{inside}{width}</lane></right>'
    return f'<laneSection s="{s_m}"><center><lane id="0" type="none"/></center>{right}</laneSection>'


def road(number: int, length_m: float, sections: str = "", rest: str = "", plan: str = "") -> str:
    """Return a straight road from the origin to the east; ``rest`` stands behind its lanes."""
    line = plan or f'<geometry s="0" x="0" y="0" hdg="0" length="{length_m}"><line/></geometry>'
    lanes = f"<lanes>{sections or section(0.0)}</lanes>"
    return (
        f'<road name="" length="{length_m}" id="{number}" junction="-1"><planView>{line}</planView>{lanes}{rest}</road>'
    )


def _roads_on_one_place(many: int) -> str:
    return "".join(road(number, 100.0) for number in range(many))


def _sections(many: int) -> str:
    return road(1, _length_m(many), "".join(section(s_m) for s_m in _places(many)))


def _linked_sections(many: int) -> str:
    """Return sections whose lanes lead to a lane that there is nowhere."""
    nowhere = '<link><predecessor id="-7"/><successor id="-7"/></link>'
    return road(1, _length_m(many), "".join(section(s_m, nowhere) for s_m in _places(many)))


def _widths(many: int) -> str:
    widths = "".join(f'<width sOffset="{s_m}" a="3.5" b="0" c="0" d="0"/>' for s_m in _places(many))
    return road(1, _length_m(many), section(0.0, width=widths))


def _bent_widths(many: int) -> str:
    widths = "".join(f'<width sOffset="{s_m}" a="3.5" b="0" c="0.01" d="0"/>' for s_m in _places(many))
    return road(1, _length_m(many), section(0.0, width=widths))


def _in_lane(record: str) -> Callable[[int], str]:
    def make(many: int) -> str:
        return road(1, _length_m(many), section(0.0, "".join(record.format(s=s_m) for s_m in _places(many))))

    return make


def _beside(element: str, record: str, most: int = 10**9) -> Callable[[int], str]:
    def make(many: int) -> str:
        places = _places(min(many, most))
        inside = "".join(record.format(s=s_m, n=n) for n, s_m in enumerate(places))
        return road(1, _length_m(len(places)), rest=f"<{element}>{inside}</{element}>")

    return make


def _offsets(many: int) -> str:
    offsets = "".join(f'<laneOffset s="{s_m}" a="0.1" b="0" c="0" d="0"/>' for s_m in _places(many))
    return road(1, _length_m(many), offsets + section(0.0))


def _geometries(many: int) -> str:
    plan = "".join(
        f'<geometry s="{s_m}" x="{s_m}" y="0" hdg="0" length="{DEEP_S_M}"><arc curvature="0.001"/></geometry>'
        for s_m in _places(many)
    )
    return road(1, _length_m(many), plan=plan)


def _length_m(many: int) -> float:
    return max(100.0, DEEP_S_M * many)


def _places(many: int) -> list[float]:
    return [DEEP_S_M * n for n in range(many)]


_SIGNAL = '<signal id="{n}" s="{s}" t="-5" dynamic="%s" orientation="+" type="%s" subtype="-1" value="0"/>'
_BOX = (
    '<object id="{n}" type="building" name="b" s="{s}" t="9" height="5"><outline>'
    '<cornerLocal u="0" v="0" z="0" height="5"/><cornerLocal u="3" v="0" z="0" height="5"/>'
    '<cornerLocal u="3" v="3" z="0" height="5"/></outline></object>'
)


def _signals_and_sections(many: int) -> str:
    """Return a tenth as many stop signs, on a road with many sections."""
    signs = _beside("signals", _SIGNAL % ("no", "206"), 10_000)(many // 10)
    inside = signs[signs.index("<signals>") : signs.index("</road>")]
    link = '<link><predecessor id="-1"/><successor id="-1"/></link>'
    return road(1, _length_m(many), "".join(section(s_m, link) for s_m in _places(many)), rest=inside)


KINDS: dict[str, Callable[[int], str]] = {
    "roads on one place": _roads_on_one_place,
    "lane sections": _sections,
    "lane sections, links to nowhere": _linked_sections,
    "stop signs and lane sections": _signals_and_sections,
    "widths": _widths,
    "bent widths": _bent_widths,
    "road marks": _in_lane('<roadMark sOffset="{s}" type="solid" weight="standard" color="white" width="0.15"/>'),
    "speeds": _in_lane('<speed sOffset="{s}" max="30"/>'),
    "heights": _in_lane('<height sOffset="{s}" inner="0.1" outer="0.1"/>'),
    "lane offsets": _offsets,
    "geometries": _geometries,
    "elevations": _beside("elevationProfile", '<elevation s="{s}" a="0" b="0.01" c="0" d="0"/>'),
    "buildings": _beside("objects", _BOX),
    "crosswalks": _beside("objects", _BOX.replace("building", "crosswalk")),
    "poles": _beside("objects", '<object id="{n}" type="pole" name="p" s="{s}" t="9" height="5" radius="0.1"/>'),
    "traffic lights": _beside("signals", _SIGNAL % ("yes", "1000001"), 10_000),
    "stop signs": _beside("signals", _SIGNAL % ("no", "206"), 10_000),
}
"""Of each kind a function from a number of records to the roads of a text."""


def opendrive(kind: str, many: int) -> str:
    """Return a text with ``many`` records of a kind."""
    return f"<OpenDRIVE><header/>{KINDS[kind](many)}</OpenDRIVE>"
