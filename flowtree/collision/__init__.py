"""Solid bodies in the place of a tree, for physics engines."""
