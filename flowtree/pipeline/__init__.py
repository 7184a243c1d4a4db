"""The ordered table of stages: cache, progress, cancel, report."""
