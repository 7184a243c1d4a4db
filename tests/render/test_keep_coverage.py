from __future__ import annotations

import cv2
import numpy as np
import pytest

from flowtree.render.keep_coverage import keep_coverage


def _passing(alpha, cutoff=0.5):
    """What passes the test as engines sample the texture: between the pixels' centres."""
    rows, columns = alpha.shape
    return cv2.resize(alpha, (4 * columns, 4 * rows), interpolation=cv2.INTER_LINEAR) >= cutoff


@pytest.mark.parametrize("cover", [0.1, 0.3, 0.7])
def test_as_much_passes_the_test_as_is_asked_for(cover):
    rng = np.random.default_rng(3)
    alpha = np.clip(rng.normal(0.3, 0.1, (64, 80)), 0.01, 1).astype(np.float32)
    bent = keep_coverage(alpha, np.full(alpha.shape, cover, np.float32), 0.5)
    assert ((bent >= 0) & (bent <= 1)).all()
    assert _passing(bent).mean() == pytest.approx(cover, abs=0.05)


def test_thin_twigs_pass_though_their_alpha_is_below_the_cutoff():
    alpha = np.zeros((64, 64), np.float32)
    alpha[:, 2::4] = 0.4
    bent = keep_coverage(alpha, alpha, 0.5)
    assert not _passing(alpha).any()
    assert _passing(bent).mean() == pytest.approx(alpha.mean(), rel=0.3)


def test_nothing_comes_where_nothing_was_and_what_is_asked_for_whole_stays():
    alpha = np.zeros((48, 48), np.float32)
    alpha[:, 20:36] = 1.0
    bent = keep_coverage(alpha, np.ones_like(alpha), 0.5)
    assert (bent[:, :19] == 0).all()
    assert (bent[:, 37:] == 0).all()
    assert (bent[:, 20:36] >= 0.5).all()


def test_of_what_is_solid_the_middle_stays():
    alpha = np.zeros((64, 64), np.float32)
    alpha[:, 20:24] = 1.0
    bent = keep_coverage(alpha, 0.5 * alpha, 0.5)
    assert (bent[:, 21:23] >= 0.5).all()
    assert not (bent[:, [19, 24]] >= 0.5).any()


def test_nothing_passes_where_nothing_is_asked_for():
    alpha = np.full((32, 32), 0.9, np.float32)
    assert not _passing(keep_coverage(alpha, np.zeros_like(alpha), 0.5)).any()
