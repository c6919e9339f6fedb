# Many recordings diagnosed on many workers: a row each, resumable, on Dask.
"""python -m pneuservo.fleet RECORDINGS... [--config CONFIG] [--scheduler ADDRESS] [--workers N] [--out FOLDER]

Diagnoses each recording, and keeps a row of it as soon as it is known. The same command goes on where it ended.
"""
import argparse
import datetime
import hashlib
import json
import os
import pathlib
import re
import sys
import time
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Tuple, Union

from . import Config, __version__, diagnose, read_recordings, refit, to_dict
from .errors import FleetStopped, InputError
from .sizes import REFITTED, refitted_sizes, sizes

Path = Union[str, os.PathLike]
Row = Dict[str, Any]
_DATE = re.compile(r"(?<!\d)(\d{4}-\d\d-\d\d)(?!\d)")
TELL_EVERY_S = 5.0


def _date_of(path: pathlib.Path) -> str:
    """The date in the file's name or its folder's, else that of the file."""
    for stated in (*_DATE.findall(path.name), *_DATE.findall(path.parent.name)):
        try:
            return datetime.date.fromisoformat(stated).isoformat()
        except ValueError:
            pass  # no such day
    return time.strftime("%Y-%m-%d", time.gmtime(path.stat().st_mtime))


def _config_of(path: str, config_text: Optional[str]) -> Config:
    """The config that is stated, else the one that the recording was made with."""
    if config_text is None:
        own = read_recordings(path)[0].header.get("config")
        if own is None:
            raise InputError(f"{path}: found no config in the header, expected one there or by --config")
        config_text = own if isinstance(own, str) else json.dumps(own)
    return Config.from_text(config_text, f"config of {path}")


def refitted(path: str, config_text: Optional[str]) -> Row:
    """The row of one recording by a refit: sizes with their standard errors, and no verdict."""
    config = _config_of(path, config_text)
    runs = read_recordings(path, config)
    result = refit(config, runs, REFITTED, jobs=1)
    return {"rig": config.name, "sentence": f"refitted: {', '.join(REFITTED)}", "misfit": result.misfit,
            **refitted_sizes(result, runs, config)}


def diagnosed(path: str, config_text: Optional[str]) -> Row:
    """The row of one recording: sizes, verdict, and the whole diagnosis. Without a config: the one it was recorded with."""
    config = _config_of(path, config_text)
    runs = read_recordings(path, config)
    result = diagnose(config, runs, jobs=1)
    return {"rig": config.name, "verdict": result.verdict, "sentence": result.sentence,
            **sizes(result, runs, config), "diagnosis": to_dict(result)}


def _worked(work: Callable[[str, Optional[str]], Row], path: str, config_text: Optional[str]) -> Row:
    """A row also of what cannot be done."""
    begin = time.monotonic()
    try:
        row = {"status": "done", **work(path, config_text)}
    except MemoryError:
        row = {"status": "lost", "sentence": f"{path}: the worker has too little memory for it, expected more a worker (--workers)"}
    except Exception as error:  # whatever it is: one recording never ends the others
        kind = "" if isinstance(error, (InputError, OSError)) else f"{type(error).__name__}: "
        row = {"status": "failed", "sentence": kind + (" ".join(str(error).splitlines()) or "no reason was given")}
    return {**row, "seconds": time.monotonic() - begin}


