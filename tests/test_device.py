"""How kernels are launched on the cores."""

from __future__ import annotations

import os
import threading

import numpy as np
import pytest
import warp as wp

from flowtree import device
from flowtree.errors import InputError
from flowtree.kernels.wait_for_all import wait_for_all

wp.set_module_options({"enable_backward": False})


@wp.kernel
def number_all(first: int, values_out: wp.array[int]):
    i = first + wp.tid()
    values_out[i] = i + 1


@wp.kernel
def take_turns(
    first: int,
    ranks: int,
    turns: int,
    turn_out: wp.array[int],
    seen_out: wp.array2d[int],
    arrived_out: wp.array[int],
):
    """Each thread says which turn it is in, waits, and notes the slowest and fastest that it sees."""
    rank = first + wp.tid()
    for turn in range(turns):
        turn_out[rank] = turn + 1
        wait_for_all(arrived_out, (2 * turn + 1) * ranks)
        slowest = turn_out[rank]
        fastest = turn_out[rank]
        for other in range(ranks):
            slowest = wp.min(slowest, turn_out[other])
            fastest = wp.max(fastest, turn_out[other])
        seen_out[rank, 2 * turn] = slowest
        seen_out[rank, 2 * turn + 1] = fastest
        wait_for_all(arrived_out, (2 * turn + 2) * ranks)


def turns_of(threads, turns=40):
    arrived, turn = device.zeros(1, int, "cpu"), device.zeros(threads, int, "cpu")
    seen = device.zeros((threads, 2 * turns), int, "cpu")
    device.launch_together(take_turns, [turns], [turn, seen, arrived], threads=threads)
    return seen.numpy(), int(arrived.numpy()[0])


@pytest.mark.parametrize("threads", [1, 2, 3, 5, 9])
def test_nobody_overtakes_who_waits_for_all(threads):
    seen, arrived = turns_of(threads)
    assert (seen == np.repeat(np.arange(1, 41), 2)).all()
    assert arrived == 2 * 40 * threads


def test_groups_from_several_threads_run_one_at_a_time():
    results = []

    def work(threads):
        for _ in range(5):
            results.append(turns_of(threads, turns=10)[0])  # noqa: PERF401 (seen by the other thread)

    workers = [threading.Thread(target=work, args=(threads,), daemon=True) for threads in (2, 2, 3)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(timeout=30)
    assert not any(worker.is_alive() for worker in workers), "they wait for each other for ever"
    assert len(results) == 15
    assert all((seen == np.repeat(np.arange(1, 11), 2)).all() for seen in results)


def test_an_error_of_one_thread_reaches_the_caller_and_the_next_launch_works():
    with pytest.raises(RuntimeError, match="take_turns"):
        device.launch_together(take_turns, [1], [], threads=3)
    assert turns_of(3)[1] == 2 * 40 * 3


def test_no_more_threads_run_together_than_are_allowed(monkeypatch):
    monkeypatch.setattr(device, "_MOST_TOGETHER", 2)
    arrived, turn, seen = (device.zeros(shape, int, "cpu") for shape in (1, 5, (5, 2)))
    device.launch_together(take_turns, [1], [turn, seen, arrived], threads=5)
    assert turn.numpy().tolist() == [1, 1, 0, 0, 0]


@pytest.mark.parametrize("threads", [None, 1, 2, 3, 7, 50])
@pytest.mark.parametrize("count", [0, 1, 2, 5, 1000])
def test_a_split_launch_computes_every_index_once(threads, count):
    out = device.zeros(count + 3, int, "cpu")
    device.launch(number_all, count, [], [out], device="cpu", split_from=1, threads=threads)
    assert out.numpy().tolist() == [*range(1, count + 1), 0, 0, 0]


def test_cores_are_counted_as_asked(monkeypatch):
    monkeypatch.delenv("FLOWTREE_THREADS", raising=False)
    assert 1 <= device.thread_count() <= (os.cpu_count() or 1)
    monkeypatch.setenv("FLOWTREE_THREADS", "3")
    assert device.thread_count() == 3
    assert device.thread_count(5) == 5, "what is passed in counts more"


@pytest.mark.parametrize("value", [0, -2])
def test_a_number_of_threads_below_one_is_refused(value):
    with pytest.raises(InputError, match=rf"threads: must be at least 1, but got {value}; give more"):
        device.thread_count(value)


@pytest.mark.parametrize("text", ["0", "-1", "two", "1.5"])
def test_a_wrong_setting_is_named(monkeypatch, text):
    monkeypatch.setenv("FLOWTREE_THREADS", text)
    with pytest.raises(InputError, match="FLOWTREE_THREADS: must be a positive whole number"):
        device.thread_count()


def test_an_unknown_device_is_refused():
    with pytest.raises(InputError, match="device: must be one of cpu"):
        device.pick_device("tpu")


@pytest.mark.parametrize("threads", ["1", "3"])
def test_side_by_side_gives_what_map_gives_in_its_order(monkeypatch, threads):
    monkeypatch.setenv("FLOWTREE_THREADS", threads)
    assert device.side_by_side(pow, (2, 3, 4, 5, 6), (5, 4, 3, 2, 1)) == [32, 81, 64, 25, 6]
    assert device.side_by_side(pow, (), ()) == []
    with pytest.raises(ZeroDivisionError):
        device.side_by_side(pow, (1, 0, 2), (2, -1, 3))


def test_side_by_side_runs_at_once(monkeypatch):
    monkeypatch.setenv("FLOWTREE_THREADS", "2")
    meeting = threading.Barrier(2, timeout=20.0)
    assert sorted(device.side_by_side(lambda _: meeting.wait(), (0, 0))) == [0, 1]
