"""Documents of scenario runs that never took place: a case with its record, a matrix, a sweep with a known boundary."""

import json
import math
import random
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from basu.output.report.streets import Line, Streets
from basu.records.history import FRAME, Collision, Facts, History, Recorder
from basu.records.history.model import NO_LIGHT
from basu.scenarios.share_documents import results_from, shares_to_json
from basu.scenarios.shares import crash_shares
from fakes.drives import STEP_S, VEHICLE, straight_route

WALKER = 47
STREETS: list[Line] = [
    [(-60.0, -1.75), (160.0, -1.75)],
    [(-60.0, 1.75), (160.0, 1.75)],
    [(62.0, -80.0), (62.0, 80.0)],
    [(65.5, -80.0), (65.5, 80.0)],
]
NAMED = Streets(STREETS, ["Long Street", "Long Street", "", ""])
GROUPS = {
    "control loss": ("ControlLoss",),
    "pedestrian": ("PedestrianCrossing", "OccludedChild"),
    "rear-end": ("FollowLeadingVehicle",),
    "shuttle": ("UnexpectedStop",),
}
CHARACTERISTICS = {"atmosphere": "rain", "lighting": "dark", "surface": "wet", "alignment": "straight"}
VERDICT_FAULTS = {
    "SUCCESS": "none",
    "FAILURE": "none",
    "AGENT_FAULT": "agent",
    "NOT_EXERCISED": "none",
    "SIMULATOR_FAULT": "simulator",
    "SETUP_FAULT": "setup",
    "BENCHMARK_FAULT": "benchmark",
    "INTERRUPTED": "user",
}


def crossing(*, brakes: bool = True, seconds: float = 12.0) -> History:
    """East at 6 m/s; a walker crosses from the right at x = 50 m. Who brakes stops before; who does not hits it."""
    recorder, x_m, speed_mps = Recorder(), 0.0, 6.0
    contact = None
    for tick in range(round(seconds / STEP_S)):
        t_s = tick * STEP_S
        walker_y_m = 7.0 - 1.5 * max(0.0, t_s - 4.0)
        if brakes and t_s > 4.5:
            in_the_way = abs(walker_y_m) < 3.0 or walker_y_m > 0.0
            gain_mps2 = -2.5 if in_the_way and 45.0 - x_m < speed_mps**2 / 5.0 else 1.5
            speed_mps = min(6.0, max(0.0, speed_mps + gain_mps2 * STEP_S))
        if not brakes and contact is None and abs(walker_y_m) < 1.3 and abs(x_m - 50.0) < 2.3:
            contact = Collision(tick=tick, other_id=WALKER, other_type="walker.pedestrian.0001", impulse_ns=(-90, 0, 0))
            speed_mps = 5.0
        values = {
            "tick": tick,
            "t_s": t_s,
            "x_m": x_m,
            "y_m": 1.75,
            "velocity_x_mps": speed_mps,
            "traffic_light_state": NO_LIGHT,
            "route_light": NO_LIGHT,
            "route_s_m": x_m,
            "lane_width_m": 3.5,
        }
        recorder.frame([float(values.get(name, 0.0)) for name in FRAME.names or ()])
        recorder.others([(tick, WALKER, 50.0, walker_y_m, 0.9, -math.pi / 2, 0.0, -1.5)])
        if contact is not None and contact.tick == tick:
            recorder.collision(contact)
        x_m += speed_mps * STEP_S
    return recorder.history(
        Facts(
            step_s=STEP_S,
            vehicle=VEHICLE,
            route=straight_route(120.0),
            actor_types={WALKER: "walker.pedestrian.0001"},
            actor_sizes={WALKER: (0.25, 0.25)},
        )
    )


def case_result(**changes: Any) -> dict[str, Any]:
    """The case of a result; ``changes`` replace its entries."""
    document: dict[str, Any] = {
        "id": "pedestrian_crossing_1",
        "scenario": "PedestrianCrossing",
        "title": "Somebody walks across the street.",
        "group": "pedestrian",
        "place": "Cleveland Avenue, north of Myrtle Avenue",
        "on_route": True,
        "characteristics": dict(CHARACTERISTICS),
        "pre_crash": [12],
        "measured": {"posted_mps": 11.2, "travel_mps": 6.0, "in_bend": False, "level": True},
        "agent": "basic",
        "vehicle": "vehicle.easymile.ez10",
        "seed": 0,
        "town": "Linden",
        "parameters": [
            {"name": "speed", "value": 1.5, "unit": "m/s", "about": "of the walker"},
            {"name": "ahead", "value": 50.0, "unit": "m", "about": "of the trigger point"},
            {"name": "from", "value": "right", "unit": "", "about": "the side it comes from"},
        ],
        "verdict": "SUCCESS",
        "fault": "none",
        "status": "Completed",
        "message": "The walker was let by, 1.2 m at the least, and the end of the route was reached.",
        "assessment": assessment("SUCCESS"),
        "collisions": [],
        "phases_s": {"setup": 0.0, "trigger": 0.0, "conflict": 4.0, "resolution": 9.0, "end": 11.5},
        "judgements": [
            judgement("no collision", True, sentence="Nobody was touched."),
            judgement(
                "least distance",
                None,
                measured=1.2,
                unit="m",
                limit="at least 0.5 m",
                sentence="1.20 m to the walker at 8.1 s, the ego at 0.0 m/s.",
                deciding=False,
                t_s=8.1,
                other="walker",
            ),
            judgement("arrives", True, sentence="The end of the route was reached after 11.5 s."),
        ],
        "margins": {"distance_m": 1.2, "ttc_s": 1.9, "pet_s": None},
        "tree": tree(),
        "actors": [{"id": WALKER, "role": "walker", "type": "walker.pedestrian.0001"}],
        "things": [
            {"name": "hedge", "x_m": 44.0, "y_m": 6.5, "yaw_rad": 0.0, "half_length_m": 2.0, "half_width_m": 0.5}
        ],
        "scenarios_file": "pedestrian.xml",
        "command": ["basu", "scenario", "run", "pedestrian_crossing_1", "--agent", "basic", "--seed", "0"],
        "simulated_s": 12.0,
        "wall_s": 0.9,
    }
    return {**document, **changes}


