"""The page's controls are made from the parameters' one declaration, and ask for nothing that it refuses."""

from __future__ import annotations

from itertools import chain

import pytest

from flowtree.configuration import params_from_table
from flowtree.params import Params
from flowtree.studio.page.param_row import Scale, read_text, write_text
from flowtree.studio.page.param_sections import TITLES, param_sections

_FIELDS = list(chain(*param_sections().values()))
_NUMBERS = [field for field in _FIELDS if field["kind"] in ("number", "whole")]


def name(field):
    return field["name"]


def accept(field, value):
    section, key = field["name"].split(".")
    return getattr(getattr(params_from_table({section: {key: value}}), section), key)


def test_every_parameter_of_a_section_has_a_field():
    for section in TITLES:
        names = {name(field) for field in param_sections()[section]}
        assert names == {f"{section}.{key}" for key in type(getattr(Params(), section)).model_fields}


@pytest.mark.parametrize("field", _FIELDS, ids=name)
def test_a_field_says_what_is_declared(field):
    section, key = field["name"].split(".")
    declared = type(getattr(Params(), section)).model_fields[key]
    assert field["description"] == declared.description
    assert accept(field, field["default"]) == getattr(getattr(Params(), section), key)
    if field["choices"]:
        assert all(accept(field, choice) == choice for choice in field["choices"])
    if field["optional"] and field["kind"] != "picture":
        assert accept(field, None) is None


@pytest.mark.parametrize("field", _NUMBERS, ids=name)
def test_a_slider_reaches_only_what_is_allowed_and_finds_back(field):
    scale = Scale(field)
    values = [scale.value(place) for place in range(201)]
    assert values == sorted(values)
    for place in (0, 1, 50, 120, 199, 200):
        assert accept(field, values[place]) == pytest.approx(values[place])
        if field["kind"] == "number":
            assert abs(scale.place(values[place]) - place) <= 3
        else:
            assert scale.value(scale.place(values[place])) == values[place]
    if field["default"] is not None:
        assert scale.value(scale.place(field["default"])) == pytest.approx(
            field["default"], rel=0.06, abs=0.01
        )


@pytest.mark.parametrize(
    ("text", "kind", "value"),
    [
        ("#aabbcc, #001122", "list", ["#aabbcc", "#001122"]),
        ("45, 30.5", "list", [45.0, 30.5]),
        ("", "list", []),
        ("auto", "text", "auto"),
    ],
)
def test_texts_are_read_as_they_are_written(text, kind, value):
    read = read_text(text, {"kind": kind, "default": "auto"})
    assert read == value
    assert read_text(write_text(read), {"kind": kind, "default": "auto"}) == value
