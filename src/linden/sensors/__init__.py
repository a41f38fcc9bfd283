"""What sensors measure: pure functions of the state, one file a sensor."""
