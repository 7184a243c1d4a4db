"""A project on disk: photographs, mattes, strokes, painted edits, parameters."""