def assessment(verdict: str) -> dict[str, Any] | None:
    """The policy's answers that lead to a verdict; None for a fault."""
    if verdict not in {"SUCCESS", "FAILURE", "NOT_EXERCISED"}:
        return None
    return {
        "safe": {"holds": verdict != "FAILURE", "sentence": "no collision, no near miss"},
        "completed": {"holds": verdict == "SUCCESS", "sentence": "arrives, in time"},
        "exercised": {"holds": verdict != "NOT_EXERCISED", "sentence": "the ego would have met walker"},
    }


def collision() -> dict[str, Any]:
    """A contact with the walker."""
    return {
        "t_s": 8.0,
        "other": "walker",
        "speed_mps": 6.0,
        "at_fault": True,
        "kind": "front",
        "sentence": "at fault: the ego's front met the other at 6.00 m/s",
    }


def failed(**changes: Any) -> dict[str, Any]:
    """The result of a case in which the walker was hit."""
    hit = judgement(
        "no collision",
        False,
        sentence="Hit the walker at 8.0 s at 6.0 m/s.",
        t_s=8.0,
        x_m=48.0,
        y_m=1.75,
        other="walker",
    )
    return case_result(
        **{
            "verdict": "FAILURE",
            "message": "Hit the walker at 8.0 s at 6.0 m/s.",
            "assessment": assessment("FAILURE"),
            "collisions": [collision()],
            "judgements": [hit],
            "margins": {"distance_m": 0.0, "ttc_s": 0.0, "pet_s": None},
            "phases_s": {"setup": 0.0, "trigger": 0.0, "conflict": 4.0},
            **changes,
        }
    )


def judgement(criterion: str, passed: bool | None, **changes: Any) -> dict[str, Any]:  # noqa: FBT001 - so a criterion says it
    """What one criterion said."""
    empty: dict[str, Any] = dict.fromkeys(("measured", "t_s", "x_m", "y_m", "other"))
    return {
        "criterion": criterion,
        "passed": passed,
        "deciding": True,
        "unit": "",
        "limit": "",
        "sentence": "",
        **empty,
        **changes,
    }


def tree() -> dict[str, Any]:
    """A scenario's tree as it stood at the end."""

    def node(name: str, kind: str, status: str, feedback: str = "", *children: dict[str, Any]) -> dict[str, Any]:
        return {"name": name, "kind": kind, "status": status, "feedback": feedback, "children": list(children)}

    return node(
        "PedestrianCrossing",
        "sequence",
        "SUCCESS",
        "",
        node(
            "trigger", "sequence", "SUCCESS", "", node("ego 6 s from crossing", "trigger", "SUCCESS", "ego at 24.0 m")
        ),
        node("conflict", "sequence", "SUCCESS", "", node("walker crosses", "action", "SUCCESS", "walked 8.0 m")),
        node(
            "criteria", "parallel", "SUCCESS", "", node("no collision", "criterion", "SUCCESS", "Nobody was touched.")
        ),
    )


def matrix(agents: Sequence[str] = ("basic", "behavioral", "forward"), instances: int = 3) -> dict[str, Any]:
    """All groups, some instances each: `forward` fails, `behavioral` passes, `basic` fails every fifth."""
    cases = []
    for group, scenarios in GROUPS.items():
        for scenario in scenarios:
            for number in range(1, instances + 1):
                verdicts = {
                    agent: "FAILURE" if agent == "forward" or (agent == "basic" and len(cases) % 5 == 4) else "SUCCESS"
                    for agent in agents
                }
                cases.append(case(f"{snake(scenario)}_{number}", scenario, group, verdicts))
    return matrix_of(cases, agents)


def matrix_of(cases: Sequence[dict[str, Any]], agents: Sequence[str], **changes: Any) -> dict[str, Any]:
    """The document of a run with these cases."""
    return {
        "schema_version": 2,
        "started": "2026-11-22T03:00:00+00:00",
        "what": "all",
        "agents": list(agents),
        "vehicle": None,
        "seed": 0,
        "sweep": None,
        "wall_s": 412.0,
        "workers": 2,
        "cases": list(cases),
        "shares": {agent: shares(cases, agent) for agent in agents},
        "versions": {"basu": "0.1.0"},
        **changes,
    }


