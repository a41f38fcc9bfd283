"""A scenario's tree in a page: lists within lists, so that it can be read aloud, folded by a telephone and printed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from basu.output.report.markup import DASH, e

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

SIGNS = {  # of what became of a node: a sign and a style
    "success": ("✓", "passed"),
    "failure": ("✗", "failed"),
    "running": ("…", "running"),
    "waiting": ("○", "waiting"),
    "broken off": ("⊘", "waiting"),
    "not judged": (DASH, "waiting"),
}
KINDS = {"sequence": "→", "parallel": "⇉", "selector": "?", "trigger": "⚑", "action": "▸", "criterion": "="}


def tree_view(tree: dict[str, Any]) -> Element:
    """The tree with what became of each node."""
    return e("ul", _node(tree), class_="tree")


def key() -> Element:
    """What the signs mean."""
    kinds = ", ".join(f"{sign} {kind}" for kind, sign in KINDS.items())
    ends = ", ".join(f"{sign} {status}" for status, (sign, _) in SIGNS.items())
    return e("p", f"{ends}; {kinds}", class_="note")


def _node(node: dict[str, Any]) -> Element:
    """A node and all below it."""
    status = str(node["status"]).lower()
    sign, style = SIGNS.get(status, ("○", "waiting"))
    label = e(
        "span",
        e("b", sign, class_=f"outcome {style}", title=status),
        e("i", KINDS.get(node["kind"], "·"), class_="kind", title=node["kind"]),
        e("span", node["name"], class_="called"),
        e("small", node["feedback"]) if node["feedback"] else None,
        class_="node",
    )
    below = [_node(child) for child in node["children"]]
    return e("li", label, e("ul", *below) if below else None)
