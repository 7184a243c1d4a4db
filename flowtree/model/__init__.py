"""What flows between the stages: frozen dataclasses of numpy arrays, without algorithms."""
