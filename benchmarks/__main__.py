"""Runs one of the programs of this folder: ``python -m benchmarks NAME [ARGUMENTS]``."""

from __future__ import annotations

import ast
import sys
from importlib import import_module
from pathlib import Path

from flowtree import check
from flowtree.errors import FlowtreeError


def find_programs() -> dict[str, str]:
    """Name and first line of every file here that has a ``main``."""
    programs = {}
    for file in sorted(Path(__file__).parent.glob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        runs = any(isinstance(node, ast.FunctionDef) and node.name == "main" for node in tree.body)
        if runs and not file.stem.startswith("_"):
            programs[file.stem] = (ast.get_docstring(tree) or "").partition("\n")[0]
    return programs


def run(arguments: list[str]) -> int:
    """The program's exit code; without a name, the list of programs and 2."""
    programs = find_programs()
    if not arguments or arguments[0] in {"-h", "--help"}:
        print("python -m benchmarks NAME [ARGUMENTS]")
        for name, purpose in programs.items():
            print(f"  {name:<12} {purpose}")
        return 0 if arguments else 2
    name, *rest = arguments
    try:
        known = name in programs
        check.require(known, name, "must be a program", "an unknown name", check.nearest_name(name, programs))
        return int(import_module(f"benchmarks.{name}").main(rest))
    except FlowtreeError as error:
        print(f"benchmarks: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(run(sys.argv[1:]))
