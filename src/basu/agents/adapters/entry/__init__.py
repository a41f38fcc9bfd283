"""A folder of its own: those who load the agent's file put its folder first in ``sys.path``."""
