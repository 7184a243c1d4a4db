"""Levels of detail: the same tree of fewer triangles."""
