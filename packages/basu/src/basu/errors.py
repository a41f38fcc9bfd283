"""The errors of a benchmark run, drawn as a tree by cause: agent, simulator, scenario or user.

::

    BasuError
    ├── UserError       the set-up's: something that was typed or given cannot be used
    │   └── ScenarioError   a scenario's own: its class, its file or its place cannot be used
    ├── AgentError      the agent's: it raised, hung, or returned what is not a control
    └── SimulatorError  the simulator's: it went away, or did not answer in time

Anything else that is raised is a bug of ours. It is shown with its traceback and never scored as the agent's failure.
"""


class BasuError(Exception):
    """Base of all errors that carry a sentence for a reader."""


class UserError(BasuError):
    """What was typed or given cannot be used: says which, why, and what to do next."""


class ScenarioError(UserError):
    """A scenario cannot be played: its class raised, or it asks for what is not there."""


class AgentError(BasuError):
    """The agent under test failed; what was measured until then is kept and scored."""


class AgentCrashedError(AgentError):
    """The agent raised; the text names the exception and the line of the agent's file."""


class AgentTimedOutError(AgentError):
    """The agent took longer than its limit over one call."""


class AgentEndedOutsideError(AgentError):
    """The system ended the agent's process for want of memory that others used: no failure of the agent's."""


class AgentInvalidControlError(AgentError):
    """The agent returned something that is not a usable ``carla.VehicleControl``."""


class SimulatorError(BasuError):
    """The simulator does not answer, went away, or could not be started."""


class Terminated(KeyboardInterrupt):
    """SIGTERM: the run ends as by Ctrl-C, and says what ended it."""

    def __init__(self) -> None:
        """Say what ended the run."""
        super().__init__("terminated by SIGTERM")
