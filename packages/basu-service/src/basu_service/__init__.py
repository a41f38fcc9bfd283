"""A shuttle service with passengers: demand, boarding, holding, falls and headways of vehicles that BASU tests.

``basu service run`` drives it. Begin reading at :mod:`basu_service.operation`.
"""
