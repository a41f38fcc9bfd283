"""Claims about trees: their five phases, and how they are drawn before and after a run."""

import itertools
import json
from xml.etree import ElementTree as ET

import pytest
from py_trees.behaviour import Behaviour
from py_trees.composites import Selector

from basu.scenarios.actions import Either, InTurn, Meanwhile, SetLight, Wait
from basu.scenarios.criteria.criterion import Judgement
from basu.scenarios.scenario import PHASES, Scenario, compose
from basu.scenarios.tree_picture import FORMS, as_svg, draw
from basu.scenarios.tree_text import TreeNode, as_dot, as_text, tree_of, walk
from basu.scenarios.triggers import EgoPasses
from basu.testing import offline_place, rehearse

SVG = "{http://www.w3.org/2000/svg}"


class Odd(Scenario):
    """Names that would break a picture if they were not escaped."""

    def setup(self) -> Behaviour:
        return Selector('a "choice" & <more>', memory=True, children=[SetLight('<b>"7"\\', "Red")])

    def trigger(self) -> Behaviour:
        return EgoPasses(20.0, "the line")

    def conflict(self) -> Behaviour:
        return Meanwhile(Wait(2.0), InTurn(Wait(1.0), Wait(50.0)), Either(Wait(0.5), Wait(60.0)))

    def criteria(self) -> list[object]:
        return [type("C", (), {"name": "no collision"})()]


JUDGEMENTS = (
    Judgement("no collision", False, True, 1.0, "", "none", "touched <a & b>"),
    Judgement("speed", True, True, 6.0, "m/s", "at most 8 m/s", "it had 6.0 m/s"),
    Judgement("comfort", None, False, None, "", "", "nothing was measured"),
)


@pytest.fixture
def odd() -> Odd:
    return Odd(offline_place([(0.0, 0.0), (60.0, 0.0)]), {})


@pytest.fixture
def after(odd: Odd) -> TreeNode:
    return tree_of(rehearse(odd).tree, JUDGEMENTS)


def by_name(tree: TreeNode) -> dict[str, TreeNode]:
    return {node["name"]: node for _, node in walk(tree)}


def test_every_scenario_has_the_five_phases_in_their_order(odd: Odd) -> None:
    composed = compose(odd)
    assert PHASES == ("setup", "trigger", "conflict", "resolution", "end")
    assert tuple(composed.phases) == PHASES
    assert [child.name for child in composed.root.root.children] == list(PHASES)
    assert composed.phases["end"].children == []


def test_the_behaviour_stands_beside_the_criteria(odd: Odd) -> None:
    tree = tree_of(compose(odd), criteria=odd.criteria())
    assert (tree["name"], tree["kind"], tree["status"]) == ("Odd", "parallel", "waiting")
    assert [branch["name"] for branch in tree["children"]] == ["behaviour", "criteria"]
    assert {node["status"] for _, node in walk(tree)} == {"waiting"}


def test_kinds_are_distinguished(after: TreeNode) -> None:
    nodes = by_name(after)
    assert nodes["setup"]["kind"] == "sequence"
    assert nodes['a "choice" & <more>']["kind"] == "selector"
    assert nodes["until wait 2 s"]["kind"] == "parallel"
    assert nodes["ego passes the line"]["kind"] == "trigger"
    assert nodes["wait 2 s"]["kind"] == "action"
    assert nodes["speed"]["kind"] == "criterion"


def test_what_was_done_what_was_broken_off_and_what_never_began(after: TreeNode) -> None:
    nodes = by_name(after)
    assert nodes["wait 2 s"]["status"] == "success"
    assert nodes["wait 1 s"]["status"] == "success"  # in a sequence that was broken off afterwards
    assert nodes["wait 50 s"]["status"] == "broken off"
    assert nodes["in turn"]["status"] == "broken off"
    assert nodes["wait 60 s"]["status"] == "broken off"
    assert nodes["wait 50 s"]["feedback"].startswith("broken off after 5.")


