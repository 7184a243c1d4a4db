"""Every kernel has a twin to be compared with, a test that compares them, and the common form."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILES = sorted(path for path in (ROOT / "kernels").glob("*.py") if path.name != "__init__.py")


def _functions(path: Path) -> dict[str, ast.FunctionDef]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef)}


def _kernels(path: Path) -> dict[str, ast.FunctionDef]:
    return {
        name: node
        for name, node in _functions(path).items()
        if any(ast.unparse(decorator).startswith("wp.kernel") for decorator in node.decorator_list)
    }


KERNELS = [(path, name) for path in FILES for name in _kernels(path)]


def _arguments(node: ast.FunctionDef) -> list[str]:
    return [argument.arg for argument in node.args.args]


@pytest.mark.parametrize(("path", "name"), KERNELS, ids=[name for _, name in KERNELS])
class TestKernel:
    def test_has_the_common_form(self, path, name):
        node = _kernels(path)[name]
        arguments = _arguments(node)
        assert arguments[0] == "first"
        assert not node.args.defaults
        outputs = [argument.endswith("_out") for argument in arguments]
        assert any(outputs)
        assert outputs == sorted(outputs), "outputs stand last"

    def test_writes_only_its_outputs(self, path, name):
        node = _kernels(path)[name]
        arguments = set(_arguments(node))
        for statement in ast.walk(node):
            targets = (
                statement.targets
                if isinstance(statement, ast.Assign)
                else [statement.target]
                if isinstance(statement, ast.AugAssign)
                else []
            )
            for target in targets:
                if isinstance(target, ast.Subscript) and isinstance(target.value, ast.Name):
                    array = target.value.id
                    assert array not in arguments or array.endswith("_out"), f"{name} writes {array}"

    def test_has_a_twin_of_the_same_form(self, path, name):
        twin = ROOT / "kernels" / "reference" / path.name
        assert twin.is_file(), f"no reference for {path.name}"
        functions = _functions(twin)
        assert name in functions, f"{twin} has no {name}"
        ours = _arguments(_kernels(path)[name])
        assert _arguments(functions[name]) in (ours, ours[1:]), "the arguments differ"

    def test_is_compared_with_its_twin(self, path, name):
        test = ROOT / "tests" / "kernels" / f"test_{path.name}"
        assert test.is_file(), f"no parity test {test.name}"
        assert name in test.read_text(encoding="utf-8"), f"{test.name} does not mention {name}"


@pytest.mark.parametrize("path", FILES, ids=[path.name for path in FILES])
def test_kernel_files_are_forward_only(path):
    if _kernels(path):
        assert '"enable_backward": False' in path.read_text(encoding="utf-8")


@pytest.mark.parametrize("path", FILES, ids=[path.name for path in FILES])
def test_no_atomics_on_floats(path):
    # Sums of floats depend on the order: equal seeds must give equal bytes on any number of cores.
    # (The barrier counts in whole numbers, and not with Warp's.)
    assert "wp.atomic_" not in path.read_text(encoding="utf-8")
