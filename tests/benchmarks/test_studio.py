"""Timing the studio, on a session that answers at once."""

from __future__ import annotations

import pytest

from benchmarks import studio
from flowtree.errors import InputError
from tests.pictures import save_pair

_ANSWER = [
    *({"event": "layer", "name": name} for name in ("matte/0", "skeleton", "skeleton", "cost/0", "tree.glb")),
    {"event": "done", "job": "matte"},
    {"event": "done", "job": "tree"},
]


class _Session:
    """Tells the same after every command."""

    answer = _ANSWER
    busy = False

    @classmethod
    def open(cls, folder):
        return cls()

    def listen(self, callback):
        self._tell = callback

    def apply(self, command):
        for event in self.answer:
            self._tell(event)

    def add_photo(self, name, data):
        if name.startswith("side"):
            self.apply(None)

    def state_json(self):
        return {"photos": [{"width": 3000, "height": 4000}]}

    def cancel(self):
        pass

    close = cancel


def test_every_bound_is_measured_in_every_round(tmp_path, monkeypatch):
    monkeypatch.setattr(studio, "Session", _Session)
    found = studio.time_session(tmp_path, 2, save_pair(tmp_path))
    assert set(found) >= set(studio.BOUNDS)
    assert {len(values) for name, values in found.items() if not name.startswith("first")} == {2}
    assert all(seconds >= 0.0 for values in found.values() for seconds in values)


def test_a_studio_that_fails_is_not_timed(tmp_path, monkeypatch):
    monkeypatch.setattr(studio, "Session", _Session)
    monkeypatch.setattr(_Session, "answer", [{"event": "failed", "message": "no tree found"}])
    with pytest.raises(InputError, match="no tree found"):
        studio.time_session(tmp_path, 1, save_pair(tmp_path))
