"""Who imports whom: the layers of the design, read from the source without running it."""

from __future__ import annotations

import ast
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
STAGES = {
    *("photos", "matting", "density", "attraction", "flow", "branches", "foliage", "meshing"),
    *("levels", "wind", "collision"),
    *("sketch", "lsystem", "motion", "siblings", "export", "render"),
}
# A module may import what stands in its own row's set; STAGES are listed by name, each may import itself.
FOUNDATION = {
    "errors": set(),
    "check": {"errors"},
    "files": {"errors", "check"},
    "params": {"errors", "check"},
    "configuration": {"errors", "check", "params"},
    "device": {"errors", "check"},
    "model": {"errors", "check", "model"},
    # What many small things show is a hot loop of two stages.
    "geometry": {"errors", "check", "device", "kernels", "geometry"},
}
_BASE = set(FOUNDATION)
_ENGINE = _BASE | STAGES | {"kernels", "pipeline"}
ALLOWED = {
    **FOUNDATION,
    **{stage: _BASE | {"kernels", stage} for stage in STAGES},
    "pipeline": _ENGINE,
    "project": _ENGINE | {"project"},
    "batch": _ENGINE | {"batch"},
    "studio": _ENGINE | {"project", "batch", "studio"},
    "cli": _ENGINE | {"project", "batch", "studio", "cli"},
}
# A third-party library that only a few parts may know (numpy goes everywhere).
LIBRARIES = {
    "warp": {"device", "kernels", *STAGES},  # stages name its types; only device.py launches
    "pydantic": {"params", "configuration", "pipeline"},
    "typer": {"cli"},
    "nicegui": {"studio"},
    "starlette": {"studio"},
    "rich": {"cli"},
    "PIL": {"photos", "attraction", "render", "meshing", "foliage", "export"},
    "cv2": {
        "photos",
        "matting",
        "attraction",
        "density",
        "branches",
        "render",
        "meshing",
        "foliage",
        "export",
    },
    "scipy": {
        "matting",
        "attraction",
        "density",
        "flow",
        "branches",
        "meshing",
        "foliage",
        "render",
        "geometry",
        "wind",
    },
    "skimage": {"attraction", "flow"},
    "pymatting": {"matting"},
    "trimesh": {"export"},
    "manifold3d": {"export", "meshing"},
}
MODULES = sorted((ROOT / "flowtree").rglob("*.py"))
KERNELS = sorted((ROOT / "kernels").glob("*.py"))
IDS = [str(path.relative_to(ROOT)) for path in MODULES]


def _imports(path: Path) -> Iterator[str]:
    """Every module that a file imports, at the top or inside a function."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            if node.module == "flowtree":
                yield from (f"flowtree.{alias.name}" for alias in node.names)
            else:
                yield str(node.module)


def _part(path: Path) -> str:
    """The layer a file belongs to: the first name under flowtree/."""
    return path.relative_to(ROOT / "flowtree").parts[0].removesuffix(".py")


@pytest.mark.parametrize("path", MODULES, ids=IDS)
def test_a_layer_imports_only_layers_below(path):
    part = _part(path)
    if part == "__init__":  # the public names, all lazily
        return
    assert part in ALLOWED, f"{part} is no part of the design"
    for name in _imports(path):
        pieces = name.split(".")
        assert pieces[0] != "kernels", "the kernels are flowtree.kernels"
        if pieces[0] == "flowtree" and len(pieces) > 1 and not pieces[1].startswith("__"):
            assert pieces[1] in ALLOWED[part], f"{part} must not import {name}"


@pytest.mark.parametrize("path", MODULES, ids=IDS)
def test_a_library_stays_where_it_is_needed(path):
    for name in _imports(path):
        library = name.split(".")[0]
        if library in LIBRARIES:
            assert _part(path) in LIBRARIES[library], f"{library} does not belong into {_part(path)}"


def test_every_foreign_import_is_a_declared_dependency():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = " ".join(
        [*project["dependencies"], *chain(*project["optional-dependencies"].values())]
    ).lower()
    distribution = {
        "PIL": "pillow",
        "cv2": "opencv",
        "skimage": "scikit-image",
        "warp": "warp-lang",
        "pxr": "usd-core",
    }
    for path in (*MODULES, *KERNELS):
        for name in _imports(path):
            library = name.split(".")[0]
            if library in {"flowtree", "__future__"} or library in sys.stdlib_module_names:
                continue
            assert distribution.get(library, library).lower() in declared, (
                f"{path}: {library} is not declared"
            )


def test_there_is_no_cycle():
    graph = {}
    for path in MODULES:
        name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        graph[name] = [] if name == "flowtree" else list(_imports(path))
    state: dict[str, int] = {}

    def visit(name, trail):
        if state.get(name) == 2 or name not in graph:
            return
        assert state.get(name) != 1, f"cycle: {' -> '.join([*trail, name])}"
        state[name] = 1
        for other in graph[name]:
            if other != "flowtree":
                visit(other, [*trail, name])
        state[name] = 2

    for name in graph:
        visit(name, [])


@pytest.mark.parametrize("path", KERNELS, ids=[path.name for path in KERNELS])
def test_kernels_import_only_warp_and_each_other(path):
    for name in _imports(path):
        assert name in {"__future__", "typing", "warp"} or name.startswith("flowtree.kernels"), name


def test_only_the_device_launches_kernels():
    for path in MODULES:
        if _part(path) == "device":
            continue
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if (
                isinstance(node, ast.Attribute)
                and isinstance(node.value, ast.Name)
                and node.value.id in {"wp", "warp"}
            ):
                assert node.attr not in {"launch", "launch_tiled", "capture_launch"}, (
                    f"{path} launches kernels"
                )


def test_every_package_is_installed():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    listed = set(project["tool"]["setuptools"]["packages"])
    found = {
        ".".join(path.parent.relative_to(ROOT).parts) for path in MODULES if path.name == "__init__.py"
    } | {
        ".".join(("flowtree", *path.parent.relative_to(ROOT).parts))
        for path in (ROOT / "kernels").rglob("__init__.py")
    }
    with_modules = {".".join(path.parent.relative_to(ROOT).parts) for path in MODULES}
    assert listed == found
    assert with_modules <= found, "a folder of modules has no __init__.py"


HEAVY = {"warp", "scipy", "cv2", "pydantic", "skimage", "pymatting", "trimesh", "numba", "PIL"}
_HELP = """
import sys
sys.argv = ["flowtree", {arguments}]
from flowtree.cli.main import main
try:
    main()
except SystemExit as end:
    assert not end.code
"""


@pytest.mark.parametrize(
    ("statement", "forbidden"),
    [
        ("import flowtree", HEAVY),
        ("import flowtree.cli.main", HEAVY),
        (_HELP.format(arguments="'--help'"), HEAVY),
        # Typer itself reads a command's arguments with pydantic.
        (_HELP.format(arguments="'reconstruct', '--help'"), HEAVY - {"pydantic"}),
    ],
    ids=["import", "import cli", "help", "reconstruct help"],
)
def test_starting_loads_nothing_heavy(statement, forbidden):
    code = f"{statement}\nimport sys\nprint('loaded', *sorted({forbidden!r} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, timeout=60
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "loaded"
