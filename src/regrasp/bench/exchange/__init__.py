"""The benchmark's problems for other programs: as files, and as a test set of qpbenchmark."""

from regrasp.bench.exchange.cbf import read_cbf, write_cbf
from regrasp.bench.exchange.manifest import export
from regrasp.bench.exchange.npz import read_npz, write_npz

__all__ = ["export", "read_cbf", "read_npz", "write_cbf", "write_npz"]
