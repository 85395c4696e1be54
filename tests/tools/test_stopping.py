"""Signals, and what they may not disturb."""

import os
import signal
import threading

import pytest

from presswear.tools.stopping import deferred


def test_a_signal_arrives_behind_what_it_may_not_stop_whichever_thread_takes_it() -> None:
    done: list[str] = []
    is_time = threading.Event()

    def stop() -> None:
        is_time.wait()
        os.kill(os.getpid(), signal.SIGINT)

    other = threading.Thread(target=stop)
    other.start()

    def begin() -> None:
        # Blocked in this thread alone, as where processes begin.
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            with deferred():
                is_time.set()
                other.join()
                done.extend(["first", "second"])
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    with pytest.raises(KeyboardInterrupt):
        begin()
    assert done == ["first", "second"]
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_without_a_signal_nothing_changes() -> None:
    with deferred():
        pass
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