def shares(cases: Sequence[dict[str, Any]], agent: str) -> dict[str, Any]:
    """What the results of one agent stand for, as `basu.scenarios.share_documents` writes it."""
    documents = [{**case, **case["results"][agent]} for case in cases if agent in case["results"]]
    plain: dict[str, Any] = json.loads(json.dumps(shares_to_json(crash_shares(results_from(documents)))))
    return plain


def case(
    id_: str,
    scenario: str,
    group: str,
    verdicts: Mapping[str, str],
    parameters: Sequence[dict[str, Any]] = (),
    distance_m: float = 1.25,
) -> dict[str, Any]:
    """A row of a matrix."""
    return {
        "id": id_,
        "scenario": scenario,
        "title": f"{scenario}, in a line.",
        "group": group,
        "place": "Cleveland Avenue",
        "on_route": True,
        "characteristics": dict(CHARACTERISTICS),
        "pre_crash": [],
        "parameters": list(parameters),
        "results": {agent: told(verdict, id_, agent, distance_m) for agent, verdict in verdicts.items()},
    }


def told(verdict: str, id_: str, agent: str, distance_m: float) -> dict[str, Any]:
    """A cell of a matrix."""
    is_hit = verdict == "FAILURE"
    return {
        "verdict": verdict,
        "fault": VERDICT_FAULTS[verdict],
        "status": "Completed",
        "message": "Hit the walker at 8.0 s at 6.0 m/s." if is_hit else f"As {verdict} has it.",
        "assessment": assessment(verdict),
        "collisions": [collision()] if is_hit else [],
        "margins": {"distance_m": 0.0 if is_hit else distance_m, "ttc_s": 0.0 if is_hit else 1.9, "pet_s": None},
        "simulated_s": 12.0,
        "wall_s": 0.9,
        "folder": f"{agent}/{id_.replace(':', '_')}",
    }


def sweep(count: int = 200, seed: int = 7, agents: Sequence[str] = ("basic",)) -> dict[str, Any]:
    """A case with four parameters, sampled: who has a gap below 3.1 m and a speed above 5 m/s fails, but for noise."""
    dice = random.Random(seed)
    cases = []
    for index in range(count):
        gap_m, speed_mps = dice.uniform(1.0, 8.0), dice.uniform(2.0, 10.0)
        delay_s, kind = dice.uniform(0.0, 2.0), dice.choice(["car", "bicycle"])
        is_hit = gap_m + 0.2 * dice.gauss(0.0, 1.0) < 3.1 and speed_mps + 0.2 * dice.gauss(0.0, 1.0) > 5.0
        parameters = [
            {"name": "gap", "value": round(gap_m, 4), "unit": "m", "about": "left before the leader"},
            {"name": "speed", "value": round(speed_mps, 4), "unit": "m/s", "about": "of the leader"},
            {"name": "delay", "value": round(delay_s, 4), "unit": "s", "about": "before it brakes"},
            {"name": "kind", "value": kind, "unit": "", "about": "of leader"},
        ]
        id_ = f"follow_leading_vehicle_1:sweep-{count}-{seed}-{index}"
        verdicts = dict.fromkeys(agents, "FAILURE" if is_hit else "SUCCESS")
        cases.append(case(id_, "FollowLeadingVehicle", "rear-end", verdicts, parameters, max(0.1, gap_m - 2.0)))
    told_sweep = {
        "n": count,
        "seed": seed,
        "vary": ["gap", "speed", "delay", "kind"],
        "case": "follow_leading_vehicle_1",
    }
    return matrix_of(cases, agents, what="follow_leading_vehicle_1", sweep=told_sweep)


def grid(side: int = 5) -> dict[str, Any]:
    """The same case on a grid of two parameters; who is nearer than 2 m at more than 4 m/s fails."""
    cases = []
    for row, gap_m in enumerate(np.linspace(1.0, 5.0, side).tolist()):
        for column, speed_mps in enumerate(np.linspace(2.0, 10.0, side).tolist()):
            parameters = [
                {"name": "gap", "value": gap_m, "unit": "m", "about": "left before the leader"},
                {"name": "speed", "value": speed_mps, "unit": "m/s", "about": "of the leader"},
            ]
            id_ = f"follow_leading_vehicle_1:grid-{side}-{row * side + column}"
            verdict = "FAILURE" if gap_m <= 2.0 and speed_mps > 4.0 else "SUCCESS"
            cases.append(case(id_, "FollowLeadingVehicle", "rear-end", {"basic": verdict}, parameters))
    told_sweep = {"grid": side, "vary": ["gap", "speed"]}
    return matrix_of(cases, ["basic"], what="follow_leading_vehicle_1", sweep=told_sweep)


def snake(name: str) -> str:
    """CamelCase as a case's name has it."""
    return "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in name).lstrip("_")
