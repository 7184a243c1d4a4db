"""Imports of kernels in several threads."""

from __future__ import annotations

from importlib import import_module
from threading import RLock
from types import ModuleType

_IMPORTING = RLock()


def import_alone(name: str) -> ModuleType:
    """Imports a module of kernels, or one that imports such, while no other thread does.

    Warp parses every kernel that it meets, and now and then Python 3.11 fails where two threads parse at
    once: "SystemError: AST constructor recursion depth mismatch".
    """
    with _IMPORTING:
        return import_module(name)
