"""What the page says while the tree grows."""

from __future__ import annotations

from flowtree.pipeline.stand_beside_plain import stand_beside_plain
from flowtree.pipeline.table import STAGES
from flowtree.studio.page.stage_words import stage_words


def test_every_stage_has_words_without_a_word_of_the_pipeline():
    for stage in stand_beside_plain(STAGES):
        assert "_" not in stage_words(stage.name)
