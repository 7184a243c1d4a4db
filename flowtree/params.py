"""Every stage's parameters, each declared once: default, range, unit, one line of text.

That one declaration drives the check, ``--set flow.particle_count=4000``, the TOML file, the studio's sliders
and the table of ``flowtree params``.
"""

from __future__ import annotations

from typing import Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, ValidationInfo, field_validator


def _number(
    default: Any,
    doc: str,
    *,
    ge: float | None = None,
    le: float | None = None,
    gt: float | None = None,
    unit: str = "",
) -> Any:
    return Field(default, description=doc, ge=ge, le=le, gt=gt, json_schema_extra={"unit": unit})


def _choice(default: Any, doc: str) -> Any:
    return Field(default, description=doc, json_schema_extra={"unit": ""})


class StageParams(BaseModel):
    """What all stages' parameters share: frozen, finite, no unknown names, no true or false for a number."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    @field_validator("*", mode="before")
    @classmethod
    def _refuse_booleans(cls, value: Any, info: ValidationInfo) -> Any:
        """Python's booleans are whole numbers, and pydantic takes them for 0 and 1."""
        annotation = cls.model_fields[str(info.field_name)].annotation
        kinds = get_args(annotation) or (annotation,)
        if isinstance(value, bool) and bool not in kinds and (int in kinds or float in kinds):
            raise ValueError("must be a whole number" if int in kinds else "must be a number")
        return value


class PhotoParams(StageParams):
    """Reading a photograph."""

    working_height: int = _number(
        1024, "largest height or width of the working picture", ge=64, le=8192, unit="px"
    )
    max_megapixels: float = _number(
        200.0, "pictures that claim more are refused before decoding", gt=0, le=2000, unit="MP"
    )


class AlignParams(StageParams):
    """How the tree stands in its photographs."""

    automatic: Literal["opaque", "all", "none"] = _choice(
        "opaque",
        "photos whose roll, distance and hidden ends are estimated; opaque leaves out those with alpha",
    )
    distance: float = _number(
        1.8,
        "distance of the camera where no focal length is known; 0 for parallel projection",
        ge=0,
        le=1000,
        unit="tree heights",
    )
    eye_height: float = _number(1.6, "of the camera above the foot", ge=0, le=100, unit="m")


class MattingParams(StageParams):
    """From photograph to alpha matte."""

    foreground_colors: tuple[str, ...] = _choice((), "colours picked on the tree, as #rrggbb")
    background_colors: tuple[str, ...] = _choice((), "colours picked beside the tree, as #rrggbb")
    solve_height: int = _number(
        448, "height at which closed-form matting is solved before refinement", ge=64, le=4096, unit="px"
    )


class AttractionParams(StageParams):
    """Livewire attractor graphs."""

    seed_count: int = _number(28, "seed points on the silhouette", ge=0, le=2000)
    seed_mode: Literal["farthest", "random"] = _choice("farthest", "how the silhouette's seeds are spread")
    automatic: bool = _choice(True, "trace the automatic graph even where strokes or seeds are given")
    habit: Literal["auto", "upright", "spreading", "weeping", "conifer", "palm"] = _choice(
        "auto", "which way the branches grow; auto goes by the pictures"
    )
    grid_height: int = _number(
        240, "the tree's height in the small picture that is searched for paths", ge=32, le=1024, unit="px"
    )
    merging: float = _number(
        0.4, "how much cheaper a path becomes where another has run; more makes flatter forks", ge=0, le=0.9
    )


