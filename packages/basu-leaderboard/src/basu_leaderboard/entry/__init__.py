"""A folder of its own: hosts that load the agent's file put its folder first in ``sys.path``."""