class Results:
    """A folder of rows, a file a recording, that are there whole or not at all."""

    def __init__(self, folder: Path) -> None:
        self.folder = pathlib.Path(folder)
        (self.folder / "rows").mkdir(parents=True, exist_ok=True)

    def path_of(self, key: str) -> pathlib.Path:
        return self.folder / "rows" / f"{key}.json"

    def is_finished(self, key: str, made_of: Optional[str] = None) -> bool:
        """Done of this, or failed for a reason that stays. What a worker was lost with is tried again."""
        path = self.path_of(key)
        if not path.exists():
            return False
        row = json.loads(path.read_text(encoding="utf-8"))
        return row["status"] != "lost" and made_of in (None, row.get("made_of"))

    def add(self, key: str, row: Mapping[str, Any]) -> None:
        _replace(self.path_of(key), json.dumps(row).encode())

    def rows(self) -> List[Row]:
        """One a recording: of rows that other versions of the program left beside it the newest."""
        current: Dict[str, Row] = {}
        for path in sorted(self.folder.glob("rows/*.json"), key=lambda path: (path.stat().st_mtime_ns, path.name)):
            row = json.loads(path.read_text(encoding="utf-8"))
            current[os.path.realpath(row["recording"])] = row
        return list(current.values())

    def write_parquet(self) -> pathlib.Path:
        """All rows as one table, ordered by axis and date; the diagnosis is a column of JSON."""
        import pandas

        rows = [{**row, "diagnosis": json.dumps(row["diagnosis"])} if "diagnosis" in row else row for row in self.rows()]
        frame = pandas.DataFrame(rows)
        if len(frame):
            frame = frame.sort_values(["axis", "date", "recording"], ignore_index=True)
        target = self.folder / "results.parquet"
        partial = target.with_suffix(".partial")
        frame.to_parquet(partial)
        os.replace(partial, target)
        return target


