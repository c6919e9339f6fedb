# The Python package: what the program does, as objects and arrays.
"""Pneumatic servo axes with long lines: estimator, plant, laws, diagnosis, design, recordings.

Quantities are in SI units, which stand in the names (pressures absolute, x_m = 0 at mid-stroke). Names are those of
configs and recordings. Arrays are numpy's float64 of shape (rows,), read and given without a copy. Long calls release
the interpreter's lock; an object that two threads use at once refuses the second one.
"""
import json
import os
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Union, cast

from ._processor import folders as _folders

__path__ = _folders(os.path.dirname(os.path.abspath(__file__)))  # before the module is looked for

from ._core import (AxisValues, Config, Design, Estimate, Estimator, ImportResult, Improvement, Law, Machine, Plant,
                    Recording, Refit, Run, __version__, design, import_recording, run)
from ._core import Diagnosis as _Diagnosis
from ._core import diagnose as _diagnose
from ._core import improve as _improve
from ._core import read_recordings as _read_recordings
from ._core import refit as _refit
from ._core import simulate as _simulate
from .errors import AxisRefused, DiagnosisStopped, InputError

__all__ = ["AxisRefused", "AxisValues", "Config", "Design", "Diagnosis", "DiagnosisStopped", "Estimate", "Estimator",
           "ImportResult", "Improvement", "InputError", "Law", "Machine", "Plant", "Recording", "Refit", "Run",
           "__version__", "design", "diagnose", "import_recording", "improve", "read_recordings", "recording_of", "refit",
           "run", "simulate", "state_space", "to_dict", "to_pandas"]

Diagnosis = _Diagnosis
_Path = Union[str, "os.PathLike[str]"]
Source = Union[str, "os.PathLike[str]", Recording, Mapping[str, Any]]
_EXPORTED = (".parquet", ".mat", ".mcap")  # read by pneuservo.export
Progress = Callable[[float, str], Optional[bool]]


def read_recordings(path: _Path, config: Optional[Config] = None) -> List[Recording]:
    """The runs of one file; text of other loggers by the config's section import. Raises InputError.

    Parquet, MAT and MCAP have columns by our names, with t_s [s]: what pneuservo.export writes.
    """
    if os.fspath(path).lower().endswith(_EXPORTED):
        from . import export

        return [export.read(path, config)]
    return _read_recordings(os.fspath(path), config)


def recording_of(source: Source, config: Optional[Config] = None) -> Recording:
    """One recording from a file (its first run), a mapping of columns or a DataFrame with t_s [s]."""
    if isinstance(source, Recording):
        return source
    if isinstance(source, (str, os.PathLike)):
        return read_recordings(source, config)[0]
    period_s = config.period_s if config is not None else float("nan")
    return Recording(source, period_s=period_s, rig=config.name if config is not None else "")


def simulate(config: Config, command: Source) -> Dict[str, Any]:
    """The plant alone on a recorded command: t_s and u_V (u1_V and u2_V of a servo table), held over gaps.

    Starts at the recording's first position and pressures, at rest. Gives columns of shape (rows,) by their names in
    recordings, without sensor noise.
    """
    recording = recording_of(command, config)
    return {"t_s": recording["t_s"], **_simulate(config, recording)}


def _recordings(sources: Union[Source, Iterable[Source]], config: Config) -> List[Recording]:
    out: List[Recording] = []
    if isinstance(sources, (str, os.PathLike, Recording)) or hasattr(sources, "items"):  # columns, a DataFrame
        sources = [cast(Source, sources)]
    if not hasattr(sources, "__iter__"):
        raise TypeError(f"recordings: found {type(sources).__name__}, expected a list of files, Recording objects or columns")
    for source in sources:
        if isinstance(source, (str, os.PathLike)):
            out += read_recordings(source, config)
        else:
            out.append(recording_of(source, config))
    return out


def diagnose(config: Config, recordings: Sequence[Source], held_out: Sequence[Source] = (), *, jobs: int = 0,
             as_curve: bool = False, progress: Optional[Progress] = None,
             cancel: Any = None) -> Diagnosis:
    """Where and why recordings of the machine differ from its config.

    held_out: recordings that no fit sees. jobs: threads, 0: all of the machine. as_curve: of an unknown a table in its
    place, too. progress(share, what) is called as it goes on; False from it cancels, as does a set threading.Event
    in cancel. Ctrl-C or cancelling gives what is known by then, with `stopped` true. Where nothing is known yet, or all
    was done already, Ctrl-C raises KeyboardInterrupt; cancelling raises DiagnosisStopped in the first case.
    """
    return _diagnose(config, _recordings(recordings, config), _recordings(held_out, config), jobs, as_curve, progress,
                     cancel)


def refit(config: Config, recordings: Sequence[Source], effects: Sequence[str], *, jobs: int = 0,
          progress: Optional[Progress] = None, cancel: Any = None) -> Refit:
    """The sizes of these effects by recordings of a machine that is known: coulomb_friction, chamber_leak_1, valve_lag.

    All are fitted together, with the config's tolerances and the starts free beside them; nothing is sought or judged.
    Effects that the config has begin at its sizes. jobs, progress and cancel are as
    in diagnose(); a refit that is ended raises DiagnosisStopped or KeyboardInterrupt. Raises InputError for effects
    without a size that a derivative finds.
    """
    return _refit(config, _recordings(recordings, config), list(effects), jobs, progress, cancel)


def improve(config: Config, recordings: Sequence[Source], held_out: Sequence[Source] = (), *, jobs: int = 0,
            progress: Optional[Progress] = None, cancel: Any = None) -> Improvement:
    """A config that controls the machine of these recordings better, and what it reaches on the improved model.

    Diagnoses again from what was found while that gains, makes the command pass and predicts the largest position error
    before and after [m]. `improved` is the config, to_yaml() its text. held_out, jobs, progress, cancel and Ctrl-C are
    as in diagnose(); a result with `stopped` true has the diagnoses that were done, and predicts nothing. Raises
    InputError for a rig or law without a command pass, and for recordings of another rig.
    """
    return _improve(config, _recordings(recordings, config), _recordings(held_out, config), jobs, progress, cancel)


def to_dict(result: Union[Diagnosis, Improvement, Design, Config]) -> Dict[str, Any]:
    """A diagnosis, an improvement or a design as the verbs' --json, a config by its keys."""
    return result.to_dict() if isinstance(result, Config) else cast(Dict[str, Any], json.loads(result.json()))


def to_pandas(source: Any) -> Any:
    """A DataFrame: of a recording, a run or columns, of a diagnosis (a row an answer) or an improvement (a row a key)."""
    import pandas

    if isinstance(source, Diagnosis):
        return pandas.DataFrame(to_dict(source)["answers"])
    if isinstance(source, Improvement):
        return pandas.DataFrame.from_dict(to_dict(source)["changes"], orient="index", columns=["before", "after"])
    columns = source.columns if isinstance(source, Run) else source
    return pandas.DataFrame({name: columns[name] for name in columns.keys()}, copy=False)


def state_space(design: Design, order: Optional[int] = None) -> Any:
    """python-control's StateSpace of the axis: command [V] to position [m], velocity [m/s], acceleration [m/s2]."""
    import control

    return control.ss(*design.matrices(order), inputs=["u_V"], outputs=["x_m", "v_mps", "a_mps2"])
