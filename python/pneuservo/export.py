# Recordings into files that other programs open, and back: Parquet, MAT, MCAP, CSV.
"""python -m pneuservo.export RECORDING... --parquet | --mat | --mcap | --csv [--out FOLDER]

Every number comes back to the last bit of float64; units and header go along.
"""
import argparse
import gzip
import importlib.util
import io
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import warnings
import zlib
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Union

import numpy

from . import Config, InputError, Recording, __version__, read_recordings
from ._core import read_recordings as _read_own
from .errors import file_there
from .units import unit_of

Path = Union[str, "os.PathLike[str]"]
_Content = Tuple[Dict[str, Any], Dict[str, Any]]


FORMAT = "pneuservo-recording/1"
# What MATLAB and ROS 2 take for a name; MATLAB's own words are none.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,62}")
_WORDS = frozenset("break case catch classdef continue else elseif end for function global if otherwise parfor persistent return "
                   "spmd switch try while pneuservo".split())


def _identifiers(names: Sequence[str]) -> List[str]:
    """A name for each that every program takes: its own where it is one."""
    taken = {name for name in names if _NAME.fullmatch(name) and name not in _WORDS}
    found = []
    for name in names:
        if name not in taken:
            plain = "c_" + re.sub(r"[^A-Za-z0-9_]", "_", name)[:50]
            name = next(one for one in (plain, *(f"{plain}_{number}" for number in range(2, len(names) + 2))) if one not in taken)
            taken.add(name)
        found.append(name)
    return found


def _checksum(values: Any) -> int:
    return zlib.crc32(numpy.ascontiguousarray(values, dtype=numpy.float64))


def _about(recording: Recording) -> Dict[str, Any]:
    """What goes along with the columns; `columns` are the names of those that had to take another one."""
    names = list(recording.keys())
    return {"rig": recording.rig, "period_s": recording.period_s, "header": recording.header, "header_text": recording.header_text,
            "columns": {one: name for one, name in zip(_identifiers(names), names) if one != name},
            "crc32": {name: _checksum(recording[name]) for name in names}, "version": __version__}


def _numbers(name: str, values: Any, path: Path) -> Any:
    array = numpy.asarray(values)
    if array.dtype.kind not in "fiub":
        raise InputError(f"{path}: {name}: found a column of {array.dtype}, expected numbers: leave it out of the file")
    return numpy.ascontiguousarray(array, dtype=numpy.float64)


def _made(columns: Dict[str, Any], about: Dict[str, Any], path: Path, config: Optional[Config]) -> Recording:
    if "t_s" not in columns:
        raise InputError(f"{path}: found no column t_s, expected the times of the rows [s]; the file has {', '.join(columns) or 'no columns'}")
    header = about.get("header_text")
    if header is None:
        header = json.dumps(about["header"], ensure_ascii=False) if about.get("header") else ""
    period_s = about.get("period_s") or (config.period_s if config is not None else float("nan"))
    rig = about.get("rig") or (config.name if config is not None else "")
    numbers = {name: _numbers(name, values, path) for name, values in columns.items()}
    written = about.get("crc32") or {}
    lost = [name for name in written if name not in numbers]
    changed = [name for name in written if name in numbers and _checksum(numbers[name]) != written[name]]
    for what, names in (("no column", lost), ("other values of", changed)):
        if names:
            warnings.warn(f"{path}: found {what} {', '.join(names)}, expected those that were written: the file is damaged, or another "
                          "program changed it; export the recording again", stacklevel=3)
    return Recording(numbers, period_s=period_s, rig=rig, name=os.fspath(path), header_text=header)


def _to_parquet(recording: Recording, path: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit_of(name)}) for name in recording.keys()]
    schema = pyarrow.schema(fields, metadata={"pneuservo": json.dumps({**_about(recording), "columns": {}})})
    table = pyarrow.Table.from_arrays([pyarrow.array(recording[name]) for name in recording.keys()], schema=schema)
    pyarrow.parquet.write_table(table, path, compression="zstd")


def _from_parquet(path: Path) -> _Content:
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    about = json.loads((table.schema.metadata or {}).get(b"pneuservo", b"{}"))
    return {name: table[name].to_numpy() for name in table.column_names}, about


