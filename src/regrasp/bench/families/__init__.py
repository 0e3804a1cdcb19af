"""The families of the benchmark; ``FAMILIES`` has them by name."""

from regrasp.bench.families.catalogue import FAMILIES

__all__ = ["FAMILIES"]
