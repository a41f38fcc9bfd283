"""The tables: for every public member of the official client a small call that says what is plausible."""
