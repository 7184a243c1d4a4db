"""How the tree stands in each of its photographs: foot, height, roll and perspective, from all of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from flowtree import check
from flowtree.geometry.central_plane import PlaneView, view_from_distance, view_from_focal
from flowtree.geometry.footprint_means import optical_depth
from flowtree.model.marks import ViewMarks
from flowtree.model.matte import Matte
from flowtree.model.photo import Photo
from flowtree.model.placement import Estimate, Placement
from flowtree.params import AlignParams
from flowtree.photos.crown_above import crown_above
from flowtree.photos.estimate_roll import estimate_roll
from flowtree.photos.find_ends import find_ends
from flowtree.photos.frame_view import frame_view
from flowtree.photos.level_picture import level_picture
from flowtree.photos.lower_top import lower_top
from flowtree.photos.match_heights import Guess, HeightMatch, RowDepths, height_profile, match_heights
from flowtree.photos.read_focal_length import FILM_DIAGONAL
from flowtree.photos.straight_camera import straight_camera

_SOLID = 0.35  # alpha of a pixel that counts
_SURE = 0.35  # roll over its deviation below which it is left alone
_HIGHEST_EYE = 0.9  # [tree heights]
_UPPER = 0.25  # of the tree's height: the part in which its highest bough stands
_WORTH_SAYING = 0.01  # of the tree's height, hidden
_SMOOTH = 0.025  # of the picture's height, over which row sums are averaged


@dataclass(frozen=True)
class _View:
    """What is known of one view so far; rows and columns are those of the level picture.

    Attributes:
        name: of the photo.
        shape: of the photograph: rows and columns.
        foot: (x, y) [pixels]; the same in the photograph.
        top: row [pixels].
        roll: [degrees].
        seen: its row sums.
        missing: sides at which the tree leaves the photograph.
        cut: those of them beyond which the tree is to be looked for.
        hidden: which of foot and top are cut off and not given.
        distance: [tree heights], infinite for parallel projection, or None where the focal length counts.
        focal: [pixels].
        eye: [tree heights].
        top_spread: how far off the top may be, one standard deviation [pixels]; 0 where it is given.
        above: rows by which the crown is assumed to go on above a frame that cuts it off [pixels].
        estimates: so far.
        warnings: so far.
        open: what nobody gave.
    """

    name: str
    shape: tuple[int, int]
    foot: tuple[float, float]
    top: float
    roll: float
    seen: RowDepths
    missing: tuple[str, ...]
    cut: tuple[str, ...]
    hidden: tuple[str, ...]
    distance: float | None
    focal: float
    eye: float
    top_spread: float = 0.0
    above: float = 0.0
    estimates: tuple[Estimate, ...] = field(default=())
    warnings: tuple[str, ...] = field(default=())
    open: tuple[str, ...] = field(default=())

    def plane(self, foot: float, top: float) -> PlaneView:
        """The view of the plane through the axis, with foot and top in these rows."""
        if self.distance is None:
            return view_from_focal(foot, top, focal=self.focal, centre=self.shape[0] / 2, eye=self.eye)
        return view_from_distance(foot, top, distance=self.distance, eye=self.eye)


def place_views(
    photos: Sequence[Photo],
    mattes: Sequence[Matte],
    marks: Sequence[ViewMarks],
    *,
    yaws: Sequence[float],
    height: float,
    params: AlignParams = AlignParams(),
) -> tuple[Placement, ...]:
    """Finds where the tree stands in each photograph, and how that becomes a level, parallel picture.

    What is given by marks is taken; everything else is estimated where the pictures speak of it, and the
    placement says how sure it is:

    - foot and top: `find_ends`; of a tree that its frame cuts off above or below, `match_heights` finds them
      from the views that show all of it; of one seen from near, `lower_top` corrects the top. Where no
      view shows the top, the crown is assumed to end as half a ball above the frame's edge.
    - roll: `estimate_roll`, from the trunk.
    - perspective: the distance from the focal length, given or the file's, and the tree's height in the
      picture; of a photograph without one, ``params.distance`` is assumed.

    A picture with an alpha channel was prepared by somebody: unless ``params.automatic`` says "all", nothing
    but foot and top is looked for in it, and a pair of exact projections stays exact.

    Args:
        photos: one a view.
        mattes: one a view.
        marks: one a view.
        yaws: [degrees], one a view.
        height: of the tree [m].
        params: what is estimated.

    Raises:
        InputError: an empty matte, a foot not below the top, a tree lower than 16 pixels.
    """
    views = [
        _look(photo, matte, mark, height, params)
        for photo, matte, mark in zip(photos, mattes, marks, strict=True)
    ]
    views = _find_hidden(_agree(views))
    return tuple(
        _place(view, matte, yaw, height) for view, matte, yaw in zip(views, mattes, yaws, strict=True)
    )


def _look(photo: Photo, matte: Matte, marks: ViewMarks, height: float, params: AlignParams) -> _View:
    """What one view shows by itself."""
    free = params.automatic == "all" or (params.automatic == "opaque" and photo.alpha is None)
    frame = frame_view(matte, yaw=0.0, height=1.0, foot=marks.foot, top=marks.top)
    # A matte without a tree is no fault where both ends are given.
    missing = find_ends(matte.alpha).missing if (matte.alpha > _SOLID).any() else ()
    foot, top = frame.foot, frame.foot[1] - 1.0 / frame.metres_per_pixel
    estimates: list[Estimate] = []
    roll = 0.0
    if marks.roll is not None:
        roll = marks.roll
        estimates.append(Estimate("roll", roll, "degrees", "given"))
    elif free:
        leaning = estimate_roll(matte.alpha, foot, foot[1] - top)
        if leaning is not None:
            sure = abs(leaning[0]) >= _SURE * leaning[1]
            roll = leaning[0] if sure else 0.0
            estimates.append(Estimate("roll", roll, "degrees", "estimated", leaning[1]))
    distance, focal, origin = _perspective(photo, marks, height, free, params)
    eye = min(params.eye_height / height, _HIGHEST_EYE)
    level, up = level_picture(matte.alpha, foot, roll)
    depth = optical_depth(level.astype(np.float64)).sum(axis=1)
    if marks.top is None and roll != 0.0:
        solid = np.flatnonzero((level > _SOLID).any(axis=1))
        top = float(solid[0] - up) if len(solid) else top
    rows = np.arange(len(depth)) + 0.5 - up
    inside = (rows > 0.0) & (rows < matte.alpha.shape[0])
    smooth = cv2.GaussianBlur(depth[:, None], (0, 0), 1.0, sigmaY=_SMOOTH * len(depth)).ravel()
    hidden = []
    if free:
        hidden += ["foot"] if marks.foot is None and "bottom" in missing else []
        hidden += ["top"] if marks.top is None and "top" in missing else []
    view = _View(
        name=photo.name,
        shape=(matte.alpha.shape[0], matte.alpha.shape[1]),
        foot=foot,
        top=top,
        roll=roll,
        seen=RowDepths(rows[inside], smooth[inside]),
        missing=missing,
        cut=missing if free else (),
        hidden=tuple(hidden),
        above=crown_above(matte.alpha) if "top" in hidden else 0.0,
        distance=distance,
        focal=focal,
        eye=eye,
        open=tuple(name for name in ("foot", "top", "roll") if free and getattr(marks, name) is None)
        + (("yaw",) if free else ()),
    )
    if marks.top is None and "top" not in missing and free:
        upper = level[max(0, math.floor(top + up)) : math.ceil(top + up + _UPPER * (foot[1] - top))]
        wide = np.flatnonzero((upper > _SOLID).any(axis=0))
        reach = float(np.ptp(wide) + 1) / 2 / (foot[1] - top) if len(wide) else 0.0
        away = view.plane(foot[1], top).distance
        lowered, spread = lower_top(depth, foot[1] + up, top + up, reach=reach, distance=away)
        view = replace(view, top=lowered - up, top_spread=spread)
    of_foot, of_top = ("estimated" if end is None else "given" for end in (marks.foot, marks.top))
    estimates.append(Estimate("foot", foot[1], "pixels", of_foot))
    estimates.append(Estimate("top", view.top, "pixels", of_top, view.top_spread or None))
    plane = view.plane(foot[1], view.top)
    if origin:
        estimates.append(Estimate("distance", plane.distance * height, "m", origin))
    return replace(view, estimates=tuple(estimates))


def _perspective(
    photo: Photo, marks: ViewMarks, height: float, free: bool, params: AlignParams
) -> tuple[float | None, float, str]:
    """Distance [tree heights] or None, focal length [pixels], and where they are from ("" for neither)."""
    if marks.distance is not None:
        return marks.distance / height, math.inf, "given"
    if marks.focal_length is not None:
        return None, marks.focal_length / FILM_DIAGONAL * math.hypot(*photo.rgb.shape[:2]), "given"
    if not free:
        return math.inf, math.inf, ""
    if photo.focal_length is not None:
        return None, photo.focal_length, "EXIF"
    return params.distance or math.inf, math.inf, "assumed" if params.distance else ""


def _is_whole(view: _View) -> bool:
    return not view.hidden and not {"top", "bottom"} & set(view.missing)


def _profile(view: _View) -> NDArray[np.float64]:
    return height_profile(view.seen, view.plane(view.foot[1], view.top))


def _match(view: _View, others: Sequence[_View]) -> HeightMatch:
    """Foot and top with which a view agrees with others that show all of the tree."""
    spreads = [other.top_spread / (other.foot[1] - other.top) for other in others]
    theirs = float(np.sqrt(np.mean(np.square(spreads)))) * (view.foot[1] - view.top)
    return match_heights(
        view.seen,
        [_profile(other) for other in others],
        view.plane,
        foot=Guess(view.foot[1], hidden="foot" in view.hidden),
        top=Guess(
            view.top,
            spread=math.hypot(view.top_spread, theirs) if view.top_spread > 0.0 else 0.0,
            hidden="top" in view.hidden,
        ),
    )


def _agree(views: list[_View]) -> list[_View]:
    """Tops of views that show all of the tree, moved toward each other where their row sums tell."""
    whole = [view for view in views if _is_whole(view)]
    result = []
    for view in views:
        others = [other for other in whole if other is not view]
        if not others or not _is_whole(view) or view.top_spread == 0.0:
            result.append(view)
            continue
        match = _match(view, others)
        # The others move as well: each takes its part of the way.
        shift = (match.top - view.top) * len(others) / (len(others) + 1)
        if abs(shift) < match.top_deviation:
            result.append(view)
            continue
        moved = Estimate("top", view.top + shift, "pixels", "estimated", match.top_deviation)
        estimates = tuple(moved if e.name == "top" else e for e in view.estimates)
        result.append(replace(view, top=view.top + shift, estimates=estimates))
    return result


def _find_hidden(views: list[_View]) -> list[_View]:
    """Foot and top of views that are cut off, from those that show all of the tree.

    Where none does, nothing says how large it is: what is seen counts as all, but for a top that is cut off.
    """
    whole = [view for view in views if _is_whole(view)]
    result = []
    for view in views:
        if view.hidden and whole:
            match = _match(view, whole)
            found = {
                "foot": Estimate("foot", match.foot, "pixels", "estimated", match.foot_deviation),
                "top": Estimate("top", match.top, "pixels", "estimated", match.top_deviation),
            }
            estimates = tuple(found.get(e.name, e) if e.origin == "estimated" else e for e in view.estimates)
            moved = replace(view, foot=(view.foot[0], match.foot), top=match.top, estimates=estimates)
            result.append(replace(moved, warnings=_hidden_warnings(moved, True)))
        else:
            view = _close_crown(view)
            result.append(replace(view, warnings=_hidden_warnings(view, False)))
    return result


def _close_crown(view: _View) -> _View:
    """The view with the top of a crown that nobody has seen end."""
    if "top" not in view.hidden:
        return view
    above = Estimate("top", view.top - view.above, "pixels", "assumed")
    estimates = tuple(above if e.name == "top" else e for e in view.estimates)
    return replace(view, top=above.value, estimates=estimates)


def _hidden_warnings(view: _View, found: bool) -> tuple[str, ...]:
    words = []
    for name in view.hidden:
        away = view.foot[1] - view.shape[0] if name == "foot" else -view.top
        share = away / (view.foot[1] - view.top)
        if found and share > _WORTH_SAYING:
            words.append(
                f"{view.name}: the {name} lies outside the picture; going by the other views it is "
                f"{share:.0%} of the tree's height beyond the edge"
            )
        elif not found and name == "foot":
            words.append(f"{view.name}: the trunk leaves the picture, whose lower edge is taken for the foot")
        elif not found and share > _WORTH_SAYING:
            words.append(
                f"{view.name}: the crown leaves the picture at its upper edge and is assumed to end "
                f"{share:.0%} of the tree's height above; mark its top, or add a photo that shows it"
            )
    return tuple(words)


def _place(view: _View, matte: Matte, yaw: float, height: float) -> Placement:
    check.require(
        math.isfinite(yaw), "yaw", "must be a number of degrees", f"{yaw:g}", "give the view's angle"
    )
    plane = view.plane(view.foot[1], view.top)
    camera, warp = straight_camera(
        plane, view.foot, view.roll, matte.alpha.shape, yaw=yaw, height=height, missing=view.cut
    )
    frame = (view.shape[1], view.shape[0])
    return Placement(camera, warp, frame, view.cut, view.estimates, view.warnings, view.open)
