"""Begin, or go on with, a sweep of made-up rows in a process of its own.

python submit_rows.py FOLDER ROWS SECONDS MARKS DEADLY ON
"""

import sys
from pathlib import Path

from made_up_rows import MadeUpWork

from presswear.sweeps.executors import runner_of
from presswear.sweeps.run import run_rows
from presswear.sweeps.store import Store


def main(words: list[str]) -> None:
    folder, rows, seconds, marks, deadly, on = words
    work = MadeUpWork(int(rows), float(seconds), False, marks, deadly)
    with Store(Path(folder)) as store:
        runner = runner_of(on, 2, lambda line: print(line, flush=True))
        print(run_rows(work, store, runner, range(work.rows)), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
