"""``junit.xml``: what build servers read. A suite an agent, a class a scenario, a test a case.

Valid against both schemas in use, the one written down for Apache Ant (windyroad/JUnit-Schema, the stricter) and that
of Jenkins (xunit-plugin, junit-10.xsd). Jenkins takes what is before a class's last dot for its package, so the class
is `agent.group.Scenario`. A FAILURE is a failure, an agent that broke down an error. What is no fault of the agent's is
skipped, with the reason: all servers show that beside the rest and none counts it against the build.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from basu.output.report.scenarios.tally import LOOKS, name_of, tracks

if TYPE_CHECKING:
    from collections.abc import Sequence

# what no XML 1.0 document may hold (section 2.2), even escaped
FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
MOST_CHARACTERS = 8000  # of one text: GitLab and GitHub stop showing longer ones
MESSAGE_CHARACTERS = 300  # of the line that stands in a list of tests


def junit_xml(matrix: dict[str, Any]) -> bytes:
    """Return a matrix as JUnit's XML."""
    root = Element("testsuites")
    for number, agent in enumerate(matrix["agents"]):
        root.append(_suite(matrix, agent, number))
    indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{tostring(root, encoding="unicode")}\n'.encode()


def _suite(matrix: dict[str, Any], agent: str, number: int) -> Element:
    """Return all cases of one agent."""
    found = [(case, case["results"][agent]) for case in matrix["cases"] if agent in case["results"]]
    verdicts = [result["verdict"] for _, result in found]
    suite = Element(
        "testsuite",
        id=str(number),
        name=_token(agent),
        package="basu.scenarios",
        timestamp=_timestamp(matrix["started"]),
        hostname="localhost",  # required by the schema, and not to be disclosed
        tests=str(len(found)),
        failures=str(verdicts.count("FAILURE")),
        errors=str(verdicts.count("AGENT_FAULT")),
        skipped=str(sum(not LOOKS[verdict].is_judged for verdict in verdicts)),
        time=f"{sum(result['wall_s'] for _, result in found):.3f}",
    )
    properties = SubElement(suite, "properties")
    track = tracks(matrix)[agent]
    known = {
        "what": matrix["what"],
        **({"track": track} if track else {}),
        **{f"version {name}": text for name, text in matrix["versions"].items()},
    }
    for name, text in known.items():
        SubElement(properties, "property", name=_token(name), value=_plain(str(text)))
    for case, result in found:
        suite.append(_test(case, result, agent))
    SubElement(suite, "system-out")
    SubElement(suite, "system-err")
    return suite


def _test(case: dict[str, Any], result: dict[str, Any], agent: str) -> Element:
    """One case of one agent."""
    parents = ".".join(_token(part).replace(".", "_").replace(" ", "_") for part in (agent, case["group"]))
    test = Element(
        "testcase",
        name=_token(name_of(case)),
        classname=f"{parents}.{case['scenario']}",
        time=f"{result['wall_s']:.3f}",
    )
    verdict = result["verdict"]
    if verdict == "SUCCESS":
        return test
    if LOOKS[verdict].is_judged:
        message = _plain(result["message"])[:MESSAGE_CHARACTERS]
        outcome = SubElement(test, "failure" if verdict == "FAILURE" else "error", type=verdict, message=message)
        outcome.text = _plain("\n".join(_evidence(case, result)))[:MOST_CHARACTERS]
    else:
        message = _plain(f"{LOOKS[verdict].word}: {result['message']}")[:MESSAGE_CHARACTERS]
        SubElement(test, "skipped", message=message)
    return test


def _evidence(case: dict[str, Any], result: dict[str, Any]) -> Sequence[str]:
    """Return the lines that stand with a test that was not passed."""
    parameters = ", ".join(
        f"{parameter['name']} {_value(parameter['value'])} {parameter['unit']}".rstrip()
        for parameter in case["parameters"]
    )
    units = {"distance_m": "m", "ttc_s": "s", "pet_s": "s"}
    margins = [
        f"least {key.partition('_')[0]} {value:.2f} {units[key]}"
        for key, value in result["margins"].items()
        if value is not None and key in units
    ]
    lines = [
        result["message"],
        *(f"{name}: {_answer(found)}" for name, found in (result["assessment"] or {}).items()),
        *(f"collision at {one['t_s']:.2f} s with {one['other']}, {one['sentence']}" for one in result["collisions"]),
        f"{case['scenario']}: {case['title']}",
        f"at {case['place']}" if case["place"] else "",
        f"with {parameters}" if parameters else "",
        "; ".join(margins),
        f"files: {result['folder']}",
        f"again, with this agent: basu scenario run {case['id']}",
    ]
    return [line for line in lines if line]


def _answer(found: dict[str, Any]) -> str:
    """One of the policy's answers."""
    word = {True: "yes", False: "no", None: "not judged"}[found["holds"]]
    return f"{word}, {found['sentence']}"


def _value(value: float | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _timestamp(started: str) -> str:
    """Return a time as the schema has it: to the second, without a zone."""
    found = re.match(r"(\d{4}-\d{2}-\d{2})[T ](\d{2})[:-](\d{2})[:-](\d{2})", started)
    return "1970-01-01T00:00:00" if found is None else f"{found[1]}T{found[2]}:{found[3]}:{found[4]}"


def _token(text: str) -> str:
    """Return a name without line ends and doubled blanks, never empty."""
    return " ".join(_plain(text).split()) or "_"


def _plain(text: str) -> str:
    """Text without what XML cannot hold."""
    return FORBIDDEN.sub("\ufffd", text)
