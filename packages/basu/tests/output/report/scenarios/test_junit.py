"""Claims about junit.xml: as the schemas in use have it, whatever messages hold, each verdict where servers look."""

import pytest
from lxml import etree

from basu.output.report.scenarios.junit import MESSAGE_CHARACTERS, MOST_CHARACTERS, junit_xml
from fakes.scenario_documents import case, matrix, matrix_of, told

# What both schemas in use ask for, the one for Apache Ant (windyroad/JUnit-Schema) and that of Jenkins (xunit-plugin),
# in our own words: a document that is valid by this is valid by both.
SCHEMA = """
<grammar xmlns="http://relaxng.org/ns/structure/1.0" datatypeLibrary="http://www.w3.org/2001/XMLSchema-datatypes">
  <start><element name="testsuites"><zeroOrMore><ref name="suite"/></zeroOrMore></element></start>
  <define name="suite"><element name="testsuite">
    <attribute name="id"><data type="int"/></attribute>
    <attribute name="name"><data type="token"><param name="minLength">1</param></data></attribute>
    <attribute name="package"><data type="token"/></attribute>
    <attribute name="timestamp">
      <data type="dateTime"><param name="pattern">[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}</param></data>
    </attribute>
    <attribute name="hostname"><data type="token"><param name="minLength">1</param></data></attribute>
    <attribute name="tests"><data type="int"/></attribute>
    <attribute name="failures"><data type="int"/></attribute>
    <attribute name="errors"><data type="int"/></attribute>
    <attribute name="skipped"><data type="int"/></attribute>
    <attribute name="time"><data type="string"><param name="pattern">[0-9]+\\.[0-9]+</param></data></attribute>
    <element name="properties"><zeroOrMore><element name="property">
      <attribute name="name"><data type="token"><param name="minLength">1</param></data></attribute>
      <attribute name="value"/>
    </element></zeroOrMore></element>
    <zeroOrMore><element name="testcase">
      <attribute name="name"><data type="token"><param name="minLength">1</param></data></attribute>
      <attribute name="classname"><data type="token"/></attribute>
      <attribute name="time"><data type="string"><param name="pattern">[0-9]+\\.[0-9]+</param></data></attribute>
      <optional><choice>
        <element name="failure"><attribute name="type"/><attribute name="message"/><text/></element>
        <element name="error"><attribute name="type"/><attribute name="message"/><text/></element>
        <element name="skipped"><attribute name="message"/></element>
      </choice></optional>
    </element></zeroOrMore>
    <element name="system-out"><text/></element>
    <element name="system-err"><text/></element>
  </element></define>
</grammar>
"""
HOSTILE = "a\x00b\x1b[31m \ud800 ]]> </failure><error/> \u2028 " + "x" * 20_000


def parsed(document: bytes) -> etree._Element:
    root = etree.fromstring(document)
    etree.RelaxNG(etree.fromstring(SCHEMA)).assertValid(root)
    return root


def test_it_is_as_both_schemas_have_it() -> None:
    assert len(parsed(junit_xml(matrix()))) == 3


@pytest.mark.parametrize("verdict", ["FAILURE", "AGENT_FAULT", "SETUP_FAULT"])
def test_words_of_others_cannot_break_it(verdict: str) -> None:
    document = matrix([HOSTILE[:40], "dots.and spaces"])
    for row in document["cases"]:
        row["results"][HOSTILE[:40]].update(verdict=verdict, message=HOSTILE)
    document.update(what=HOSTILE, started="yesterday")
    suite = parsed(junit_xml(document))[0]
    outcome = suite.find("testcase")[0]
    assert len(outcome.get("message")) <= MESSAGE_CHARACTERS
    assert len(outcome.text or "") <= MOST_CHARACTERS


@pytest.mark.parametrize(
    ("verdict", "tag", "count"),
    [
        ("FAILURE", "failure", "failures"),
        ("AGENT_FAULT", "error", "errors"),
        ("SIMULATOR_FAULT", "skipped", "skipped"),
        ("SETUP_FAULT", "skipped", "skipped"),
        ("BENCHMARK_FAULT", "skipped", "skipped"),
        ("INTERRUPTED", "skipped", "skipped"),
    ],
)
def test_each_verdict_is_where_servers_look_for_it(verdict: str, tag: str, count: str) -> None:
    cases = [case(f"dooring_{n}", "Dooring", "lane change", {"basic": v}) for n, v in enumerate(["SUCCESS", verdict])]
    suite = parsed(junit_xml(matrix_of(cases, ["basic"])))[0]
    passed, other = suite.findall("testcase")
    assert len(passed) == 0
    assert [outcome.tag for outcome in other] == [tag]
    assert {name: suite.get(name) for name in ("tests", "failures", "errors", "skipped")} == {
        **dict.fromkeys(("failures", "errors", "skipped"), "0"),
        "tests": "2",
        count: "1",
    }


def test_a_failure_comes_with_its_evidence_and_how_to_play_it_again() -> None:
    parameters = [{"name": "gap", "value": 3.5, "unit": "m", "about": ""}]
    row = case("dooring_1", "Dooring", "pedalcyclist", {"basic": "FAILURE"}, parameters)
    (test,) = parsed(junit_xml(matrix_of([row], ["basic"])))[0].findall("testcase")
    assert test.get("classname") == "basic.pedalcyclist.Dooring"
    for words in ("Hit the walker at 8.0 s", "gap 3.5 m", "least distance 0.00 m", "basu scenario run dooring_1"):
        assert words in test[0].text


def test_the_dots_of_an_agents_name_make_no_packages() -> None:
    row = case("dooring_1", "Dooring", "lane change", {"my_agent.py": "SUCCESS"})
    (test,) = parsed(junit_xml(matrix_of([row], ["my_agent.py"])))[0].findall("testcase")
    assert test.get("classname") == "my_agent_py.lane_change.Dooring"


def test_cases_that_an_agent_did_not_come_to_are_not_in_its_suite() -> None:
    document = matrix(["basic", "forward"])
    del document["cases"][0]["results"]["forward"]
    document["cases"][1]["results"]["forward"] = told("SUCCESS", "x", "forward", 1.0)
    basic, forward = parsed(junit_xml(document))
    assert int(basic.get("tests")) == int(forward.get("tests")) + 1


def test_what_was_not_exercised_is_skipped_with_its_reason() -> None:
    document = matrix_of([case("deer_1", "DeerAtDusk", "animal", {"basic": "NOT_EXERCISED"})], ["basic"])
    (suite,) = parsed(junit_xml(document))
    assert (suite.get("failures"), suite.get("errors"), suite.get("skipped")) == ("0", "0", "1")
    (skipped,) = suite.iter("skipped")
    assert skipped.get("message").startswith("not exercised: ")


def test_a_failure_holds_the_policys_answers_and_the_responsibility_for_contacts() -> None:
    document = matrix_of([case("deer_1", "DeerAtDusk", "animal", {"basic": "FAILURE"})], ["basic"])
    (failure,) = parsed(junit_xml(document)).iter("failure")
    assert "safe: no, " in failure.text
    assert "collision at 8.00 s with walker, at fault: the ego's front met the other" in failure.text