def _to_mat(recording: Recording, path: Path) -> None:
    import scipy.io

    names = list(recording.keys())
    columns = {one: recording[name] for one, name in zip(_identifiers(names), names)}
    about = {"units": {one: unit_of(name) for one, name in zip(columns, names)}, "about": json.dumps(_about(recording)),
             "columns": numpy.array(names, dtype=object)}
    scipy.io.savemat(path, {**columns, "pneuservo": about}, appendmat=False, long_field_names=True, oned_as="column")


# In a process of its own, which finds the packages of this one: scipy's reader may end its process on a damaged file, or
# never end. Prints the columns, each as c_NAME, and what goes along, as NPZ.
_MAT_READER = """
import json, sys
sys.path[:] = json.loads(sys.argv[2])
import numpy, scipy.io
content = scipy.io.loadmat(sys.argv[1], appendmat=False)
own = content.get("pneuservo")
columns = {"c_" + name: values.reshape(-1) for name, values in content.items()
           if not name.startswith("__") and isinstance(values, numpy.ndarray) and values.dtype.kind in "fiub"
           and values.ndim == 2 and 1 in values.shape}
about = "{}" if own is None else str(own["about"].item().item())
numpy.savez(sys.stdout.buffer, about=numpy.frombuffer(about.encode(), dtype=numpy.uint8), **columns)
"""
_MAT_READER_S = 300.0  # 20 minutes at 1 kHz take about a second


def _from_mat(path: Path) -> _Content:
    if importlib.util.find_spec("scipy") is None:
        raise ModuleNotFoundError(name="scipy")
    done = subprocess.run([sys.executable, "-c", _MAT_READER, os.path.abspath(path), json.dumps(sys.path)], capture_output=True,
                          timeout=_MAT_READER_S)
    if done.returncode != 0:
        raise ValueError((done.stderr.decode(errors="replace").strip().splitlines() or ["its reader ended without a word"])[-1])
    with numpy.load(io.BytesIO(done.stdout)) as file:
        arrays = {name: file[name] for name in file.files}
    about = json.loads(arrays.pop("about").tobytes())
    rows = len(arrays.get("c_t_s", ()))
    return {name.removeprefix("c_"): values for name, values in arrays.items() if len(values) > 1 or rows == 1}, about


def _to_mcap(recording: Recording, path: Path) -> None:
    from . import mcap_file

    names = list(recording.keys())
    units = [unit_of(name) for name in names]
    columns = {one: recording[name] for one, name in zip(_identifiers(names), names)}
    mcap_file.write(columns, units, json.dumps(_about(recording)), f"pneuservo {__version__}", path)


def _from_mcap(path: Path) -> _Content:
    from . import mcap_file

    columns, about = mcap_file.read(path)
    return columns, json.loads(about)


def _header_lines(recording: Recording) -> str:
    """The recording's own header where it is one of this program, else the keys that must be there."""
    text = recording.header_text
    if not text.startswith(f"format: {FORMAT}"):
        period_s = recording.period_s
        if not math.isfinite(period_s):
            period_s = float(numpy.median(numpy.diff(recording["t_s"]))) if len(recording) > 1 else 1.0
        text = f"format: {FORMAT}\nrig: {json.dumps(recording.rig or 'unknown', ensure_ascii=False)}\nperiod_s: {period_s!r}\n"
    return "".join(f"# {line}\n" for line in text.splitlines())


def _to_csv(recording: Recording, path: Path) -> None:
    names = list(recording.keys())
    for name in names:
        if not name or name != name.strip() or re.search(r'[,;"\t\r\n#]', name):
            raise InputError(f"{path}: found the column name {name!r}, expected one that CSV can have: without commas, quotes or ends of line")
    columns = [recording[name].tolist() for name in names]
    with gzip.open(path, "wt", encoding="utf-8", newline="\n") as file:
        file.write(_header_lines(recording) + ",".join(names) + "\n")
        for row in zip(*columns):
            file.write(",".join("" if value != value else repr(value) for value in row) + "\n")
    again = list(_read_own(os.fspath(path))[0].keys())
    if again != names:
        raise InputError(f"{path}: found the columns {', '.join(again)} when it was read back, expected {', '.join(names)}: rename them")


_FORMATS: Dict[str, Tuple[Callable[[Recording, Path], None], Callable[[Path], _Content]]] = {
    ".parquet": (_to_parquet, _from_parquet), ".mat": (_to_mat, _from_mat), ".mcap": (_to_mcap, _from_mcap)}
