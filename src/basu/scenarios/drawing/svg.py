"""A tree as a picture: boxes from left to right, a column a depth, coloured by what became of them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from basu.scenarios.drawing.nodes import walk
from basu.scenarios.drawing.text import COLOURS, KINDS, MARKS

if TYPE_CHECKING:
    from basu.scenarios.drawing.nodes import TreeNode

NAME_PX, SAID_PX = 12.0, 10.0  # sizes of type
CHARACTER = 0.56  # width of a character as a share of its size, in a sans-serif type, on the safe side
LONGEST = 46  # characters in a line of a box; the whole is in its title
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


def as_svg(tree: TreeNode) -> str:
    """The picture as text; it scales, and stands on its own."""
    box, bottom_px = _placed(tree, 0, MARGIN_PX)
    widths = _widths(tree)
    lefts = [MARGIN_PX + sum(widths[:depth]) + BETWEEN_PX * depth for depth in range(len(widths))]
    width, height = f"{lefts[-1] + widths[-1] + MARGIN_PX:.0f}", f"{bottom_px - GAP_PX + MARGIN_PX:.0f}"
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
    _draw(svg, box, widths, lefts)
    indent(svg, " ")
    return tostring(svg, encoding="unicode") + "\n"


def _placed(node: TreeNode, depth: int, top_px: float) -> tuple[_Box, float]:
    """A node with all below it, and where the next one may begin."""
    children: list[_Box] = []
    below_px = top_px
    for child in node["children"]:
        placed, below_px = _placed(child, depth + 1, below_px)
        children.append(placed)
    own = _Box(node, depth, 0.0, tuple(children))
    if not children:
        return own._replace(middle_px=top_px + own.height_px / 2.0), top_px + own.height_px + GAP_PX
    middle_px = max((children[0].middle_px + children[-1].middle_px) / 2.0, top_px + own.height_px / 2.0)
    return own._replace(middle_px=middle_px), max(below_px, middle_px + own.height_px / 2.0 + GAP_PX)


def _widths(tree: TreeNode) -> list[float]:
    """Of the columns."""
    widths: dict[int, float] = {}
    for depth, node in walk(tree):
        name_px = (len(_cut(node["name"])) + 4) * NAME_PX * CHARACTER
        said_px = (len(_cut(node["feedback"])) + 4) * SAID_PX * CHARACTER
        widths[depth] = max(widths.get(depth, 0.0), 2.0 * PAD_PX + max(name_px, said_px))
    return [widths[depth] for depth in sorted(widths)]


def _draw(svg: Element, box: _Box, widths: list[float], lefts: list[float]) -> None:
    """The lines to a box's children, the box, and those."""
    node, left_px, width_px = box.node, lefts[box.depth], widths[box.depth]
    for child in box.children:
        begin_px, end_px = left_px + width_px, lefts[child.depth]
        way = f"M{begin_px:.1f} {box.middle_px:.1f}H{(begin_px + end_px) / 2.0:.1f}V{child.middle_px:.1f}H{end_px:.1f}"
        _add(svg, "path", {"d": way, "fill": "none", "stroke": "#aab2ba"})
    top_px = box.middle_px - box.height_px / 2.0
    group = SubElement(svg, "g")
    _add(group, "title", {}, f"{node['kind']}, {node['status']}: {node['name']}\n{node['feedback']}".rstrip())
    frame = {
        **{"x": f"{left_px:.1f}", "y": f"{top_px:.1f}", "width": f"{width_px:.1f}", "height": f"{box.height_px:.1f}"},
        **{"rx": f"{ROUND_PX.get(node['kind'], 3.0):g}"},
        **{"fill": FILLS[node["status"]], "stroke": COLOURS[node["status"]]},
    }
    if node["status"] in {"waiting", "broken off"}:
        frame["stroke-dasharray"] = "4 3"
    _add(group, "rect", frame)
    at = {"x": f"{left_px + PAD_PX:.1f}", "y": f"{top_px + 16.0:.1f}", "font-size": f"{NAME_PX:g}", "fill": "#1d2329"}
    if node["children"]:
        at["font-weight"] = "600"
    name = _add(group, "text", at)
    mark = _add(name, "tspan", {"fill": COLOURS[node["status"]]}, f"{MARKS[node['status']]} {KINDS[node['kind']]}")
    mark.tail = f" {_cut(node['name'])}"
    if node["feedback"]:
        below = {"y": f"{top_px + 31.0:.1f}", "font-size": f"{SAID_PX:g}", "fill": "#4d5761"}
        _add(group, "text", {"x": at["x"], **below}, _cut(node["feedback"]))
    for child in box.children:
        _draw(svg, child, widths, lefts)


def _add(parent: Element, tag: str, attributes: dict[str, str], text: str = "") -> Element:
    """An element below another."""
    element = SubElement(parent, tag, attributes)
    element.text = text or None
    return element


def _cut(text: str) -> str:
    """As much as fits a line."""
    return text if len(text) <= LONGEST else text[: LONGEST - 1].rstrip() + "…"
