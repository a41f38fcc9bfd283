"""A case with one agent as a card: verdict, picture, phases, judgements with evidence, tree, command."""

from __future__ import annotations

import re
import shlex
from typing import TYPE_CHECKING, Any

from basu.output.report.plots.chart import share, times
from basu.output.report.scenarios.drawing.picture import case_drawing
from basu.output.report.scenarios.tally import LOOKS
from basu.output.report.templates import DASH, e, figure, percent

if TYPE_CHECKING:
    from collections.abc import Sequence
    from xml.etree.ElementTree import Element

    from basu.output.report.streets import Line
    from basu.records.history import History


def card(
    result: dict[str, Any],
    history: History | None,
    streets: Sequence[Line],
    *,
    picture: bool = True,
) -> Element:
    """The card, open; its place in a page is ``anchor_of``."""
    verdict = result["verdict"]
    article = e(
        "article",
        e("h4", e("span", result["agent"], class_="agent"), " ", verdict_mark(verdict)),
        e("p", result["message"], class_="message"),
        class_=f"case-card {LOOKS[verdict].style}",
        id=anchor_of(result["id"], result["agent"]),
        data_agent=result["agent"],
        data_verdict=verdict,
    )
    if result.get("assessment") is not None:  # a run made before them has neither
        article.append(answers(result["assessment"]))
    if result.get("collisions"):
        article.append(collisions(result["collisions"]))
    if picture and history is not None and len(history.frames):
        article.append(e("figure", case_drawing(result, history, streets), class_="picture"))
    line = phase_line(result)
    if line is not None:
        article.append(line)
    if result["judgements"]:
        article.append(judgements(result["judgements"]))
    if result["tree"] is not None:
        article.append(e("details", e("summary", "Tree"), tree_view(result["tree"]), class_="folded"))
    command = shlex.join(str(word) for word in result["command"])
    article.append(e("details", e("summary", "Play it again"), e("pre", command), _where(result), class_="folded"))
    return article


def answers(assessment: dict[str, Any]) -> Element:
    """The policy's three answers, each with its sentence."""
    words = {True: ("✓", "passed"), False: ("✗", "failed"), None: (DASH, "unjudged")}
    rows = []
    for name, found in assessment.items():
        sign, style = words[found["holds"]]
        if name == "exercised" and found["holds"] is False:
            sign, style = "○", "absent"
        rows.append(
            e(
                "tr",
                e("td", sign, class_=f"outcome {style}"),
                e("th", name, scope="row"),
                e("td", found["sentence"]),
            )
        )
    return e("table", e("tbody", *rows), class_="answers")


def collisions(found: Sequence[dict[str, Any]]) -> Element:
    """The contacts, each with the responsibility for it."""
    rows = [e("li", f"{one['t_s']:.2f} s with {one['other']}: {one['sentence']}") for one in found]
    return e("div", e("b", "Collisions"), e("ul", *rows), class_="collisions")


def verdict_mark(verdict: str) -> Element:
    """A verdict as a sign and a word."""
    look = LOOKS[verdict]
    return e("b", f"{look.sign} {look.word}", class_=f"verdict {look.style}")


def anchor_of(case: str, agent: str) -> str:
    """The name of a card in a page: what no address may hold is written as its number, so that all are told apart."""
    return "case-" + re.sub(r"[^A-Za-z0-9_-]", lambda found: f".{ord(found[0]):x}.", f"{case}--{agent}")


def judgements(found: Sequence[dict[str, Any]]) -> Element:
    """What each criterion said; those that decide first."""
    head = e("tr", *(e("th", text, scope="col") for text in ("", "criterion", "measured", "limit")))
    ordered = sorted(found, key=lambda judgement: not judgement["deciding"])
    return e("table", e("thead", head), *(_judgement(judgement) for judgement in ordered), class_="judgements")


