"""What a measured time was measured on."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from flowtree.device import pick_device, thread_count

_PACKAGES = {"numpy": "numpy", "scipy": "scipy", "numba": "numba", "warp": "warp-lang"}


def describe_machine() -> str:
    """One line: processor, cores in use, device, versions of what the kernels and arrays run on."""
    versions = f"Python {platform.python_version()}, numpy {version('numpy')}, warp {version('warp-lang')}"
    where = f"{platform.system()} {platform.machine()}"
    return f"{_processor()}, {thread_count()} of {os.cpu_count()} cores, {pick_device()}; {where}, {versions}"


def list_machine() -> dict[str, Any]:
    """The same in parts, for a report; also memory [GB], all versions that matter and the date."""
    return {
        "processor": _processor(),
        "system": f"{platform.system()} {platform.machine()}",
        "cores_used": thread_count(),
        "cores": os.cpu_count() or 1,
        "memory_gb": _memory(),
        "device": pick_device(),
        "versions": {
            "python": platform.python_version(),
            **{name: version(package) for name, package in _PACKAGES.items()},
        },
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
    }


def _memory() -> float | None:
    """All of the machine's [GB], where the system says it."""
    try:
        return round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1)
    except (AttributeError, ValueError, OSError):
        return None


def _processor() -> str:
    """Its name, where the system says one."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else "unknown processor"
