"""Adapters of AlpaSim's ``egodriver`` policies and BASU's agents; the import makes gRPC log errors only."""

import os

os.environ.setdefault(
    "GRPC_VERBOSITY", "ERROR"
)  # a policy that ends its connection is reported by BASU, not by gRPC too
