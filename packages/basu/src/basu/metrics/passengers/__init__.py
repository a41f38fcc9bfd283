"""The ride as its standing passengers felt it: pure functions of a History, none of them part of the thesis's score."""

from basu.metrics.passengers.felt import STANDING, Felt, PassengerPlace, felt

__all__ = ["STANDING", "Felt", "PassengerPlace", "felt"]
