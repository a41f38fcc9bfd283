"""Claims about sampled parameters: a boundary that is there is found with its counts, and none is made up."""

import itertools
import math
import random
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np
import pytest

from basu.output.report.scenarios.sweep.boundary import best_rule, between, boundary, boundary_of, sentences
from basu.output.report.scenarios.sweep.failure_rates import best_pair
from basu.output.report.scenarios.sweep.plane import HEIGHT_PX, LEFT_PX, TOP_PX, WIDTH_PX, region
from basu.output.report.scenarios.sweep.study import Axis, studies
from basu.output.report.scenarios.sweep.success_map import sweep_map
from fakes.scenario_documents import case, grid, matrix, matrix_of, sweep


def number(values: Any, name: str = "gap") -> Axis:
    return Axis(name, "m", "", np.array(values, dtype=np.float64), ())


def sampled(verdict_of: Any, count: int = 120, seed: int = 3) -> dict[str, Any]:
    """Two numbers and a choice, uniformly; ``verdict_of`` decides the verdict."""
    dice, cases = random.Random(seed), []
    for index in range(count):
        a, b, kind = dice.uniform(0, 10), dice.uniform(0, 10), dice.choice(["car", "bus", "bicycle"])
        parameters = [
            {"name": name, "value": value, "unit": unit, "about": ""}
            for name, value, unit in (("a", a, "m"), ("b", b, "s"), ("kind", kind, ""), ("fixed", 1.0, ""))
        ]
        verdict = "FAILURE" if verdict_of(a, b, kind) else "SUCCESS"
        cases.append(case(f"one:sweep-{count}-{seed}-{index}", "One", "rear-end", {"basic": verdict}, parameters))
    return matrix_of(cases, ["basic"], sweep={"n": count, "seed": seed, "vary": []})


def test_a_threshold_is_found_with_its_counts() -> None:
    document = sampled(lambda a, b, kind: a < 4.0)
    failed, passed = 52, 68
    assert int(studies(document)[0].failed.sum()) == failed
    counts = f"({failed} of {failed}), passes elsewhere ({passed} of {passed})"
    assert boundary(document)[1] == f"basic in One: fails where a < 4 m {counts}."


def test_a_range_is_found_where_neither_end_fails() -> None:
    assert "fails where b is 3 to 6 s (" in boundary(sampled(lambda a, b, kind: 3.0 < b < 6.0))[1]


def test_options_are_found() -> None:
    assert "fails where kind is bicycle or bus (" in boundary(sampled(lambda a, b, kind: kind != "car"))[1]


def test_where_several_cases_were_sampled_the_case_may_be_what_tells() -> None:
    document = sampled(lambda a, b, kind: False)
    for number, row in enumerate(document["cases"]):
        row["id"] = f"one_{number % 3}:sweep-120-3-{number}"
        row["results"]["basic"]["verdict"] = "FAILURE" if number % 3 == 1 else "SUCCESS"
    assert boundary(document)[1] == "basic in One: fails where case is one_1 (40 of 40), passes elsewhere (80 of 80)."


def test_a_second_condition_is_found_within_the_first() -> None:
    found = boundary_of(studies(sampled(lambda a, b, kind: a < 5.0 and kind == "bus"))[0])
    assert found.rule is not None
    assert found.within is not None
    assert {found.rule.axis.name, found.within.axis.name} == {"a", "kind"}
    assert (found.within.failed_inside, found.within.failed_outside) == (int(found.study.failed.sum()), 0)


def test_noise_has_no_boundary() -> None:
    made_up = 0
    for seed in range(20):
        dice = random.Random(100 + seed)
        told = boundary(sampled(lambda a, b, kind, dice=dice: dice.random() < 0.4, seed=seed))
        made_up += not any("no single parameter" in sentence for sentence in told)
        made_up += any("predict" in sentence for sentence in told)
    assert made_up <= 4  # 40 tests at 5 % each


def test_neither_parameter_alone_but_both_together() -> None:
    told = boundary(sampled(lambda a, b, kind: (a > 5.0) != (b > 5.0)))
    assert "no single parameter tells which" in told[1]
    assert "of all pairs, a and b predict best" in told[-1]


def test_one_that_always_or_never_fails_has_no_boundary_to_tell() -> None:
    assert boundary(sampled(lambda a, b, kind: False)) == ["basic in One: passes all 120 cases."]
    assert boundary(sampled(lambda a, b, kind: True)) == ["basic in One: fails all 120 cases."]


def test_a_rules_chance_is_that_of_fishers_test_over_all_rules() -> None:
    values, failed = list(range(12)), np.array([True] * 4 + [False] * 8)
    rule = best_rule(number(values), failed)
    assert rule is not None
    assert (rule.low, rule.high) == (-math.inf, 3.5)
    thresholds = 2 * 11
    assert math.exp(rule.log_chance) == pytest.approx(2 * thresholds / math.comb(12, 4))


