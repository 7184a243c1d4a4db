"""Marks passed from Python: whatever comes is plain numbers inside the picture, or an input error."""

import numpy as np
import pytest

from flowtree.errors import InputError
from flowtree.model.marks import ViewMarks
from flowtree.model.photo import Photo
from flowtree.photos.check_marks import check_marks
from flowtree.photos.mirror_marks import mirror_marks

PHOTO = Photo("tree.jpg", np.zeros((100, 200, 3), np.uint8), scale=0.5)
MARKS = ViewMarks((20.0, 90.0), 5.0, (25.0, 60.0), np.array([[0, 0], [200, 100]], np.float32))


def test_good_marks_stay_as_they_are():
    same = check_marks(MARKS, PHOTO, name="marks")
    assert (same.foot, same.top, same.fork) == (MARKS.foot, MARKS.top, MARKS.fork)
    assert np.array_equal(same.seeds, MARKS.seeds)
    nothing = check_marks(ViewMarks(), PHOTO, name="marks")
    assert (nothing.foot, nothing.top, nothing.fork, len(nothing.seeds)) == (None, None, None, 0)


def test_arrays_and_numpy_numbers_become_plain_ones():
    given = ViewMarks(np.array([20, 90]), np.int64(5), [25, 60], [[1, 2]])  # type: ignore[arg-type]
    marks = check_marks(given, PHOTO, name="marks")
    assert marks.foot == (20.0, 90.0)
    assert [type(value) for value in (*marks.foot, marks.top, *marks.fork)] == [float] * 5
    assert marks.seeds.dtype == np.float32


@pytest.mark.parametrize(
    ("marks", "says"),
    [
        ({"foot": (1, 2)}, "marks: must be ViewMarks, but got dict"),
        (ViewMarks(foot=(1.0, float("nan"))), "marks, foot: must be finite"),
        (ViewMarks(foot=(1.0,)), "foot: must have shape"),
        (ViewMarks(foot=([1.0], 2.0)), "foot: must be an array"),
        (ViewMarks(foot="ab"), "foot: must have shape"),
        (ViewMarks(top="high"), "top: must hold numbers"),
        (ViewMarks(top=101.0), "top: must lie in the photo"),
        (ViewMarks(fork=(201.0, 5.0)), r"fork: must lie in the photo \(200 x 100\)"),
        (ViewMarks(seeds=None), "seeds: must have shape"),
        (ViewMarks(seeds=np.zeros((3, 3))), "seeds: must have shape"),
        (ViewMarks(seeds=np.array([[5.0, -3.0]])), "seeds: must lie in the photo"),
        (ViewMarks(foot=(5.0, 5.0), top=50.0), "foot: must lie below the top"),
    ],
)
def test_wrong_marks_are_one_line(marks, says):
    with pytest.raises(InputError, match=says) as caught:
        check_marks(marks, PHOTO, name="marks")
    assert "\n" not in str(caught.value)


def test_mirroring_twice_gives_the_marks_back():
    there = mirror_marks(MARKS, 200)
    assert there.foot == (180.0, 90.0)
    assert there.fork == (175.0, 60.0)
    assert there.top == MARKS.top
    assert there.seeds.tolist() == [[200, 0], [0, 100]]
    back = mirror_marks(there, 200)
    assert (back.foot, back.top, back.fork) == (MARKS.foot, MARKS.top, MARKS.fork)
    assert np.array_equal(back.seeds, MARKS.seeds)
    assert mirror_marks(ViewMarks(), 200).seeds.shape == (0, 2)
