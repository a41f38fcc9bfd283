"""AlpaSim's ``egodriver`` protocol: its policies as agents of BASU, and agents of BASU as policies."""
