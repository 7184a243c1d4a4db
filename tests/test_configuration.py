"""Parameters as text: round trips, overrides, and errors that name the remedy."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.configuration import (
    load_params,
    override_params,
    parameter_fields,
    params_from_table,
    params_to_toml,
)
from flowtree.errors import InputError
from flowtree.params import Params

_COLORS = st.lists(st.from_regex(r"#[0-9a-f]{6}", fullmatch=True), max_size=3).map(tuple)


@settings(max_examples=25, deadline=None)
@given(
    count=st.integers(1, 10_000),
    reach=st.floats(0.001, 2.0),
    automatic=st.booleans(),
    colors=_COLORS,
    radius=st.none() | st.floats(0.01, 20),
    bark=st.text(st.characters(codec="utf-8"), min_size=1, max_size=12),
)
def test_toml_and_back_is_the_same(count, reach, automatic, colors, radius, bark):
    params = params_from_table(
        {
            "flow": {"particle_count": count},
            "field": {"reach": reach},
            "attraction": {"automatic": automatic},
            "matting": {"foreground_colors": colors},
            "thickness": {"trunk_radius": radius},
            "meshing": {"bark": bark},
        }
    )
    assert params_from_table(tomllib.loads(params_to_toml(params))) == params


def test_every_parameter_is_printed_with_its_meaning():
    text = params_to_toml(Params())
    for section, name, field in parameter_fields():
        assert f"[{section}]" in text
        assert f"{name} =" in text
        assert field.description, f"{section}.{name} has no description"
        assert f"# {field.description}" in text


@pytest.mark.parametrize(
    ("assignment", "section", "name", "value"),
    [
        ("flow.particle_count=4000", "flow", "particle_count", 4000),
        (" field.blending = constant", "field", "blending", "constant"),
        ('field.blending="constant"', "field", "blending", "constant"),
        ("attraction.automatic=false", "attraction", "automatic", False),
        ("thickness.trunk_radius=0.3", "thickness", "trunk_radius", 0.3),
        ('thickness.trunk_radius="0.3"', "thickness", "trunk_radius", 0.3),
        ("thickness.trunk_radius=none", "thickness", "trunk_radius", None),
        (
            "matting.foreground_colors=#aabbcc, #112233",
            "matting",
            "foreground_colors",
            ("#aabbcc", "#112233"),
        ),
        ('matting.foreground_colors=["#aabbcc"]', "matting", "foreground_colors", ("#aabbcc",)),
    ],
)
def test_overrides(assignment, section, name, value):
    assert getattr(getattr(override_params(Params(), [assignment]), section), name) == value


def test_the_last_override_counts_and_the_rest_stays():
    start = override_params(Params(), ["density.resolution=20"])
    params = override_params(start, ["flow.particle_count=5", "flow.particle_count=6"])
    assert params.flow.particle_count == 6
    assert params.density.resolution == 20


@pytest.mark.parametrize(
    ("assignment", "message"),
    [
        ("flow.particle_cuont=3", r"flow\.particle_cuont: .* did you mean 'flow\.particle_count'\?"),
        ("flwo.particle_count=3", r"did you mean 'flow\.particle_count'\?"),
        ("flow.qqqqqqqqqqqqqqqqqqqqqqqqq=3", r"use one of flow\."),
        ("flow=3", r"must be a parameter"),
        ("flow.particle_count", r"must look like NAME=VALUE"),
        ("flow.particle_count=0", r"must be at least 1, but got 0"),
        ("field.reach=3", r"must be at most 2, but got 3"),
        ("field.reach=nan", r"field\.reach: must be finite, but got nan"),
        ("flow.particle_count=many", r"must be a whole number, but got 'many'"),
        ("thickness.trunk_radius=true", r"thickness\.trunk_radius: must be a number, but got True"),
        ("flow.particle_count=false", r"flow\.particle_count: must be a whole number, but got False"),
        ("field.blending=cubic", r"must be 'linear' or 'constant', but got 'cubic'"),
    ],
)
def test_a_wrong_override_is_one_clear_line(assignment, message):
    with pytest.raises(InputError, match=message) as caught:
        override_params(Params(), [assignment])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"[flow]\nparticle_count = 2\nparticle_count = 3\n", r"must be TOML, but got .*line 3"),
        (b"[flow", "must be TOML"),
        (b"\xff\xfe", "UTF-8"),
        (b"[flow]\nparticle_count = -1\n", r"flow\.particle_count: must be at least 1"),
        (b"[flow]\nnumber = 1\n", r"flow\.number: must be a parameter"),
        (b"[folw]\nstep = 1\n", r"folw: .* did you mean 'flow'\?"),
        (b"flow = 1\n", "flow: must be a table"),
    ],
)
def test_a_broken_file_is_one_clear_line(tmp_path, content, message):
    file = tmp_path / "params.toml"
    file.write_bytes(content)
    with pytest.raises(InputError, match=message) as caught:
        load_params(file)
    assert "params.toml" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"nothing\.toml: must be a file that can be read"):
        load_params(tmp_path / "nothing.toml")


@settings(max_examples=25, deadline=None)
@given(text=st.text(max_size=20))
def test_any_text_is_taken_or_refused(text):
    try:
        params = override_params(Params(), [f"flow.particle_count={text}"])
    except InputError:
        with pytest.raises(InputError, match=r"\A[^\n]*\Z"):
            override_params(Params(), [text])
        return
    count = params.flow.particle_count
    assert count is None or count >= 1
