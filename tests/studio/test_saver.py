"""Saving beside all else."""

from __future__ import annotations

import threading

from flowtree.errors import OutputError
from flowtree.project import commands as do
from flowtree.project.load_document import load_document
from flowtree.project.save_document import save_document
from flowtree.studio import saver as file
from flowtree.studio.saver import Saver
from tests.project.documents import HEIGHT, WIDTH, put_photo, two_photos


def test_an_older_state_never_costs_a_photo_that_came_meanwhile(tmp_path):
    folder, files, told = tmp_path / "oak", threading.Lock(), []
    document = two_photos(folder)
    saver = Saver(folder, told.append, files)
    with files:  # as while a photo is taken in
        saver.save(document.copy())
        document.apply(do.AddPhoto(put_photo(folder, "third.png", 3), WIDTH, HEIGHT))
        saver.save(document.copy())
    saver.flush()
    assert load_document(folder)[0].state == document.state
    assert [event["event"] for event in told] == ["saved"]
    saver.close()


def test_what_waits_is_written_before_the_end(tmp_path):
    folder = tmp_path / "oak"
    document = two_photos(folder)
    saver = Saver(folder, lambda event: None, threading.Lock())
    for seed in range(20):
        document.apply(do.SetSeed(seed + 1))
        saver.save(document.copy())
    saver.close()
    assert load_document(folder)[0].state.seed == 20
    assert saver.saved_revision == document.revision


def test_what_could_not_be_written_is_tried_again_by_itself(tmp_path, monkeypatch):
    tries, told, saved = [], [], threading.Event()

    def save(document, folder):
        tries.append(document.revision)
        if len(tries) < 3:
            raise OutputError("no room")
        save_document(document, folder)
        saved.set()

    monkeypatch.setattr(file, "save_document", save)
    monkeypatch.setattr(file, "_AGAIN", 0.01)
    folder = tmp_path / "oak"
    document = two_photos(folder)
    saver = Saver(folder, told.append, threading.Lock())
    saver.save(document.copy())
    assert saved.wait(20)
    saver.close()
    assert [event["event"] for event in told] == ["unsaved", "saved"], "one word is enough"
    assert load_document(folder)[0].state == document.state
