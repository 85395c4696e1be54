"""Records in a folder that many write into."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from presswear.sweeps import store as stores
from presswear.sweeps.store import CLAIMS, FILE, RECORDS, Record, Records, Store
from presswear.tools.errors import InputError
from presswear.tools.files import digest


def name(number: int) -> str:
    return digest(f"{number}".encode())


def record(number: int) -> Record:
    values: dict[str, tuple[float | None, float | None, bool]] = {
        "x": (0.1 * number, None, False),
        "life": (1.0 / 3.0, 2.0, True),
    }
    return Record((name(number),), values, 2, wall_s=0.25)


def opened(path: Path) -> Records:
    found = Records(path)
    found.refresh()
    return found


def file_of(path: Path) -> Path:
    (found,) = path.glob(f"{RECORDS}/*/{FILE}")
    return found


def test_what_is_sealed_is_read_back_to_the_last_digit(tmp_path: Path) -> None:
    with Store(tmp_path) as store:
        for number in range(50):
            store.seal(record(number), name(number))
        assert store.get(name(7)) == record(7)
    found = opened(tmp_path)
    assert len(found) == 50
    assert [found.get(name(number)) for number in range(50)] == [record(k) for k in range(50)]
    assert found.get(name(50)) is None
    assert not found.is_sealed(name(50))
    assert found.damaged == 0


@pytest.mark.parametrize("cut", [1, 30, 200])
def test_a_line_that_is_cut_off_is_no_record_and_harms_no_other(tmp_path: Path, cut: int) -> None:
    with Store(tmp_path) as store:
        for number in range(5):
            store.seal(record(number), name(number))
    file = file_of(tmp_path)
    file.write_bytes(file.read_bytes()[:-cut])
    assert [opened(tmp_path).is_sealed(name(number)) for number in range(5)] == [*[True] * 4, False]
    with Store(tmp_path) as store:
        assert store.claim(name(4))
        store.seal(record(4), name(4))
    found = opened(tmp_path)
    assert [found.get(name(number)) for number in range(5)] == [record(k) for k in range(5)]


def test_a_line_that_is_altered_is_no_record(tmp_path: Path) -> None:
    with Store(tmp_path) as store:
        for number in range(3):
            store.seal(record(number), name(number))
    file = file_of(tmp_path)
    lines = file.read_bytes().split(b"\n")
    lines[1] = lines[1].replace(b"0.1", b"0.2")
    file.write_bytes(b"\n".join(lines))
    found = opened(tmp_path)
    assert [found.is_sealed(name(number)) for number in range(3)] == [True, False, True]
    assert found.damaged == 1


def test_a_row_is_claimed_once_and_free_again_when_it_is_given_up(tmp_path: Path) -> None:
    with Store(tmp_path) as first, Store(tmp_path) as second:
        assert first.claim(name(1))
        assert not second.claim(name(1))
        assert second.claim(name(2))
        first.release((name(1),))
        assert second.claim(name(1))
        assert not first.claim(name(2))
    with Store(tmp_path) as third:
        assert third.claim(name(1))


def test_what_another_has_sealed_meanwhile_is_not_claimed(tmp_path: Path) -> None:
    with Store(tmp_path) as first, Store(tmp_path) as second:
        assert first.claim(name(1))
        first.seal(record(1), name(1))
        first.flush()
        assert not second.claim(name(1))
        assert second.get(name(1)) == record(1)
        assert not list((tmp_path / CLAIMS).iterdir())


HOLDS = """
import sys, time
from pathlib import Path
from presswear.sweeps.store import Store
store = Store(Path(sys.argv[1]))
print(store.claim(sys.argv[2]), flush=True)
time.sleep(60)
"""


def test_a_claim_ends_with_its_process(tmp_path: Path) -> None:
    holding = subprocess.Popen(
        [sys.executable, "-c", HOLDS, str(tmp_path), name(1)], stdout=subprocess.PIPE, text=True
    )
    assert holding.stdout is not None
    try:
        assert holding.stdout.readline() == "True\n"
        with Store(tmp_path) as store:
            assert not store.claim(name(1))
            holding.send_signal(signal.SIGKILL)
            holding.wait()
            assert store.claim(name(1))
    finally:
        holding.kill()
        holding.wait()
        holding.stdout.close()


def test_a_claim_from_elsewhere_ends_when_no_sign_comes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    far = "another-machine-1-00"
    (tmp_path / RECORDS / far).mkdir(parents=True)
    (tmp_path / CLAIMS).mkdir()
    os.symlink(far, tmp_path / CLAIMS / name(1))
    with Store(tmp_path) as store:
        assert not store.claim(name(1))
        old = time.time() - stores.LEASE - 5.0
        os.utime(tmp_path / RECORDS / far, (old, old))
        assert store.claim(name(1))


def take_all(path: str, rows: int, told: str) -> None:
    """Claim and seal rows; tell which."""
    with Store(Path(path)) as store:
        for number in range(rows):
            if not store.is_sealed(name(number)) and store.claim(name(number)):
                with Path(told).open("a") as file:
                    file.write(f"{number}\n")
                store.seal(record(number), name(number))
                store.flush()


def test_of_processes_that_want_the_same_each_row_goes_to_one(tmp_path: Path) -> None:
    context, rows = multiprocessing.get_context("forkserver"), 200
    files = [str(tmp_path / f"told-{k}") for k in range(3)]
    processes = [
        context.Process(target=take_all, args=(str(tmp_path / "sweep"), rows, file))
        for file in files
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join()
        assert process.exitcode == 0
    told = [Path(file).read_text() for file in files if Path(file).exists()]
    taken = [int(own) for text in told for own in text.split()]
    assert sorted(taken) == list(range(rows))


def test_what_is_to_be_tried_again_is_not_sealed_and_gives_way(tmp_path: Path) -> None:
    with Store(tmp_path) as store:
        store.seal(Record((name(1),), reason="out of memory", again=True), name(1))
        assert not store.is_sealed(name(1))
        assert store.has_failed(name(1))
    with Store(tmp_path) as store:
        assert store.claim(name(1))
        store.seal(record(1), name(1))
    found = opened(tmp_path)
    assert found.get(name(1)) == record(1)
    assert not found.has_failed(name(1))


def test_a_whole_result_that_is_wanted_takes_the_place_of_numbers(tmp_path: Path) -> None:
    whole = Record((name(1),), {}, 2, folder=True)
    with Store(tmp_path) as store:
        store.seal(record(1), name(1))
        assert not store.is_sealed(name(1), with_folder=True)
        store.seal(whole, name(1))
        assert store.is_sealed(name(1), with_folder=True)
    with Store(tmp_path) as store:
        store.seal(record(1), name(1))
    assert opened(tmp_path).get(name(1)) == whole


def test_a_process_that_just_begins_is_not_taken_for_one_that_has_ended(tmp_path: Path) -> None:
    with Store(tmp_path / "its") as its:
        its.seal(record(1), name(1))
        (written,) = tmp_path.glob("its/records/*/records.jsonl")
        folder = tmp_path / "ours" / RECORDS / "another"
        folder.mkdir(parents=True)
        found = opened(tmp_path / "ours")
        (folder / "lock").write_text("")
        (folder / written.name).write_bytes(written.read_bytes())
        found.refresh()
        assert found.get(name(1)) == record(1)


def test_what_is_forgotten_is_sealed_anew(tmp_path: Path) -> None:
    with Store(tmp_path) as store:
        store.seal(record(1), name(1))
        store.forget(name(1))
        assert not store.is_sealed(name(1))
        store.flush()
        assert store.claim(name(1))
        store.seal(record(1), name(1))
    assert opened(tmp_path).get(name(1)) == record(1)


def test_what_a_process_leaves_that_is_killed_as_it_begins_is_free(tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    assert stores.can_begin(folder)
    with Store(folder) as store:
        (folder / "sweep.json.5a5a.part").write_text("{")
        assert stores.can_begin(folder)
        store.seal(record(1), name(1))
        assert not stores.can_begin(folder)
    (tmp_path / "notes.txt").write_text("")
    assert not stores.can_begin(tmp_path)
    assert not stores.can_begin(tmp_path / "notes.txt")


def test_a_store_that_nothing_came_of_leaves_nothing(tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    with Store(folder) as store:
        assert store.claim(name(1))
    assert not folder.exists()


def test_a_folder_that_cannot_be_written_into_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="nothing can be written there"):
        Store(tmp_path / "file" / "sweep")
