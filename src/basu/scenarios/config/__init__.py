"""Cases as files: ScenarioRunner's XML and what of it a case is made of."""
