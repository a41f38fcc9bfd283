"""Careful drivers: four public models of UN Regulation 157, and what each would have done in a recorded encounter.

The models are pure functions over arrays of encounters: `basu.metrics.careful_driver.fsm`, ``human``, ``rss`` and
``reg157``. Module ``simulation`` lets them drive. Module ``counterfactual`` puts them in the place of the vehicle under
test. The tests let them drive the cases by which the Joint Research Centre compares them.
"""