def _replace(path: pathlib.Path, content: bytes) -> None:
    partial = path.with_suffix(f".{os.getpid()}.partial")
    with open(partial, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    os.replace(partial, path)


def _key_of(path: pathlib.Path) -> str:
    """Of a recording's row: its name, and where it lies."""
    return f"{path.name.split('.')[0]}-{hashlib.sha256(os.path.realpath(path).encode()).hexdigest()[:16]}"


def _made_of(path: pathlib.Path, config_text: Optional[str], work: Callable[..., Row]) -> str:
    """Content of the recording with the config's, and the work: what is the same is not done again."""
    digest = hashlib.sha256(f"{__version__}\n{work.__qualname__}\n{config_text}\n".encode())
    digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _open_tasks(paths: Iterable[Path], config_text: Optional[str], work: Callable[..., Row], results: Results) -> Dict[str, Row]:
    """What is not finished, by key. An unreadable file is a lost row at once, unless an earlier one is finished."""
    tasks: Dict[str, Row] = {}
    for path in map(pathlib.Path, paths):
        key, about = _key_of(path), {"recording": str(path), "axis": path.resolve().parent.name}
        try:
            made_of = _made_of(path, config_text, work)
            if not results.is_finished(key, made_of):
                tasks[key] = {**about, "date": _date_of(path), "made_of": made_of}
        except OSError as error:
            if not results.is_finished(key):
                results.add(key, {**about, "date": "", "status": "lost", "sentence": f"{path}: {error.strerror}"})
    return tasks


def _row_of(future: Any, path: str) -> Optional[Row]:
    """What came of one task; None: the cluster forgot it."""
    from dask.distributed import KilledWorker

    if future.status == "finished":
        return future.result()
    error = future.exception() if future.status == "error" else None
    if isinstance(error, KilledWorker):
        return {"status": "lost", "sentence": f"{path}: its worker died each time it was tried, expected enough memory: fewer --workers"}
    return {"status": "lost", "sentence": f"{path}: {error}"} if error else None


def _gather(client: Any, tasks: Mapping[str, Row], work: Callable[..., Row], config_text: Optional[str], results: Results,
            progress: Callable[[int, int, int], None]) -> None:
    from dask.distributed import as_completed

    futures = {client.submit(_worked, work, str(pathlib.Path(about["recording"]).resolve()), config_text,
                             key=f"{key}-{about['made_of']}", pure=False): key
               for key, about in tasks.items()}
    done = failed = 0
    completed = as_completed(futures, loop=client.loop)
    try:
        for future in completed:
            key = futures[future]
            if future.status in ("lost", "pending") and client.status == "running":
                completed.add(future)  # its worker died with the result, and another one computes it anew
                continue
            row = _row_of(future, tasks[key]["recording"])
            if row is None:
                raise FleetStopped(f"the cluster went away with {done} of {len(tasks)} recordings done; they are kept in "
                                   f"{results.folder}, the same command goes on")
            done += 1
            failed += row["status"] != "done"
            results.add(key, {**tasks[key], **row})
            future.release()
            progress(done, len(tasks), failed)
    finally:
        if client.status == "running":
            client.cancel(list(futures))


def _connected(scheduler: Optional[str], workers: Optional[int]) -> Tuple[Any, Any]:
    """A client, and the cluster of one's own that it needs."""
    import dask
    from dask.distributed import Client, LocalCluster

    dask.config.set({"distributed.comm.retry.count": 0})
    if scheduler:
        try:
            return Client(scheduler, timeout="10s", set_as_default=False), None
        except (OSError, ValueError) as error:
            raise FleetStopped(f"{scheduler}: found no Dask scheduler, expected an address such as tcp://host:8786 ({error})") from None
    cluster = LocalCluster(n_workers=workers or os.cpu_count() or 1, threads_per_worker=1, dashboard_address=":0")
    return Client(cluster, set_as_default=False), cluster


def run_fleet(recordings: Iterable[Path], config: Optional[Config] = None, out: Path = "fleet", *,
              scheduler: Optional[str] = None, workers: Optional[int] = None, work: Callable[[str, Optional[str]], Row] = diagnosed,
              progress: Callable[[int, int, int], None] = lambda done, of, failed: None) -> pathlib.Path:
    """Does what is not finished yet, and gives the table of all rows.

    work(path, config as text): the row of one recording, by default diagnosed(). Workers read the recordings themselves.
    workers: on this machine, by default one a processor. progress(done, of, failed) is called after each. Raises
    FleetStopped where the cluster goes away; rows are kept.
    """
    if workers is not None and workers < 1:
        raise InputError(f"workers: found {workers}, expected at least 1: leave it out for one a processor")
    results = Results(out)
    config_text = config.to_yaml() if config is not None else None
    tasks = _open_tasks(recordings, config_text, work, results)
    try:
        if tasks:
            client, cluster = _connected(scheduler, workers)
            try:
                _gather(client, tasks, work, config_text, results, progress)
            finally:
                client.close()
                if cluster is not None:
                    cluster.close()
    finally:
        table = results.write_parquet()
    return table


class _Teller:
    """Progress on standard error, every few seconds."""

    def __init__(self) -> None:
        self.begin = self.told = time.monotonic()

    def __call__(self, done: int, of: int, failed: int) -> None:
        now = time.monotonic()
        if now - self.told < TELL_EVERY_S and done < of:
            return
        self.told = now
        left_s = (now - self.begin) / done * (of - done)
        print(f"fleet: {done} of {of} done, {failed} failed, {left_s:.0f} s left", file=sys.stderr, flush=True)


def main(arguments: List[str]) -> int:
    """The command; its exit status."""
    parser = argparse.ArgumentParser(prog="python -m pneuservo.fleet", description="Diagnoses many recordings on many workers.")
    parser.add_argument("recordings", nargs="+", metavar="RECORDING", help="a folder an axis, the date in the file's name")
    parser.add_argument("--config", help="of all recordings; default: the one that each was recorded with")
    parser.add_argument("--refit", action="store_true",
                        help="only fit friction, leaks and valve lag, each with its standard error; no verdict")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster; default: workers on this machine")
    parser.add_argument("--workers", type=int, metavar="N", help="on this machine; default: one a processor")
    parser.add_argument("--out", default="fleet", metavar="FOLDER", help="where the rows go; default: fleet")
    given = parser.parse_args(arguments)
    try:
        config = Config(given.config) if given.config else None
        table = run_fleet(given.recordings, config, given.out, scheduler=given.scheduler, workers=given.workers,
                          work=refitted if given.refit else diagnosed, progress=_Teller())
    except KeyboardInterrupt:
        print(f"fleet: stopped; what is done is kept in {given.out}, the same command goes on", file=sys.stderr)
        return 130
    except (FleetStopped, InputError, OSError) as error:
        print(f"fleet: {error}", file=sys.stderr)
        return 2
    print(f"written: {table}")
    given_paths = {os.path.realpath(path) for path in given.recordings}
    rows = [row for row in Results(given.out).rows() if os.path.realpath(row["recording"]) in given_paths]
    if all(row["status"] == "lost" for row in rows):
        print(f"fleet: found no recording that was done of {len(rows)}, expected at least one; the first: {rows[0]['sentence']}",
              file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    # The workers know the functions by their module, which a script run by -m is not.
    from pneuservo import fleet

    sys.exit(fleet.main(sys.argv[1:]))
