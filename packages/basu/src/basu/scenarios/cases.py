"""The library of scenarios and cases: BASU's own and those of user files, found by type, group and id.

Two files of one stem belong together: FILE.xml has the cases of the classes in FILE.py beside it.
"""

from __future__ import annotations

import difflib
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Protocol

from basu import plugins
from basu.errors import ScenarioError
from basu.scenarios.case_xml import read_cases
from basu.scenarios.class_file import own_scenarios, users_scenarios
from basu.scenarios.nhtsa import Group
from basu.scenarios.parameters import narrowed, read_values
from basu.scenarios.playable import Playable
from basu.scenarios.suites.suite import read_own_values, read_suite, suite_names
from basu.scenarios.variation import variant, variants

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from basu.scenarios.scenario import Scenario
    from basu.scenarios.suites.suite import Numbers, Requirement, Suite
    from basu.scenarios.variation import Variation
    from basu.scenarios.xml_elements import Case

OWN_SUFFIXES = (".py", ".xml")  # of files that hold scenarios; plugins read others
OTHER_ACTOR = "place of other_actor"
LIBRARY = Path(__file__).parent / "library"  # the cases that come with BASU: <group>/<type in snake case>.xml
ALL = "all"
GROUP = "group:"  # before a group's name where a type is called the same
THESIS = {  # the scenarios of chapter 3 of the thesis, by their numbers there
    "I": ("ControlLoss",),
    "II": ("FollowLeadingVehicle", "FollowLeadingVehicleWithObstacle"),
    "III": ("StaticObject", "DynamicObject"),
    "IV": ("UnsignalizedIntersection",),
    "V": ("Roundabout",),
}
NAMES_OF_THE_THESIS = {"ObstacleAvoidance": "III", "ObjectAvoidance": "III"}
THEIRS = re.compile(
    "behind_vehicle_distance|bicycle_drive_distance|bicycle_speed|blocker_model|crossing_angle|direction|distance"
    "|flow_distance|flow_speed|front_vehicle_distance|offset|speed|(frequency|source_dist_interval)(_from|_to)?"
    "|(start_actor_flow|end_actor_flow|other_actor_location)_[xyz]"
)  # what ScenarioRunner's classes read: in a file of its own, no mistake


