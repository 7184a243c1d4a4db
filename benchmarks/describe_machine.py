"""What a measured time was measured on."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version
from pathlib import Path

from flowtree.device import pick_device, thread_count


def describe_machine() -> str:
    """One line: processor, cores in use, device, versions of what the kernels and arrays run on."""
    versions = f"Python {platform.python_version()}, numpy {version('numpy')}, warp {version('warp-lang')}"
    where = f"{platform.system()} {platform.machine()}"
    return f"{_processor()}, {thread_count()} of {os.cpu_count()} cores, {pick_device()}; {where}, {versions}"


def _processor() -> str:
    """Its name, where the system says one."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else "unknown processor"
