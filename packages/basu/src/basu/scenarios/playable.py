"""A case with its class and parameter values, and the selection of cases by their characteristics."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from basu.errors import ScenarioError
from basu.scenarios import library as catalogue
from basu.scenarios.characteristics import characteristics_of, read_where
from basu.scenarios.named_models import with_named_models
from basu.scenarios.nhtsa import stands_for
from basu.scenarios.parameters import narrowed

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from basu.scenarios.parameters import Parameter, Value
    from basu.scenarios.scenario import Scenario
    from basu.scenarios.stage import ActorSpec
    from basu.scenarios.xml_elements import Case


class Playable(NamedTuple):
    """A case with its class, and a value for each of its parameters."""

    case: Case
    scenario: type[Scenario]
    values: Mapping[str, Value]
    unread: tuple[str, ...] = ()  # values that ScenarioRunner's class reads and ours does not

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The scenario's, as the case narrows them for its place."""
        return narrowed(self.scenario.parameters, self.case.values)[0]

    @property
    def is_of_basu(self) -> bool:
        """Return whether the class comes with BASU. Such a class places its actors relative to the ego's route."""
        return self.scenario.__module__.startswith(f"{catalogue.__name__}.")

    def cast(self, scenario: Scenario) -> Sequence[ActorSpec]:
        """Return the actors of ``scenario``, this case at its place, with the models that the case's file names.

        Raises:
            ScenarioError: an ``<other_actor>`` belongs to none of them, or names a model of another kind.
        """
        specs = scenario.actors()
        if not self.case.others or not self.is_of_basu:
            return specs
        return with_named_models(specs, self.case.others, self.scenario.__name__)

    def about(self) -> dict[str, Any]:
        """Which case of which scenario, and its parameters, as plain values for a result."""
        scenario = self.scenario
        return {
            "id": self.case.name,
            "scenario": scenario.__name__,
            "title": scenario.title(),
            "group": scenario.group.value,
            "pre_crash": [kind.number for kind in stands_for(scenario.__name__, scenario.group, scenario.pre_crash)],
            "characteristics": characteristics_of(self.case, self.scenario).document(),
            "parameters": [
                {"name": p.name, "value": self.values[p.name], "unit": p.unit, "about": p.about}
                for p in scenario.parameters
            ],
        }


def having(playables: Sequence[Playable], conditions: Sequence[tuple[str, str]]) -> tuple[Playable, ...]:
    """The cases with all requested characteristics.

    Raises:
        ScenarioError: there is no such field or value, or no case has them all.
    """
    wanted = read_where(conditions)
    found = tuple(one for one in playables if characteristics_of(one.case, one.scenario).among(wanted))
    if not found and playables:
        said = " and ".join(f"{field}={text}" for field, text in conditions)
        raise ScenarioError(f"none of the {len(playables)} cases has {said}; `basu scenario list --json` shows them")
    return found
