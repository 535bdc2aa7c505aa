"""The slot between capture and simulation."""

import threading

import numpy as np

from voltcam_server.mailbox import SLOTS, Mailbox

from .rig import PATIENCE_S, arrival

IMAGE = np.zeros((2, 2), np.uint8)


def test_the_newest_two_frames_wait_and_the_others_are_counted() -> None:
    mailbox, stop = Mailbox(), threading.Event()
    for t_us in range(5):
        mailbox.put(arrival(IMAGE, t_us), stop)
    taken = mailbox.take()
    assert taken is not None
    assert (taken.frame.t_us, taken.missed) == (3, 3)
    following = mailbox.take()
    assert following is not None
    assert (following.frame.t_us, following.missed) == (4, 0)
    assert (mailbox.received, mailbox.dropped) == (5, 3)


def test_a_cut_outlives_the_frame_that_brought_it() -> None:
    mailbox, stop = Mailbox(), threading.Event()
    mailbox.put(arrival(IMAGE, 0, cut=True), stop)
    for t_us in range(1, SLOTS + 1):
        mailbox.put(arrival(IMAGE, t_us), stop)
    taken = mailbox.take()
    assert taken is not None
    assert taken.cut


def test_who_is_not_paced_waits_and_nothing_is_dropped() -> None:
    mailbox, stop = Mailbox(), threading.Event()

    def put() -> None:
        for t_us in range(50):
            mailbox.put(arrival(IMAGE, t_us, paced=False), stop)

    giver = threading.Thread(target=put)
    giver.start()
    taken = [mailbox.take() for _ in range(50)]
    giver.join(PATIENCE_S)
    assert [each.frame.t_us for each in taken if each] == list(range(50))
    assert mailbox.dropped == 0


def test_a_stopped_capture_puts_nothing_and_waits_for_nobody() -> None:
    mailbox, stop = Mailbox(), threading.Event()
    mailbox.put(arrival(IMAGE, 0), stop)
    waiting = threading.Thread(target=mailbox.put, args=(arrival(IMAGE, 1, paced=False), stop))
    waiting.start()
    stop.set()
    mailbox.wake()
    waiting.join(PATIENCE_S)
    assert not waiting.is_alive()
    taken = mailbox.take()
    assert taken is not None
    assert (taken.frame.t_us, mailbox.received) == (0, 1)


def test_closing_ends_the_wait_for_a_frame() -> None:
    mailbox = Mailbox()
    taken: list[object] = []
    taker = threading.Thread(target=lambda: taken.append(mailbox.take()))
    taker.start()
    mailbox.close()
    taker.join(PATIENCE_S)
    assert taken == [None]
