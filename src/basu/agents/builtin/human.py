"""The human agent: a person drives, by keyboard, gamepad or wheel, and may hand over to the basic driver.

The driver is at it all the while, as a driving instructor is: it looks and decides, and what it decides counts while
the person lets it. Who takes the wheel and what is done with it: ``basu.agents.manual.person``.
"""

from __future__ import annotations

from basu.agents.builtin.basic import BasicAgent


class HumanAgent(BasicAgent):
    """What drives while the person does not; BASU seats a person before whoever is one of these."""

    driven_by_person = True

    def config(self) -> dict[str, str]:
        """The route, sensors, car and weather of the thesis's test runs."""
        return {
            "routes": "routes/linden_short.xml",
            "sensors": "config/sensors.json",
            "vehicle": "vehicle.tesla.model3",
            "weather": "ClearSunset",
        }
