"""The density volume on disk: a NumPy archive."""

from __future__ import annotations

import io
import zipfile
import zlib
from pathlib import Path

import numpy as np

from flowtree import check
from flowtree.files import write_whole
from flowtree.model.volume import DensityVolume

_NAMES = ("density", "origin", "voxel")
# Raised for a damaged archive, one that claims a size beyond memory, one of unknown packing.
_BROKEN = (OSError, ValueError, EOFError, KeyError, RuntimeError, MemoryError, zipfile.BadZipFile, zlib.error)


def save_volume(volume: DensityVolume, path: Path) -> None:
    """Writes a volume as a compressed ``.npz`` of ``density``, ``origin`` and ``voxel``, whole or not at all.

    Raises:
        OutputError: the file could not be written; what stood there is untouched.
    """
    file = io.BytesIO()
    np.savez_compressed(
        file, density=volume.density, origin=volume.origin, voxel=np.array(volume.voxel, np.float64)
    )
    write_whole(path, file.getvalue())


def load_volume(path: Path) -> DensityVolume:
    """Reads what `save_volume` wrote.

    Raises:
        InputError: no such file, not such an archive, a volume that is not finite or has negative density.
    """
    remedy = "name a file that flowtree saved"
    try:
        data = path.read_bytes()
    except OSError as error:
        check.fail(str(path), "must be a readable file", error.strerror or "another kind of file", remedy)
    try:
        with np.lib.npyio.NpzFile(io.BytesIO(data), allow_pickle=False) as archive:
            stored = {name: archive[name] for name in _NAMES if name in archive}
    except _BROKEN as error:
        reason = str(error) or "a broken one"
        check.fail(str(path), "must be an .npz archive of a density volume", reason, remedy)
    missing = [name for name in _NAMES if name not in stored]
    check.require(
        not missing, str(path), f"must hold {', '.join(_NAMES)}", f"none named {', '.join(missing)}", remedy
    )
    density = check.array(
        stored["density"], f"density in {path}", shape=(None, None, None), low=0.0, high=3.0e38
    )
    check.require(density.size > 0, f"density in {path}", "must have voxels", density.shape, remedy)
    origin = check.array(stored["origin"], f"origin in {path}", shape=(3,))
    voxel = check.array(stored["voxel"], f"voxel in {path}", shape=(), dtype=np.float64, low=0.0).item()
    check.require(voxel > 0, f"voxel in {path}", "must be longer than 0", voxel, remedy)
    return DensityVolume(density=density, origin=origin, voxel=voxel)