def test_what_was_never_reached_waits_and_what_goes_on_runs(odd: Odd) -> None:
    nodes = by_name(tree_of(rehearse(odd, until_s=4.0).tree))
    assert nodes["conflict"]["status"] == "running"
    assert nodes["wait 50 s"]["status"] == "waiting"
    assert nodes["resolution"]["status"] == "waiting"


def test_criteria_have_their_judgement_and_decide_the_whole(after: TreeNode) -> None:
    nodes = by_name(after)
    assert (nodes["no collision"]["status"], nodes["no collision"]["feedback"]) == ("failure", "touched <a & b>")
    assert (nodes["speed"]["status"], nodes["speed"]["feedback"]) == ("success", "it had 6.0 m/s (at most 8 m/s)")
    assert nodes["comfort (reported only)"]["status"] == "not judged"
    assert nodes["criteria"]["status"] == after["status"] == "failure"
    assert nodes["behaviour"]["status"] == "success"


def test_a_tree_survives_its_document(after: TreeNode) -> None:
    again = json.loads(json.dumps(after))
    assert again == after
    assert as_svg(again) == as_svg(after)


def test_text_has_a_line_a_node_with_its_mark(after: TreeNode) -> None:
    lines = as_text(after).splitlines()
    assert len(lines) == len(list(walk(after)))
    assert lines[0] == "✗ ⇉ Odd"
    assert "✓ │  ├─ → setup" in lines
    assert "⊘ │  │     │  └─ □ wait 50 s  (broken off after 5.4 s)" in lines
    assert lines[-1] == "~    └─ ○ comfort (reported only)  (nothing was measured)"


def test_plain_text_is_ascii(after: TreeNode) -> None:
    plain = as_text(after, plain=True)
    assert plain.isascii()
    assert "ok |   |-- -> setup" in plain.splitlines()


def test_dot_names_every_edge_and_escapes(after: TreeNode) -> None:
    dot = as_dot(after)
    assert dot.count(" -> ") == len(list(walk(after))) - 1
    assert r"□ light <b>\"7\"\\ shows Red" in dot
    assert "n0 -> n1;" in dot


def test_the_picture_is_well_formed_and_says_all(after: TreeNode) -> None:
    svg = ET.fromstring(as_svg(after))
    texts = {"".join(text.itertext()) for text in svg.iter(f"{SVG}text")}
    assert '✓ □ light <b>"7"\\ shows Red' in texts
    assert "touched <a & b>" in texts
    assert len(list(svg.iter(f"{SVG}g"))) == len(list(walk(after)))
    assert len(list(svg.iter(f"{SVG}path"))) == len(list(walk(after))) - 1


def test_no_box_of_the_picture_covers_another_or_leaves_it(after: TreeNode) -> None:
    svg = ET.fromstring(as_svg(after))
    frames = [
        tuple(float(group.find(f"{SVG}rect").get(key)) for key in ("x", "y", "width", "height"))
        for group in svg.iter(f"{SVG}g")
    ]
    for (x, y, w, h), (x2, y2, w2, h2) in itertools.combinations(frames, 2):
        assert x + w <= x2 or x2 + w2 <= x or y + h <= y2 or y2 + h2 <= y
    assert all(x + w <= float(svg.get("width")) and y + h <= float(svg.get("height")) for x, y, w, h in frames)


def test_a_long_name_is_cut_in_its_box_and_whole_in_its_title() -> None:
    name = "a name that goes on " * 8
    tree = TreeNode(name=name, kind="action", status="waiting", feedback="", children=[])
    svg = ET.fromstring(as_svg(tree))
    (shown,) = ("".join(text.itertext()) for text in svg.iter(f"{SVG}text"))
    assert shown.endswith("…")
    assert len(shown) < 70
    assert name.strip() in svg.find(f"{SVG}g/{SVG}title").text


@pytest.mark.parametrize("form", sorted(FORMS))
def test_a_scenario_is_drawn_before_any_run_in_every_form(odd: Odd, form: str) -> None:
    drawn = draw(odd, form)
    for words in ("conflict", "ego passes the line", "no collision"):
        assert words in drawn
