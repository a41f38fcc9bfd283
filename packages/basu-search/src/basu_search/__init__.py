"""Adaptive drives: a search for the boundary of failure, and the estimate of a rare failure's probability.

Both propose drives in rounds. A round is computed from the complete rounds before it. So the order in which workers
finish does not matter.

The parameters are in ``space``. The state of every search is in ``search_states``. Two modules propose drives:
``boundary_search`` and ``rare_event``. The model of the boundary is in ``surrogate``, and what the report says in
``findings``.
"""
