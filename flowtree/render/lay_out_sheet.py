"""Labelled pictures on one sheet of paper."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

GAP = 8  # [pixels] between pictures and around them
_LABEL, _TEXT = 26, 16  # [pixels], above each picture for its label, and the label's size
_PAPER, _INK = (250, 249, 246), (50, 48, 44)
_CUT = "..."


def lay_out_sheet(
    rows: Sequence[Sequence[tuple[str, NDArray[np.uint8]]]], *, width: int, slot: int
) -> NDArray[np.uint8]:
    """Puts rows of pictures under each other, those of one column in line.

    Args:
        rows: label and picture (h, w, 3) sRGB each; a label too long for its place is cut.
        width: of the sheet [pixels].
        slot: width of a column [pixels]; a picture that stands alone in its row may be wider.

    Returns: (h, width, 3) uint8 sRGB.
    """
    font = ImageFont.load_default(_TEXT)
    heights = [max(picture.shape[0] for _, picture in row) + _LABEL + GAP for row in rows]
    sheet = Image.new("RGB", (width, sum(heights) + GAP), _PAPER)
    draw = ImageDraw.Draw(sheet)
    top = GAP
    for row, height in zip(rows, heights, strict=True):
        for column, (label, picture) in enumerate(row):
            room = width - 2 * GAP if len(row) == 1 else slot
            left = GAP + column * (slot + GAP)
            aside = (room - picture.shape[1]) // 2
            text = _shorten(label, font, room)
            draw.text((left + max(0, aside), top + 2), text, fill=_INK, font=font)
            sheet.paste(Image.fromarray(picture), (left + max(0, aside), top + _LABEL))
        top += height
    return np.asarray(sheet, np.uint8)


def _shorten(label: str, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, room: int) -> str:
    """The label as far as there is room; the end of a text says more than its middle."""
    text, kept = label, len(label)
    while text and font.getlength(text) > room - 4:
        kept -= 1
        text = label[: (kept + 1) // 2] + _CUT + label[len(label) - kept // 2 :] if kept > 1 else ""
    return text
