"""A scenario's behaviour tree as an SVG picture, or in another form on request."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, NamedTuple
from xml.etree.ElementTree import Element, SubElement, tostring

from basu.scenarios.scenario import compose
from basu.scenarios.tree_text import COLOURS, KINDS, MARKS, as_dot, as_text, tree_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from basu.scenarios.scenario import Scenario
    from basu.scenarios.tree_text import TreeNode


NAME_PX, SAID_PX = 12.0, 10.0  # sizes of type
CHARACTER, BOLD = 0.57, 0.65  # width of a character as a share of its size, in a sans-serif type, on the safe side
LONGEST, LONGEST_SAID = 60, 84  # characters in a line of a box; the whole is in its title
PAD_PX, GAP_PX, BETWEEN_PX = 9.0, 7.0, 34.0  # inside a box, between rows, between columns
MARGIN_PX = 10.0
ONE_LINE_PX, TWO_LINES_PX = 24.0, 38.0
ROUND_PX = {"criterion": 12.0, "trigger": 8.0}  # of the corners; 3 for others
FILLS = {
    "success": "#e9f5ea",
    "failure": "#fdecec",
    "running": "#e6f0fb",
    "broken off": "#f3efed",
    "not judged": "#fbf6e2",
    "waiting": "#f4f5f6",
}


class _Box(NamedTuple):
    """A node with its place."""

    node: TreeNode
    depth: int
    middle_px: float  # from above
    children: tuple[_Box, ...]

    @property
    def height_px(self) -> float:
        """With or without a second line."""
        return TWO_LINES_PX if self.node["feedback"] else ONE_LINE_PX

    @property
    def width_px(self) -> float:
        """As much as its text needs."""
        name_px = (len(_cut(self.node["name"], LONGEST)) + 4) * NAME_PX * (BOLD if self.children else CHARACTER)
        said_px = len(_cut(self.node["feedback"], LONGEST_SAID)) * SAID_PX * CHARACTER
        return 2.0 * PAD_PX + max(name_px, said_px)


def as_svg(tree: TreeNode) -> str:
    """The picture as text; it scales, and stands on its own."""
    box, bottom_px = _placed(tree, 0, MARGIN_PX)
    boxes = list(_all(box))
    lefts = _lefts(boxes)
    right_px = max(lefts[each.depth] + each.width_px for each in boxes)
    width, height = f"{right_px + MARGIN_PX:.0f}", f"{bottom_px - GAP_PX + MARGIN_PX:.0f}"
    size = {"width": width, "height": height}
    svg = Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "viewBox": f"0 0 {width} {height}",
            **size,
            "font-family": "system-ui, sans-serif",
            "role": "img",
        },
    )
    _add(svg, "title", {}, tree["name"])
    _add(svg, "rect", {**size, "fill": "#ffffff"})
    for each in boxes:
        _draw(svg, each, lefts)
    for part in svg:
        part.tail = "\n"
    return tostring(svg, encoding="unicode") + "\n"


def _placed(node: TreeNode, depth: int, top_px: float) -> tuple[_Box, float]:
    """A node with all below it, and where the next one may begin."""
    children: list[_Box] = []
    below_px = top_px
    for child in node["children"]:
        placed, below_px = _placed(child, depth + 1, below_px)
        children.append(placed)
        if child["children"]:
            below_px += GAP_PX
    own = _Box(node, depth, 0.0, tuple(children))
    if not children:
        return own._replace(middle_px=top_px + own.height_px / 2.0), top_px + own.height_px + GAP_PX
    middle_px = max((children[0].middle_px + children[-1].middle_px) / 2.0, top_px + own.height_px / 2.0)
    return own._replace(middle_px=middle_px), max(below_px, middle_px + own.height_px / 2.0 + GAP_PX)


def _all(box: _Box) -> Iterator[_Box]:
    """A box and all to its right."""
    yield box
    for child in box.children:
        yield from _all(child)


def _lefts(boxes: list[_Box]) -> list[float]:
    """Where each column begins: behind the boxes that have children; a leaf has its row to itself and may be longer."""
    lefts = [MARGIN_PX]
    for depth in range(max(box.depth for box in boxes)):
        widest_px = max(box.width_px for box in boxes if box.depth == depth and box.children)
        lefts.append(lefts[-1] + widest_px + BETWEEN_PX)
    return lefts


def _draw(svg: Element, box: _Box, lefts: list[float]) -> None:
    """A box and the lines to its children."""
    node, left_px, width_px = box.node, lefts[box.depth], box.width_px
    for child in box.children:
        begin_px, end_px = left_px + width_px, lefts[child.depth]
        way = f"M{begin_px:.1f} {box.middle_px:.1f}H{end_px - BETWEEN_PX / 2.0:.1f}V{child.middle_px:.1f}H{end_px:.1f}"
        _add(svg, "path", {"d": way, "fill": "none", "stroke": "#aab2ba"})
    top_px = box.middle_px - box.height_px / 2.0
    group = SubElement(svg, "g")
    _add(group, "title", {}, f"{node['kind']}, {node['status']}: {node['name']}\n{node['feedback']}".rstrip())
    frame = {
        "x": f"{left_px:.1f}",
        "y": f"{top_px:.1f}",
        "width": f"{width_px:.1f}",
        "height": f"{box.height_px:.1f}",
        "rx": f"{ROUND_PX.get(node['kind'], 3.0):g}",
        "fill": FILLS[node["status"]],
        "stroke": COLOURS[node["status"]],
    }
    if node["status"] in {"waiting", "broken off"}:
        frame["stroke-dasharray"] = "4 3"
    _add(group, "rect", frame)
    at = {"x": f"{left_px + PAD_PX:.1f}", "y": f"{top_px + 16.0:.1f}", "font-size": f"{NAME_PX:g}", "fill": "#1d2329"}
    if node["children"]:
        at["font-weight"] = "600"
    name = _add(group, "text", at)
    mark = _add(name, "tspan", {"fill": COLOURS[node["status"]]}, f"{MARKS[node['status']]} {KINDS[node['kind']]}")
    mark.tail = f" {_cut(node['name'], LONGEST)}"
    if node["feedback"]:
        below = {"y": f"{top_px + 31.0:.1f}", "font-size": f"{SAID_PX:g}", "fill": "#4d5761"}
        _add(group, "text", {"x": at["x"], **below}, _cut(node["feedback"], LONGEST_SAID))


def _add(parent: Element, tag: str, attributes: dict[str, str], text: str = "") -> Element:
    """An element below another."""
    element = SubElement(parent, tag, attributes)
    element.text = text or None
    return element


def _cut(text: str, longest: int) -> str:
    """As much as fits a line."""
    return text if len(text) <= longest else text[: longest - 1].rstrip() + "…"


FORMS: dict[str, Callable[[TreeNode], str]] = {
    "text": as_text,
    "ascii": lambda tree: as_text(tree, plain=True),
    "svg": as_svg,
    "dot": as_dot,
    "json": lambda tree: json.dumps(tree, indent=2, ensure_ascii=False),
}


def draw(scenario: Scenario, form: str = "text") -> str:
    """The tree of a scenario at its place, with its criteria; ``form`` is one of ``FORMS``.

    Raises:
        ScenarioError: the scenario asks its place for what is not there.
    """
    return FORMS[form](tree_of(compose(scenario), criteria=scenario.criteria()))
