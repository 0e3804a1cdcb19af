"""Files of contact regions: by how much fingers may miss, to be judged by ``verify``."""

from pathlib import Path
from typing import cast

from regrasp.files.plans.claims import holds_claim, read_claim, write_claim
from regrasp.planning.placement.regions.contact_arcs import ContactRegions
from regrasp.planning.placement.regions.face_patches import FaceRegions

FORMATS: dict[str, type[ContactRegions | FaceRegions]] = {
    "regrasp regions": ContactRegions,
    "regrasp face regions": FaceRegions,
}


def write_regions(regions: ContactRegions | FaceRegions, path: str | Path) -> None:
    """Write contact regions with everything needed to read them back and verify them.

    Args:
        regions: what ``regrasp.contact_regions`` found, on an outline or a mesh.
        path: the file, in JSON.

    Raises:
        InvalidInput: For what is no regions, and where the file cannot be written.
    """
    write_claim(regions, path, FORMATS, "write_regions")


def read_regions(path: str | Path) -> ContactRegions | FaceRegions:
    """The regions of a file that ``write_regions`` wrote; judge them with ``regrasp.verify``.

    Args:
        path: a file that ``write_regions`` wrote.

    Raises:
        InvalidInput: For a file that holds no regions, or some that were changed.
    """
    return cast(ContactRegions | FaceRegions, read_claim(path, FORMATS, "regions"))


def holds_regions(path: Path) -> bool:
    """Whether a file says that it is of regions."""
    return holds_claim(path, FORMATS)
