"""Empty package; the checks of OpenDRIVE maps are in ``linden.authoring.checks``."""
