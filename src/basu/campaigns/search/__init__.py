"""Adaptive drives: a search for the boundary of failure, and the estimate of a rare failure's probability.

Both propose drives in rounds. A round is computed from the complete rounds before it. So the order in which workers
finish does not matter.

``space`` has the parameters, and ``strands`` the state of every search. ``boundary_search`` and ``rare_event`` are the
two ways to propose. ``surrogate`` is the model of the boundary. ``findings`` has what the report says.
"""