@dataclass(frozen=True, slots=True, kw_only=True)
class Library:
    """What can be played."""

    scenarios: tuple[type[Scenario], ...]  # by name, then the user's
    cases: tuple[Case, ...]  # of all files
    by_stem: Mapping[Path, tuple[Case, ...]]  # of a user's files, by their paths without .xml or .py
    suite_values: Mapping[str, Numbers] = field(default_factory=dict)  # the user's parameters of suites

    def type_of(self, case: Case) -> type[Scenario]:
        """The class of a case, by its name or an alias.

        Raises:
            ScenarioError: there is none.
        """
        for scenario in self.scenarios:
            if case.type == scenario.__name__ or case.type in scenario.aliases:
                return scenario
        names = [name for scenario in self.scenarios for name in (scenario.__name__, *scenario.aliases)]
        close = difflib.get_close_matches(case.type, names, 1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        raise ScenarioError(
            f"{case.source}: '{case.name}' is of type '{case.type}', which there is not; {hint}`basu scenario list` "
            "shows them; a class of your own goes into FILE.py beside FILE.xml, or --scenarios FILE.py; other cases of "
            "the file are played by their ids, with --scenarios FILE.xml"
        )

    def playable(self, case: Case) -> Playable:
        """A case with its class and values.

        Raises:
            ScenarioError: its type is unknown, it gives a parameter that its class has not, or a value out of range.
        """
        scenario = self.type_of(case)
        try:
            return _read(case, scenario)
        except ScenarioError as error:
            raise ScenarioError(f"{case.source}: '{case.name}' of type {case.type}: {error}") from None

    def choose(self, words: Sequence[str]) -> tuple[Playable, ...]:
        """The cases that are meant by each of the words, every one once.

        Raises:
            ScenarioError: nothing is meant by a word, or two cases have one id.
        """
        chosen: dict[str, Playable] = {}
        for word in words:
            for playable in self._meant(word):
                other = chosen.setdefault(playable.case.name, playable)
                if other.case.source != playable.case.source:
                    raise _two_of_one_name(other.case, playable.case)
        return tuple(chosen.values())

    def _meant(self, wanted: str) -> tuple[Playable, ...]:
        """The cases that are meant by `all`, a file, a case's id, a type or a group."""
        if wanted == ALL:
            return tuple(self.playable(case) for case in self.cases)
        if wanted in suite_names():
            return tuple(playable for _, playables in self.suite(wanted)[1] for playable in playables)
        path, class_name = file_in(wanted)
        if path is not None:
            return self._of_file(path, class_name)
        return self._of_thesis(wanted) or self.of_id(wanted) or self._of_kind(wanted)

    def suite(self, name: str) -> tuple[Suite, list[tuple[Requirement, tuple[Playable, ...]]]]:
        """Return a suite, and the cases of each of its requirements.

        Raises:
            ScenarioError: the suite has no parameter of a user's name, or a value of it is out of a case's range.
        """
        suite = read_suite(name, self.suite_values)
        cases = [(each, tuple(one for id_ in each.cases for one in self.of_id(id_))) for each in suite.requirements]
        return suite, cases

    def _of_thesis(self, wanted: str) -> tuple[Playable, ...]:
        """The cases of `thesis`, of `thesis:III`, or of a name of the thesis; none where it is no such word.

        Raises:
            ScenarioError: the thesis has no scenario of that number.
        """
        word, _, number = wanted.partition(":")
        named = {plain(name): numeral for name, numeral in NAMES_OF_THE_THESIS.items()}
        if plain(wanted) in named:
            number = named[plain(wanted)]
        elif plain(word) != "thesis":
            return ()
        if number and number.upper() not in THESIS:
            raise ScenarioError(f"the thesis has no scenario '{number}'; write thesis:{', thesis:'.join(THESIS)}")
        types = THESIS[number.upper()] if number else [name for names in THESIS.values() for name in names]
        chosen = [scenario for scenario in self.scenarios if scenario.__name__ in types]
        return tuple(self.playable(case) for case in self.cases if self._is_one_of(case, chosen))

    def of_id(self, identity: str) -> tuple[Playable, ...]:
        """The one case that an id means, sampled or not; none where no case begins it.

        Raises:
            ScenarioError: two cases are called so, or what stands behind the case's name cannot be done to it.
        """
        name = identity.partition(":")[0]
        same = [case for case in self.cases if case.name == name]
        if not same:
            return ()
        if len(same) > 1:
            raise _two_of_one_name(*same[:2])
        case = variant(same[0], self.playable(same[0]).parameters, identity)
        return (self.playable(case),)

    def _of_kind(self, wanted: str) -> tuple[Playable, ...]:
        """The cases of a type or a group."""
        kind = plain(wanted.removeprefix(GROUP))
        chosen = [s for s in self.scenarios if plain(s.__name__) == kind and not wanted.startswith(GROUP)]
        chosen = chosen or [s for s in self.scenarios if plain(s.group.value) == kind]
        if not chosen:
            raise ScenarioError(f"there is no scenario '{wanted}'; {self.close_to(wanted, self._kinds())}")
        found = tuple(self.playable(case) for case in self.cases if self._is_one_of(case, chosen))
        if not found:
            raise ScenarioError(f"{chosen[0].__name__} has no case; name an XML file that has one")
        return found

    def _is_one_of(self, case: Case, chosen: Sequence[type[Scenario]]) -> bool:
        """Whether a case is of these types; one of an unknown type is not."""
        return any(case.type == s.__name__ or case.type in s.aliases for s in chosen)

    def _of_file(self, path: Path, class_name: str) -> tuple[Playable, ...]:
        """The cases of a file, or those of them that are of a class."""
        cases = self.by_stem[path.resolve().with_suffix("")]
        found = tuple(self.playable(case) for case in cases if class_name in {"", case.type})
        if not found:
            raise ScenarioError(f"{path.with_suffix('.xml')} has no case{f' of type {class_name}' * bool(class_name)}")
        return found

    def _kinds(self) -> list[str]:
        """Return the words that mean several cases: types, groups and `all`."""
        return [*(snake(s.__name__) for s in self.scenarios), *(group.value for group in Group), *suite_names(), ALL]

    def close_to(self, wanted: str, kinds: Sequence[str]) -> str:
        """Return a hint for a word that means nothing: the nearest case or kind, and where to look."""
        names = [*(case.name for case in self.cases), *kinds]
        close = difflib.get_close_matches(snake(wanted.partition(":")[0]), names, 1)
        words = "a case, a type, a group, a suite, FILE.xml or all" if kinds else "a case's id"
        hint = f"did you mean '{close[0]}'?" if close else f"it may be {words}, and one of yours with --scenarios FILE;"
        return f"{hint} `basu scenario list` shows what there is"


class ScenarioFile(NamedTuple):
    """The classes and the cases in a file of a plugin's kind."""

    scenarios: Sequence[type[Scenario]]
    cases: tuple[Case, ...]


class ScenarioReader(Protocol):
    """A reader of scenario files, the entry point of a plugin that has the file's suffix as its name: "xosc".

    Its classes have the parameters ``ego`` (the entity of the ego) and ``driver`` (``agent`` or ``file``).
    """

    def __call__(self, path: Path) -> ScenarioFile:
        """Return the classes and the cases of a file.

        Raises:
            ScenarioError: it cannot be read.
        """


def open_library(files: Iterable[str | Path] = (), parameters: Path | None = None) -> Library:
    """BASU's own, and the classes and cases of a user's files; each file brings the other of its stem.

    ``parameters`` is a user's file with values of the parameters of suites.

    Raises:
        ScenarioError: a file cannot be used, or a class has the name of another.
    """
    scenarios = own_scenarios()
    cases = [case for path in sorted(LIBRARY.glob("*/*.xml"), key=lambda path: path.name) for case in read_cases(path)]
    by_stem: dict[Path, tuple[Case, ...]] = {}
    for path in files_named(files):
        stem = path.resolve().with_suffix("")
        if stem in by_stem:
            continue
        found = _read_file(path)
        _check_names(found.scenarios, scenarios, path.with_suffix(".py") if path.suffix in OWN_SUFFIXES else path)
        scenarios += found.scenarios
        by_stem[stem] = found.cases
        cases += by_stem[stem]
    values = {} if parameters is None else read_own_values(parameters)
    return Library(scenarios=tuple(scenarios), cases=tuple(cases), by_stem=by_stem, suite_values=values)


def _read_file(path: Path) -> ScenarioFile:
    """Return the classes and the cases of a user's file; a plugin reads what is neither .xml nor .py.

    Raises:
        ScenarioError: it cannot be read.
    """
    if path.suffix not in OWN_SUFFIXES:
        reader: ScenarioReader = plugins.load(plugins.SCENARIO_FILES, path.suffix[1:], f"a file {path.name}")
        return reader(path)
    classes, instances = path.with_suffix(".py"), path.with_suffix(".xml")
    return ScenarioFile(
        users_scenarios(classes) if path == classes or classes.is_file() else [],
        read_cases(instances) if path == instances or instances.is_file() else (),
    )


def cases_of(
    wanted: str | Sequence[str], files: Sequence[str | Path] = (), parameters: Path | None = None
) -> tuple[Playable, ...]:
    """The cases that are meant by each of ``wanted``, every one once; ``files`` and ``parameters`` are the user's.

    Raises:
        ScenarioError: a file cannot be used, nothing is meant by a word, or two cases have one id.
    """
    words = (wanted,) if isinstance(wanted, str) else tuple(wanted)
    return open_library([*files, *files_among(words)], parameters).choose(words)


def by_id(identity: str, files: Sequence[str | Path] = ()) -> Playable:
    """The one case that has an id, sampled or not; ``files`` are the user's, where it is one of theirs.

    Raises:
        ScenarioError: none has it.
    """
    library = open_library(files)
    found = library.of_id(identity)
    if not found:
        raise ScenarioError(f"there is no case '{identity}'; {library.close_to(identity, [])}")
    return found[0]


def varied(chosen: Iterable[Playable], variation: Variation) -> tuple[Playable, ...]:
    """All that a variation makes of cases.

    Raises:
        ScenarioError: it cannot be done to one of them.
    """
    return tuple(
        _read(case, playable.scenario)
        for playable in chosen
        for case in variants(playable.case, playable.parameters, variation)
    )


def files_among(words: Iterable[str]) -> list[str]:
    """Those of the words that name files."""
    return [word for word in words if file_in(word)[0] is not None]


def file_in(word: str) -> tuple[Path | None, str]:
    """The file that a word names, FILE.xml, FILE.py or FILE.py:Class, and the class; None where it names no file."""
    text, _, class_name = word.partition(":") if ".py:" in word else (word, "", "")
    path = Path(text)
    return (path, class_name) if _is_scenario_file(path.suffix) else (None, "")


def _is_scenario_file(suffix: str) -> bool:
    """Return whether files with this suffix hold scenarios, for BASU or for a plugin."""
    return suffix in OWN_SUFFIXES or is_of_plugin(suffix)


def is_of_plugin(suffix: str) -> bool:
    """Return whether a plugin reads files with this suffix: one that is installed, or one of this project."""
    name, own = suffix.removeprefix("."), plugins.DISTRIBUTIONS[plugins.SCENARIO_FILES]
    return name != "" and (name in own or plugins.is_installed(plugins.SCENARIO_FILES, name))


def is_led_by_file(words: Sequence[str]) -> bool:
    """Return whether all words name files of a plugin, in which an ego without an agent moves as the file has it."""
    return all(is_of_plugin(Path(word).suffix) for word in words)


def files_named(files: Iterable[str | Path]) -> tuple[Path, ...]:
    """The paths of FILE.xml, FILE.py and FILE.py:Class.

    Raises:
        ScenarioError: one is of another kind.
    """
    paths = []
    for file in files:
        path, _ = file_in(str(file))
        if path is None:
            raise ScenarioError(f"--scenarios {file}: name a FILE.py with classes or a FILE.xml with cases")
        paths.append(path)
    return tuple(paths)


def _read(case: Case, scenario: type[Scenario]) -> Playable:
    """A case with the values that its class reads.

    Parameters for ScenarioRunner's class alone are left out. Under an alias, so are parameters with a name of ours,
    such as a speed in km/h.
    """
    ours = {parameter.name for parameter in scenario.parameters} if case.type == scenario.__name__ else set()
    unread = tuple(name for name in case.values if name not in ours and THEIRS.fullmatch(name))
    given = {name: text for name, text in case.values.items() if name not in unread}
    values = read_values(*narrowed(scenario.parameters, given))
    playable = Playable(scenario.settled(case, values), scenario, values, unread)
    return playable._replace(unread=(*unread, OTHER_ACTOR)) if case.others and playable.is_of_basu else playable


def _check_names(users: Sequence[type[Scenario]], scenarios: Sequence[type[Scenario]], path: Path) -> None:
    """Refuse a user's class with the name of another class."""
    taken = {plain(name) for scenario in scenarios for name in (scenario.__name__, *scenario.aliases)}
    for scenario in users:
        if plain(scenario.__name__) in taken:
            raise ScenarioError(f"{path} has a scenario {scenario.__name__}, and so has BASU; name yours otherwise")


def _two_of_one_name(one: Case, other: Case) -> ScenarioError:
    """The error that names both."""
    return ScenarioError(f"'{one.name}' is given in {one.source} and in {other.source}; rename one")


def snake(name: str) -> str:
    """A name of a type as ids have it: FollowLeadingVehicle as follow_leading_vehicle."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).replace(" ", "_").replace("-", "_").lower()


def plain(name: str) -> str:
    """A name without what people spell in different ways: case, spaces, hyphens."""
    return re.sub(r"[^a-z0-9]", "", name.lower())
