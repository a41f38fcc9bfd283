from basu.agents.autonomous_agent import AutonomousAgent as AutonomousAgent
from basu.api import close_simulator as close_simulator
from basu.api import load as load
from basu.api import open_simulator as open_simulator
from basu.api import run as run
from basu.api import run_scenarios as run_scenarios
from basu.metrics.scoring import Scoring as Scoring

__version__: str
