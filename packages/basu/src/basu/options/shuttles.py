"""Options of several vehicles under test in one run."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import NamedTuple

from basu.conditions import ROLE
from basu.errors import UserError
from basu.settings.option import Settings, option

WITH_ROLE = re.compile(r"([A-Za-z][A-Za-z0-9_-]*)=(.+)")


class Beside(NamedTuple):
    """A further shuttle of a run."""

    role: str
    agent: str | None  # as the user named it; None: that of the first shuttle


@dataclass(frozen=True, kw_only=True)
class ShuttleOptions(Settings):
    """How many vehicles a run tests at once, and which agents drive them."""

    GROUP = "agent"

    shuttles: int = option(
        1,
        "vehicles under test at once in one world, each with an agent, a record and a judgement of its own",
        is_rare=True,
        least=1,
        most=8,
    )
    beside: tuple[str, ...] = option(
        (),
        "the agent of the next shuttle, in place of AGENT again; may be given several times",
        is_rare=True,
        metavar="[ROLE=]AGENT",
        is_file=True,
    )
    headway_m: float = option(
        100.0, "along the route from one shuttle to the next at the start", is_rare=True, above=0.0
    )

    watch_shuttle: int = option(
        1,
        "the vehicle under test that --watch and ROS show, counted from 1",
        is_rare=True,
        metavar="N",
        least=1,
        most=8,
    )

    @property
    def besides(self) -> tuple[Beside, ...]:
        """The shuttles beside the first one."""
        given = [WITH_ROLE.fullmatch(each) for each in self.beside]
        agents = [each if match is None else match[2] for each, match in zip(self.beside, given, strict=True)]
        roles = [None if match is None else match[1] for match in given]
        lacking = max(0, self.shuttles - 1 - len(given))
        return tuple(
            Beside(role or f"{ROLE}_{number}", agent)
            for number, (role, agent) in enumerate(
                zip([*roles, *[None] * lacking], [*agents, *[None] * lacking], strict=True), 2
            )
        )

    def check(self) -> None:
        """Check that each shuttle has a role and an agent.

        Raises:
            UserError: there are more agents than shuttles, two shuttles have one role, or there is no such shuttle to
                watch.
        """
        count = 1 + len(self.besides)
        if self.watch_shuttle > count:
            raise UserError(
                f"--watch-shuttle {self.watch_shuttle} does not fit: the run has {count} "
                f"vehicle{'s' if count > 1 else ''} under test; give a number from 1 to {count}"
            )
        if self.shuttles > 1 and len(self.beside) >= self.shuttles:
            raise UserError(
                f"--shuttles {self.shuttles} and {len(self.beside)} agents with --beside do not fit: the first shuttle "
                f"has the agent of the run, so give --beside {self.shuttles - 1} times at most, or leave out --shuttles"
            )
        roles = [ROLE, *(each.role for each in self.besides)]
        for role in roles:
            if roles.count(role) > 1:
                raise UserError(
                    f"two shuttles have the role '{role}', and each vehicle has a role of its own; name another one "
                    "with --beside ROLE=AGENT"
                )
        super().check()