_WRITERS = {**{suffix: to_file for suffix, (to_file, _) in _FORMATS.items()}, ".csv.gz": _to_csv}


def _suffix_of(path: Path) -> str:
    name = os.fspath(path).lower()
    return ".csv.gz" if name.endswith(".csv.gz") else pathlib.Path(name).suffix


def _packages_lack(path: Path, error: ImportError) -> InputError:
    return InputError(f"{path}: found no package {error.name}, expected it for this format: pip install 'pneuservo[files]'")


def write(recording: Recording, path: Path, replace: bool = False) -> None:
    """A recording as .parquet, .mat, .mcap or .csv.gz, by the suffix; the file is there whole or not at all."""
    suffix, place = _suffix_of(path), pathlib.Path(path)
    if suffix not in _WRITERS:
        raise InputError(f"{path}: found the suffix '{suffix}', expected one of {', '.join(_WRITERS)}")
    if not place.parent.is_dir():
        raise InputError(f"{place.parent}: found no folder there, expected one: make it first")
    if not replace and os.path.exists(path):
        raise file_there(path)
    partial = place.with_name(f".{place.name}.{os.getpid()}.partial{suffix}")
    try:
        _WRITERS[suffix](recording, partial)
        os.replace(partial, path)
    except ImportError as error:
        raise _packages_lack(path, error) from error
    finally:
        partial.unlink(missing_ok=True)


def _content_of(path: Path, suffix: str) -> _Content:
    """Columns by their names, and what goes along."""
    if not os.path.isfile(path):
        raise InputError(f"{path}: found no file there, expected a recording")
    try:
        columns, about = _FORMATS[suffix][1](path)
        names = about.get("columns") or {}
        return {names.get(one, one): values for one, values in columns.items()}, about
    except InputError:
        raise
    except ImportError as error:
        raise _packages_lack(path, error) from error
    except Exception as error:  # each library has its own kinds
        reason = " ".join(str(error).split())[:120] or type(error).__name__
        raise InputError(f"{path}: found a file that is damaged or no {suffix} ({reason}), expected a whole one") from error


def read(path: Path, config: Optional[Config] = None) -> Recording:
    """What write() wrote, equal to the last bit; or any Parquet or MAT file with columns and times t_s [s].

    config: its period and name stand for those that a file of another program does not state.
    """
    suffix = _suffix_of(path)
    if suffix == ".csv.gz":
        return _read_own(os.fspath(path), config)[0]
    if suffix not in _FORMATS:
        raise InputError(f"{path}: found the suffix '{suffix}', expected one of {', '.join(_WRITERS)}")
    columns, about = _content_of(path, suffix)
    return _made(columns, about, path, config)


def _stem_of(source: Path) -> str:
    """Name without .gz and the ending before it."""
    stem = pathlib.Path(source).name.removesuffix(".gz")
    return stem[:stem.rindex(".")] if "." in stem else stem


def main(arguments: List[str]) -> int:
    """The command; its exit status."""
    parser = argparse.ArgumentParser(prog="python -m pneuservo.export", description="Recordings into files that other programs open.")
    parser.add_argument("recordings", nargs="+", metavar="RECORDING", help="of this program, or .parquet, .mat, .mcap")
    for suffix in _WRITERS:
        parser.add_argument(f"--{suffix[1:].removesuffix('.gz')}", action="append_const", const=suffix, dest="suffixes", help=f"write NAME{suffix}")
    parser.add_argument("--out", default=".", metavar="FOLDER", help="where the files go; default: here")
    parser.add_argument("--force", action="store_true", help="replaces files that are there")
    given = parser.parse_args(arguments)
    if not given.suffixes:
        parser.error("expected at least one of --parquet, --mat, --mcap, --csv")
    try:
        for source in given.recordings:
            runs, stem = read_recordings(source), _stem_of(source)
            for number, run in enumerate(runs, 1):
                for suffix in given.suffixes:
                    name = stem if len(runs) == 1 else f"{stem}-{number}"
                    path = pathlib.Path(given.out, name + suffix)
                    write(run, path, given.force)
                    print(f"written: {path}")
    except (OSError, ValueError) as error:
        print(f"export: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
