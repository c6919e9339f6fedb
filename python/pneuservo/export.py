# Recordings into files that other programs open, and back: Parquet, MAT, MCAP.
"""python -m pneuservo.export RECORDING... --parquet | --mat | --mcap [--out FOLDER]

Every number comes back to the last bit of float64; units and header go along.
"""
import argparse
import json
import os
import pathlib
import sys
from typing import Any, Dict, List, Tuple, Union

import numpy

from . import InputError, Recording, __version__, read_recordings
from .errors import file_there
from .units import unit_of

Path = Union[str, os.PathLike]


def _about(recording: Recording) -> Dict[str, Any]:
    return {"rig": recording.rig, "period_s": recording.period_s, "header": recording.header, "version": __version__}


def _made(columns: Dict[str, Any], about: Dict[str, Any], path: Path) -> Recording:
    if "t_s" not in columns:
        raise InputError(f"{path}: found no column t_s, expected the times of the rows [s]; the file has {', '.join(columns) or 'no columns'}")
    return Recording(columns, period_s=about.get("period_s") or float("nan"), rig=about.get("rig") or "", name=os.fspath(path))


def _to_parquet(recording: Recording, path: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    fields = [pyarrow.field(name, pyarrow.float64(), metadata={"unit": unit_of(name)}) for name in recording.keys()]
    schema = pyarrow.schema(fields, metadata={"pneuservo": json.dumps(_about(recording))})
    table = pyarrow.Table.from_arrays([pyarrow.array(recording[name]) for name in recording.keys()], schema=schema)
    pyarrow.parquet.write_table(table, path, compression="zstd")


def _from_parquet(path: Path) -> Recording:
    import pyarrow.parquet

    table = pyarrow.parquet.read_table(path)
    about = json.loads((table.schema.metadata or {}).get(b"pneuservo", b"{}"))
    return _made({name: table[name].to_numpy() for name in table.column_names}, about, path)


def _to_mat(recording: Recording, path: Path) -> None:
    import scipy.io

    columns = {name: recording[name] for name in recording.keys()}
    about = {"units": {name: unit_of(name) for name in columns}, "about": json.dumps(_about(recording))}
    scipy.io.savemat(path, {**columns, "pneuservo": about}, long_field_names=True, oned_as="column")


def _from_mat(path: Path) -> Recording:
    import scipy.io

    content = scipy.io.loadmat(path, simplify_cells=True)
    about = json.loads(content.get("pneuservo", {}).get("about", "{}"))
    arrays = {name: values for name, values in content.items()
              if not name.startswith("__") and isinstance(values, numpy.ndarray) and values.ndim == 1}
    return _made(arrays, about, path)


def _to_mcap(recording: Recording, path: Path) -> None:
    from . import mcap_file

    columns = {name: recording[name] for name in recording.keys()}
    mcap_file.write(columns, json.dumps(_about(recording)), f"pneuservo {__version__}", path)


def _from_mcap(path: Path) -> Recording:
    from . import mcap_file

    columns, about = mcap_file.read(path)
    return _made(columns, json.loads(about), path)


_FORMATS = {".parquet": (_to_parquet, _from_parquet), ".mat": (_to_mat, _from_mat), ".mcap": (_to_mcap, _from_mcap)}


def _format_of(path: Path) -> Tuple[Any, Any]:
    suffix = pathlib.Path(path).suffix.lower()
    if suffix not in _FORMATS:
        raise InputError(f"{path}: found the suffix '{suffix}', expected one of {', '.join(_FORMATS)}")
    return _FORMATS[suffix]


def write(recording: Recording, path: Path, replace: bool = False) -> None:
    """A recording as .parquet, .mat or .mcap, by the suffix."""
    to_file, _ = _format_of(path)
    if not replace and os.path.exists(path):
        raise file_there(path)
    to_file(recording, path)


def read(path: Path) -> Recording:
    """What write() wrote, equal to the last bit; or any Parquet or MAT file with columns and times t_s [s]."""
    _, from_file = _format_of(path)
    return from_file(path)


def main(arguments: List[str]) -> int:
    """The command; its exit status."""
    parser = argparse.ArgumentParser(prog="python -m pneuservo.export", description="Recordings into files that other programs open.")
    parser.add_argument("recordings", nargs="+", metavar="RECORDING", help="of this program, or .parquet, .mat, .mcap")
    for suffix in _FORMATS:
        parser.add_argument(f"--{suffix[1:]}", action="append_const", const=suffix, dest="suffixes", help=f"write NAME{suffix}")
    parser.add_argument("--out", default=".", metavar="FOLDER", help="where the files go; default: here")
    parser.add_argument("--force", action="store_true", help="replaces files that are there")
    given = parser.parse_args(arguments)
    if not given.suffixes:
        parser.error("expected at least one of --parquet, --mat, --mcap")
    try:
        for source in given.recordings:
            own = pathlib.Path(source).suffix.lower() in _FORMATS
            runs = [read(source)] if own else read_recordings(source)
            stem = pathlib.Path(source).name.removesuffix(".gz")
            stem = stem[:stem.rindex(".")] if "." in stem else stem
            for number, run in enumerate(runs, 1):
                for suffix in given.suffixes:
                    name = stem if len(runs) == 1 else f"{stem}-{number}"
                    path = pathlib.Path(given.out, name + suffix)
                    write(run, path, given.force)
                    print(f"written: {path}")
    except (InputError, OSError) as error:
        print(f"export: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
