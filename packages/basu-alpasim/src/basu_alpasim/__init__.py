"""AlpaSim's ``egodriver`` protocol: its policies as agents of BASU, and agents of BASU as policies."""

import os

os.environ.setdefault(
    "GRPC_VERBOSITY", "ERROR"
)  # a policy that ends its connection is reported by BASU, not by gRPC too