class FieldParams(StageParams):
    """Direction fields (Particle Flows, equation 3)."""

    resolution: int = _number(100, "cells along each side of a view's grid", ge=4, le=1000)
    blending: Literal["linear", "constant"] = _choice("linear", "the function h(d)")
    reach: float = _number(
        0.18,
        "distance at which linear blending points straight at the graph",
        gt=0,
        le=2,
        unit="tree heights",
    )
    angle: float = _number(
        45.0, "angle between field and graph under constant blending", ge=0, le=90, unit="degrees"
    )
    angles: tuple[float, ...] = _choice(
        (), "the same [degrees] for each level of branches, the stem's first; the last holds for all beyond"
    )
    climb: float | None = _number(
        None,
        "how far branches climb for their length to the side, below 0 hang; left out, it goes by the habit",
        ge=-2,
        le=2,
    )

    @field_validator("angles")
    @classmethod
    def _check_angles(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if not all(0.0 <= angle <= 90.0 for angle in value):
            raise ValueError("must be angles of 0 to 90 degrees")
        return value


class DensityParams(StageParams):
    """The density volume (Particle Flows, section 5)."""

    resolution: int | None = _number(
        None,
        "voxels along the tree's height; left out, 96, or 60 where a view's placement is an estimate",
        ge=4,
        le=512,
    )
    carve: float = _number(0.01, "voxels whose smallest footprint mean is below this are empty", ge=0, le=1)
    iterations: int = _number(200, "rounds of the least-squares solver at most", ge=0, le=1000)
    tolerance: float = _number(
        0.001, "distance of the rays' depths from the best fit at which the rounds end", ge=0, le=1
    )
    balance: float = _number(
        1.0, "largest relative correction of a row's total depth toward the other views'", ge=0, le=10
    )


class FlowParams(StageParams):
    """Particle tracing (Particle Flows, section 6)."""

    particle_count: int | None = _number(
        None, "particles released in the crown; left out, by how much crown there is", ge=1, le=5_000_000
    )
    step: float = _number(
        0.006, "length of a time step at unit speed", ge=0.0005, le=0.1, unit="tree heights"
    )
    attraction: float = _number(1.0, "weight of the pull to the nearest neighbour", ge=0, le=20)
    attraction_radius: float = _number(
        0.08, "distance at which neighbours stop attracting", ge=0, le=1, unit="tree heights"
    )
    join_distance: float = _number(
        0.012, "two single particles nearer than this join", gt=0, le=0.5, unit="tree heights"
    )
    join_growth: float = _number(
        0.0009,
        "what the root of a pair's mass adds to the joining distance: limbs take in their neighbours",
        ge=0,
        le=0.1,
        unit="tree heights",
    )
    basis_pull: float = _number(
        0.4,
        "cosine between field and the way to the foot below which the pull to the foot mixes in",
        ge=0.01,
        le=1,
    )
    response: float = _number(
        0.02, "time in which a single particle takes a new direction", ge=0.001, le=1, unit="tree heights"
    )
    inertia: float = _number(0.15, "exponent of the mass in that time", ge=0, le=1)
    pace: float = _number(
        15.0, "how strongly late particles hurry so that all reach the trunk together", ge=0, le=100
    )


class ThicknessParams(StageParams):
    """Da Vinci radii (Particle Flows, section 8)."""

    da_vinci: float = _number(1.0, "the constant a in r² = a Σ rᵢ² at forks", ge=1.0, le=1.2)
    exponent: float | None = _number(
        None, "in place of the 2; left out, it is 2, and fitted to the mattes of a bare tree", ge=1.5, le=4
    )
    trunk_radius: float | None = _number(
        None,
        "radius of the trunk above its foot; left out, it is measured in the photos",
        gt=0,
        le=20,
        unit="m",
    )
    slenderness: float = _number(
        0.018, "radius of a trunk that no photo shows", gt=0, le=0.2, unit="tree heights"
    )
    taper: float = _number(0.4, "how much thinner than by the rule alone a tip is", ge=0, le=0.95)
    thinnest: float = _number(0.0002, "radius of the thinnest branch", ge=0, le=0.01, unit="tree heights")


class BranchParams(StageParams):
    """From traces to branches."""

    stride: int = _number(3, "steps of the flow between two nodes of a branch", ge=1, le=50)
    smoothing: int = _number(10, "rounds of smoothing; 0 leaves branches chiselled", ge=0, le=100)
    least_angle: float = _number(
        28.0, "forks narrower than this are moved to where the branches part", ge=0, le=80, unit="degrees"
    )
    limb_reach: float = _number(
        0.025,
        "distance at which a path belongs to a limb that the pictures show",
        ge=0,
        le=0.5,
        unit="tree heights",
    )
    entry_angle: float = _number(
        45.0, "angle at which a path enters such a limb", ge=5, le=90, unit="degrees"
    )
    longest_lone: float = _number(
        0.12,
        "a side branch of p particles longer than this times the root of p is dropped: wires are no branches",
        gt=0,
        le=10,
        unit="tree heights",
    )
    longest_gap: float = _number(
        0.015,
        "a side branch of p particles that crosses gaps of a leafy crown for longer than this times the root"
        " of p is dropped",
        gt=0,
        le=10,
        unit="tree heights",
    )
    shortest: float = _number(0.008, "shorter side branches are dropped", ge=0, le=0.5, unit="tree heights")
    limb_radius: float = _number(
        0.02,
        "rough radius of the trunk, to find side branches that end inside their limb",
        ge=0,
        le=0.2,
        unit="tree heights",
    )


class TwigParams(StageParams):
    """Small twigs (Particle Flows, section 8)."""

    length: float = _number(0.04, "mean length of a twig", gt=0, le=0.5, unit="tree heights")
    bare_length: float = _number(
        0.06, "mean length of a twig of a bare tree", gt=0, le=0.5, unit="tree heights"
    )
    frequency: float = _number(
        160.0,
        "places for a twig along a thin branch, of which the mattes choose",
        ge=0,
        le=2000,
        unit="1/tree height",
    )
    most: int = _number(7000, "twigs aimed at in a full crown", ge=0, le=200_000)
    divergence: float = _number(
        137.5, "angle around the branch from twig to twig; 90 and 180 occur too", ge=0, le=360, unit="degrees"
    )
    whorl: int = _number(1, "twigs at one place of the branch: 1 alternate, 2 opposite", ge=1, le=12)
    angle: float = _number(38.0, "angle between branch and twig", ge=0, le=120, unit="degrees")
    plagiotropism: float = _number(0.1, "how far twigs bend toward the horizontal", ge=0, le=1)
    rigidity: float = _number(0.92, "1 stands stiff, 0 hangs", ge=0, le=1)
    curl: float = _number(0.1, "how far a twig's tip leaves the straight line", ge=0, le=1, unit="lengths")
    sketch: str | None = _choice(
        None, "a drawn twig (.svg, .json, .png) as the example for all, its lowest end at the branch"
    )
    side_twigs: int = _number(4, "side twigs on a twig of a bare tree", ge=0, le=12)
    radius: float = _number(0.0005, "radius at the base", gt=0, le=0.01, unit="tree heights")
    bearing_particles: int = _number(24, "branches of more particles bear no twigs", ge=1, le=1_000_000)
    turn: float = _number(
        20.0,
        "how far thin branches of a bare tree are turned, about each axis, to where the mattes show wood",
        ge=0,
        le=90,
        unit="degrees",
    )


class MeshingParams(StageParams):
    """The wood's surface."""

    surface: Literal["rings", "quads"] = _choice(
        "rings", "rings: tubes that overlap at forks, fast; quads: one closed surface, smooth there"
    )
    subdivisions: int = _number(2, "how often the quads' control mesh is subdivided", ge=0, le=4)
    sides: int = _number(12, "sides of the thickest ring; even, or 3; for rings alone", ge=3, le=64)
    tolerance: float = _number(
        0.0,
        "how far the surface may leave the finest one, for rings to be left out",
        ge=0,
        le=0.5,
        unit="tree heights",
    )
    root_flare: float = _number(
        0.35, "by how much the trunk widens at the ground", ge=0, le=3, unit="trunk radii"
    )
    bark: str = _choice("auto", "bark texture: auto, or the path of a picture")
    bark_style: Literal["auto", "furrowed", "smooth", "papery", "plated", "ringed"] = _choice(
        "auto", "the painted bark's habit; auto goes by its colour"
    )
    bark_color: str = _choice("auto", "of painted bark, as #rrggbb; auto goes by the photos, or by the style")
    bark_scale: float = _number(
        0.6, "length of bark that the texture shows; it repeats beyond", gt=0.001, le=20, unit="m"
    )


class LeafParams(StageParams):
    """Leaves (Particle Flows, section 8)."""

    shape: Literal["auto", "broad", "lanceolate", "needle", "frond", "compound", "blossom"] = _choice(
        "auto", "the leaf's shape"
    )
    bear: Literal["auto", "always", "never"] = _choice("auto", "whether the tree bears leaves")
    picture: str | None = _choice(None, "PNG of a leaf with alpha, its stalk's end at the bottom centre")
    size: float = _number(
        0.013,
        "length of a leaf; larger where the crown would need too many, smaller where few",
        gt=0,
        le=0.5,
        unit="tree heights",
    )
    amount: float = _number(1.0, "factor to the optical depth that the mattes ask for", ge=0, le=4)
    most: int = _number(24000, "leaves at most", ge=1, le=2_000_000)
    choice: float = _number(20.0, "places looked at for each leaf", ge=1, le=20)
    densest: float = _number(12.0, "places at most along a leaf's length of twig", ge=1, le=100)
    divergence: float = _number(
        137.5, "angle around the twig from leaf to leaf; 90 and 180 occur too", ge=0, le=360, unit="degrees"
    )
    whorl: int = _number(1, "leaves at one place of the twig: 1 alternate, 2 opposite", ge=1, le=12)
    angle: float = _number(55.0, "angle between twig and leaf", ge=0, le=120, unit="degrees")
    plagiotropism: float = _number(0.55, "how strictly leaves turn their upper side to the sky", ge=0, le=1)
    hang: float = _number(0.25, "how far leaves hang", ge=0, le=3)
    rounding: float = _number(
        0.5, "how far normals turn out of the crown, which shades it as one soft body", ge=0, le=1
    )
    color: str = _choice("auto", "of leaves that no photo shows, as #rrggbb; auto goes by the shape")
    color_variation: float = _number(0.12, "relative variation of brightness from leaf to leaf", ge=0, le=1)
    bearing_particles: int = _number(2, "branches of more particles bear no leaves", ge=1, le=1000)


class AssetParams(StageParams):
    """Levels of detail and impostors."""

    max_triangles: int = _number(
        49_000, "triangles of the finest level; 0 leaves the tree as it is", ge=0, le=100_000_000
    )
    levels: int = _number(1, "levels of detail in the file, the finest among them", ge=1, le=4)
    texture_size: int = _number(2048, "longer side of a texture at most", ge=16, le=8192, unit="px")
    atlas: bool = _choice(False, "whether bark and leaf share one texture")
    impostor: Literal["none", "crossed", "octahedral"] = _choice(
        "none", "cards for far away: some that cross, or one with pictures from all around"
    )
    impostor_cards: int = _number(
        11, "crossed cards behind each other, in each of three directions: fewer draw faster", ge=1, le=32
    )
    impostor_size: int = _number(
        2048, "height and width of the impostor's texture", ge=64, le=8192, unit="px"
    )
    impostor_frames: int = _number(
        12, "pictures along each side of the octahedral impostor's texture", ge=2, le=32
    )


class WindParams(StageParams):
    """Moving in the wind."""

    channels: Literal["none", "attributes", "colors", "godot", "unity", "unreal"] = _choice(
        "none", "what vertices carry for shaders, and in which engine's layout"
    )
    sway: bool = _choice(False, "whether the tree has joints, and a looping motion of them")
    strength: float = _number(1.0, "of the motion; 1 is a gentle breeze", ge=0, le=5)
    seconds: float = _number(8.0, "length of the motion's loop", ge=1, le=60, unit="s")
    joints: int = _number(160, "joints at most", ge=1, le=400)


class CollisionParams(StageParams):
    """Bodies for a physics engine."""

    engine: Literal["none", "godot", "unity", "unreal"] = _choice(
        "none", "whether to make them, and for which engine to name them"
    )
    capsules: int = _number(16, "capsules of stem and thick limbs at most", ge=1, le=64)
    hull: bool = _choice(True, "whether a convex hull bounds the crown")


class ExportParams(StageParams):
    """The file of a finished tree."""

    quantise: bool = _choice(False, "fewer bits for places and directions, for programs that read them (GLB)")
    instanced: bool = _choice(False, "one leaf and its places instead of all leaves, for programs that do")
    separate_levels: bool = _choice(False, "a file for each level of detail, named NAME_LOD0, NAME_LOD1, …")


class RenderParams(StageParams):
    """Pictures of the finished tree."""

    size: int = _number(768, "height and width of a picture", ge=16, le=8192, unit="px")
    samples: int = _number(2, "rays along each side of a pixel", ge=1, le=8)
    sun_azimuth: float = _number(
        -40.0,
        "where the sun stands, from behind the viewer's back to the right",
        ge=-180,
        le=180,
        unit="degrees",
    )
    sun_elevation: float = _number(48.0, "height of the sun over the horizon", ge=1, le=90, unit="degrees")
    sun: float = _number(3.0, "brightness of the sun; a sky of 1 lights a white wall fully", ge=0, le=20)
    sky: float = _number(1.15, "brightness of the sky", ge=0, le=20)


class Params(StageParams):
    """The parameters of all stages."""

    photos: PhotoParams = PhotoParams()
    align: AlignParams = AlignParams()
    matting: MattingParams = MattingParams()
    attraction: AttractionParams = AttractionParams()
    density: DensityParams = DensityParams()
    field: FieldParams = FieldParams()
    flow: FlowParams = FlowParams()
    branches: BranchParams = BranchParams()
    thickness: ThicknessParams = ThicknessParams()
    twigs: TwigParams = TwigParams()
    meshing: MeshingParams = MeshingParams()
    leaves: LeafParams = LeafParams()
    asset: AssetParams = AssetParams()
    wind: WindParams = WindParams()
    collision: CollisionParams = CollisionParams()
    export: ExportParams = ExportParams()
    render: RenderParams = RenderParams()
