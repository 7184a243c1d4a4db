"""Pillow without its own cap on pixels."""

from __future__ import annotations

import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from PIL import Image

# Pillow's own cap is a global that warns; ours is a parameter and an error. One thread changes it at a time.
_PILLOW = threading.Lock()


@contextmanager
def lift_pillow_cap() -> Iterator[None]:
    """Opens pictures of any size inside the block; the caller checks how large they say they are."""
    with _PILLOW, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # damaged metadata does not matter where the pixels are sound
        cap, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
        try:
            yield
        finally:
            Image.MAX_IMAGE_PIXELS = cap