def test_the_best_rule_is_that_of_the_obvious_search() -> None:
    dice = random.Random(8)
    for _ in range(20):
        values = sorted(dice.uniform(0, 1) for _ in range(14))
        failed = np.array([dice.random() < (0.8 if 0.3 < value < 0.7 else 0.2) for value in values])
        if failed.all() or not failed.any():
            continue
        rule = best_rule(number(values), failed)
        assert rule is not None

        def chance(first: int, last: int, failed: Any = failed) -> float:
            drawn, hits, bad = last - first, int(failed[first:last].sum()), int(failed.sum())
            ways = sum(math.comb(bad, k) * math.comb(14 - bad, drawn - k) for k in range(hits, min(bad, drawn) + 1))
            return ways / math.comb(14, drawn)

        spans = [span for span in itertools.combinations(range(15), 2) if span != (0, 14)]
        ends = [span for span in spans if 0 in span or 14 in span]
        best = min(
            2 * len(kind) * min(chance(*span) for span in kind) for kind in (ends, [s for s in spans if s not in ends])
        )
        assert math.exp(rule.log_chance) == pytest.approx(best, rel=1e-6)


def test_a_threshold_is_known_by_the_shortest_number_that_lies_between() -> None:
    assert between(3.08, 3.13) == 3.1
    assert between(2.0, 4.0) == 3.0
    assert between(0.12341, 0.12352) == 0.1235
    assert 1.0 < between(1.0, 1.0 + 1e-9) < 1.0 + 1e-9


def test_agents_are_studied_apart_and_what_was_not_judged_is_left_out() -> None:
    document = sweep(60, agents=("basic", "forward"))
    for row in document["cases"][:10]:
        row["results"]["forward"]["verdict"] = "SIMULATOR_FAULT"
    basic, forward = studies(document)
    assert (len(basic.failed), basic.unjudged) == (60, 0)
    assert (len(forward.failed), forward.unjudged) == (50, 10)
    assert [axis.name for axis in basic.axes] == ["gap", "speed", "delay", "kind"]


def test_a_run_without_a_sweep_and_one_that_varied_nothing_have_no_map() -> None:
    assert boundary(matrix()) == []
    assert sweep_map(matrix()) == ""
    still = sampled(lambda a, b, kind: False)
    for row in still["cases"]:
        row["parameters"] = row["parameters"][3:]
    assert sweep_map(still) == ""


def test_the_map_lies_between_the_two_parameters_that_matter() -> None:
    pair = best_pair(studies(sweep())[0])
    assert pair is not None
    assert {pair.x.name, pair.y.name} == {"gap", "speed"}
    assert pair.tells
    assert pair.right > 185


def styles(picture: str) -> list[str]:
    return [part.get("class", "") for part in ET.fromstring(picture).iter()]


def test_every_case_is_on_the_map_by_shape_and_colour() -> None:
    found = styles(sweep_map(sweep()))
    assert (found.count("pass") - 1, found.count("fail") - 1) == (169, 31)  # one of each in the legend
    assert found.count("boundary") == 1


def test_a_grid_with_more_parameters_than_two_counts_the_cases_at_each_place() -> None:
    document = grid(4)
    more = [
        dict(row, parameters=[*row["parameters"], {"name": "kind", "value": kind, "unit": "", "about": ""}])
        for row in document["cases"]
        for kind in ("car", "bus")
    ]
    found = styles(sweep_map({**document, "cases": more}))
    assert found.count("together") == 16


def test_where_one_parameter_varied_the_map_shows_how_narrowly() -> None:
    document = sweep(40)
    for row in document["cases"]:
        row["parameters"] = row["parameters"][:1]
    assert "least distance, m" in sweep_map(document)


def test_the_same_sweep_gives_the_same_bytes() -> None:
    assert sweep_map(sweep(80)) == sweep_map(sweep(80))


def test_the_area_above_a_level_is_that_of_the_values() -> None:
    """A plane that rises to the east crosses one half in the middle: half of the plot, its edge from top to bottom."""
    share = np.broadcast_to(np.linspace(0.0, 1.0, 11), (6, 11))
    area, edge = region(share, 0.5)
    assert polygon_area(area) == pytest.approx(WIDTH_PX * HEIGHT_PX / 2.0, rel=1e-3)
    ends = [float(word) for stroke in edge.split("M")[1:] for word in stroke.split()]
    assert set(ends[0::2]) == {LEFT_PX + WIDTH_PX / 2.0}
    assert (min(ends[1::2]), max(ends[1::2])) == (TOP_PX, TOP_PX + HEIGHT_PX)


def polygon_area(path: str) -> float:
    """Of a path of rectangles (h, v) and polygons."""
    total = 0.0
    for piece in path.replace("z", "").split("M")[1:]:
        if "h" in piece:
            _, _, sides = piece.partition("h")
            across, _, rest = sides.partition("v")
            total += float(across) * float(rest.partition("h")[0])
        else:
            flat = [float(word) for word in piece.split()]
            corners = list(zip(flat[0::2], flat[1::2], strict=True))
            total += (
                abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in zip(corners, corners[1:] + corners[:1], strict=True))) / 2
            )
    return total


def test_a_case_that_was_not_exercised_is_missing_and_neither_passes_nor_fails() -> None:
    document = sweep(60)
    for row in document["cases"][:20]:
        row["results"]["basic"]["verdict"] = "NOT_EXERCISED"
    (study,) = studies(document)
    assert (len(study.failed), study.absent) == (40, 20)
    assert not {row["id"] for row in document["cases"][:20]} & set(study.ids)
    assert "20 more cases were not exercised and are left out." in sentences(boundary_of(study))
