import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from flowtree.geometry.srgb import LIGHT_OF_BYTE, decode_srgb, encode_srgb, encode_srgb_bytes


@settings(max_examples=25, deadline=None)
@given(value=st.floats(0, 1))
def test_light_and_numbers_round_trip(value):
    assert np.isclose(encode_srgb(decode_srgb(np.array([value])))[0], value, atol=1e-7)
    assert np.isclose(decode_srgb(encode_srgb(np.array([value])))[0], value, atol=1e-7)


def test_every_byte_round_trips():
    every = np.arange(256)
    assert np.array_equal(encode_srgb_bytes(LIGHT_OF_BYTE), every)
    assert (np.diff(LIGHT_OF_BYTE) > 0).all()
    assert LIGHT_OF_BYTE[[0, 255]].tolist() == [0.0, 1.0]


def test_known_values():
    """Mid-grey light is the number 188, and a coded half is a fifth of the light (IEC 61966-2-1)."""
    assert encode_srgb_bytes(np.array([0.5])) == 188
    assert np.isclose(decode_srgb(np.array([0.5]))[0], 0.2140, atol=1e-4)


def test_what_is_out_of_range_is_clipped():
    assert encode_srgb_bytes(np.array([[-1.0, 2.0]])).tolist() == [[0, 255]]
