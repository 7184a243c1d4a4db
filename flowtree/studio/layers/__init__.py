"""What the stages made as bytes that a browser draws."""
