"""Files of OpenSCENARIO XML 1.0 to 1.3 as dataclasses, with parameters, expressions and catalogs resolved."""