def _judgement(judgement: dict[str, Any]) -> Element:
    """One of them: the figures, and below them the sentence."""
    sign, style = {True: ("✓", "passed"), False: ("✗", "failed"), None: (DASH, "told")}[judgement["passed"]]
    is_deciding = judgement["deciding"]
    measured = "" if judgement["measured"] is None else f"{figure(judgement['measured'], 2)} {judgement['unit']}"
    figures = e(
        "tr",
        e("td", sign, class_=f"outcome {style if is_deciding else 'told'}"),
        e("th", judgement["criterion"], scope="row"),
        e("td", measured),
        e("td", judgement["limit"] if is_deciding else "reported only"),
    )
    sentence = e("tr", e("td"), e("td", judgement["sentence"], colspan=3), class_="why")
    return e("tbody", figures, sentence, class_=None if is_deciding else "told")


def parameters(found: Sequence[dict[str, Any]]) -> Element | None:
    """The values of a case, with what they are."""
    if not found:
        return None
    pairs = [
        e("div", e("dt", parameter["name"]), e("dd", _value(parameter), title=parameter["about"]))
        for parameter in found
    ]
    return e("dl", *pairs, class_="parameters")


def _value(parameter: dict[str, Any]) -> str:
    value = parameter["value"]
    text = value if isinstance(value, str) else f"{value:.4g}"
    return f"{text} {parameter['unit']}".rstrip()


def _where(result: dict[str, Any]) -> Element:
    """What else has to be the same."""
    terms = [
        ("town", result["town"]),
        ("vehicle", result["vehicle"]),
        ("seed", str(result["seed"])),
        *result.get("characteristics", {}).items(),
        *_speeds(result.get("measured")),
        ("from", result["scenarios_file"]),
        ("simulated", f"{result['simulated_s']:.1f} s in {result['wall_s']:.1f} s"),
    ]
    return e("dl", *(e("div", e("dt", name), e("dd", text)) for name, text in terms))


def _speeds(measured: dict[str, Any] | None) -> list[tuple[str, str]]:
    """The posted speed and the ego's where the conflict began."""
    if measured is None:
        return []
    posted_mps = measured["posted_mps"]
    posted = "none" if posted_mps is None else f"{posted_mps:.1f} m/s"
    return [("posted", posted), ("ego's speed at the conflict", f"{measured['travel_mps']:.1f} m/s")]


PHASES = {  # as a scenario passes them, and what the line calls each
    "setup": "set-up",
    "trigger": "before",
    "conflict": "conflict",
    "resolution": "resolution",
}
LEAST_SHARE = 0.09  # of the line; the name of a shorter phase would not fit in it


def phase_line(result: dict[str, Any]) -> Element | None:
    """The line; None where no phase began."""
    begun_s: dict[str, float] = result["phases_s"]
    if not begun_s:
        return None
    begin_s = min(begun_s.values())
    end_s = max(begun_s.get("end", begin_s + result["simulated_s"]), *begun_s.values(), begin_s + 0.1)
    order = [name for name in PHASES if name in begun_s]
    line = e("div", class_="phases")
    told = []
    for name, following in zip(order, [*order[1:], None], strict=True):
        from_s = begun_s[name]
        to_s = end_s if following is None else begun_s[following]
        part = (to_s - from_s) / (end_s - begin_s)
        if part <= 0.0:
            continue
        words = f"{PHASES[name]} from {from_s:.1f} s to {to_s:.1f} s"
        told.append(words)
        style = f"left:{share(from_s, begin_s, end_s)};width:{percent(part)}"
        label = PHASES[name] if part >= LEAST_SHARE else None
        line.append(e("i", label, class_=f"phase {name}", style=style, title=words))
    line.extend(_moments(result, begin_s, end_s))
    return e("div", line, times(begin_s, end_s), class_="phase-line", role="img", aria_label="; ".join(told))


def _moments(result: dict[str, Any], begin_s: float, end_s: float) -> list[Element]:
    """When the criteria that failed decided."""
    return [
        e(
            "b",
            "✗",
            class_="moment-of failed",
            style=f"left:{share(judgement['t_s'], begin_s, end_s)}",
            title=f"{judgement['criterion']} at {judgement['t_s']:.1f} s",
        )
        for judgement in result["judgements"]
        if judgement["passed"] is False and judgement["deciding"] and judgement["t_s"] is not None
    ]


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
