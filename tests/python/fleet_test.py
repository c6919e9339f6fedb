# Many recordings on Dask: all done once, killed workers lose nothing, what is bad is a row, what is done stays.
# tags: long
import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import pandas
import pytest

import pneuservo
from conftest import CYLINDER
from pneuservo import fleet
from pneuservo.errors import FleetStopped


# They wait for processes that end: minutes on a loaded machine.
LONG = pytest.mark.skipif(os.environ.get("PNEUSERVO_LONG", "") == "", reason="SKIPPED: long, tools/long-test runs it")


def counted(path, config_text):
    """Stands for a diagnosis: leaves a line a call, dies or fails where the recording says so."""
    text = pathlib.Path(path).read_text()
    calls = pathlib.Path(path + ".calls")
    with open(calls, "a") as file:
        file.write("called\n")
    if text.startswith("kill the worker once") and len(calls.read_text().splitlines()) == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    if text.startswith("kill the worker always"):
        os.kill(os.getpid(), signal.SIGKILL)
    if text.startswith("slow again") and len(calls.read_text().splitlines()) > 1:
        time.sleep(1.0)
    if text.startswith("too large"):
        raise MemoryError
    if text.startswith("bad"):
        raise pneuservo.InputError(f"{path}: found no column t_s, expected the times of the rows")
    if text.startswith("wait for"):
        while not pathlib.Path(text.split(maxsplit=2)[2]).exists():
            time.sleep(0.02)
    return {"sentence": "fine", "friction_N": float(len(text))}


def recordings(folder, texts):
    paths = []
    for number, text in enumerate(texts):
        path = folder / f"axis-{number % 2}" / f"run-2026-01-{number + 1:02d}.csv"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text + f"\n{number}")
        paths.append(path)
    return paths


def calls_of(path):
    return len(pathlib.Path(f"{path}.calls").read_text().splitlines())


def test_killed_workers_lose_nothing_and_bad_recordings_are_rows(tmp_path):
    texts = ["slow again"] * 6 + ["kill the worker once", "bad", "too large"]
    paths = recordings(tmp_path, texts)
    told = []

    def until_a_worker_died(*numbers):  # with results that nobody has fetched
        told.append(numbers)
        while not pathlib.Path(f"{paths[6]}.calls").exists():
            time.sleep(0.02)
        if len(told) == 1:
            time.sleep(0.3)

    table = fleet.run_fleet([*paths, tmp_path / "absent.csv"], None, tmp_path / "out", workers=2, work=counted,
                            progress=until_a_worker_died)
    frame = pandas.read_parquet(table).set_index("recording")
    assert frame.loc[str(paths[7]), "status"] == "failed" and "found no column t_s" in frame.loc[str(paths[7]), "sentence"]
    assert frame.loc[str(paths[8]), "status"] == "lost" and "memory" in frame.loc[str(paths[8]), "sentence"]
    assert "No such file" in frame.loc[str(tmp_path / "absent.csv"), "sentence"]
    assert (frame["status"] == "done").sum() == 7 and told[-1] == (9, 9, 2)
    assert frame.loc[str(paths[0]), "axis"] == "axis-0" and frame.loc[str(paths[0]), "date"] == "2026-01-01"
    assert calls_of(paths[6]) == 2

    before = [calls_of(path) for path in paths]
    fleet.run_fleet(paths, None, tmp_path / "out", workers=1, work=counted)
    assert [calls_of(path) for path in paths] == [*before[:8], before[8] + 1]  # what a worker was lost with is tried again


@LONG
def test_a_recording_that_kills_every_worker_is_a_row_and_the_others_are_done(tmp_path):
    # As the system does where memory ends: no Python says anything any more.
    paths = recordings(tmp_path, ["fine", "kill the worker always", "fine"])
    frame = pandas.read_parquet(fleet.run_fleet(paths, None, tmp_path / "out", workers=2, work=counted)).set_index("recording")
    lost = frame.loc[str(paths[1])]
    assert lost["status"] == "lost" and "its worker died each time it was tried, expected enough memory" in lost["sentence"]
    assert [frame.loc[str(path), "status"] for path in (paths[0], paths[2])] == ["done", "done"]


@LONG
def test_a_cluster_that_goes_away_is_told_and_what_is_done_is_kept(tmp_path):
    from dask.distributed import LocalCluster

    go_on = tmp_path / "never"
    paths = recordings(tmp_path, ["fine", f"wait for {go_on}"])
    cluster = LocalCluster(n_workers=1, threads_per_worker=2, dashboard_address=":0")
    ended = threading.Event()

    def progress(done, of, failed):
        if not ended.is_set():
            ended.set()
            threading.Thread(target=cluster.close).start()

    with pytest.raises(FleetStopped, match="cluster went away with 1 of 2 recordings done; they are kept in"):
        fleet.run_fleet(paths, None, tmp_path / "out", scheduler=cluster.scheduler_address, work=counted, progress=progress)
    frame = pandas.read_parquet(tmp_path / "out/results.parquet")
    assert list(frame["recording"]) == [str(paths[0])]
    with pytest.raises(FleetStopped, match="found no Dask scheduler"):
        fleet.run_fleet(paths, None, tmp_path / "out", scheduler="nonsense", work=counted)


@LONG
def test_ctrl_c_keeps_what_is_done(tmp_path):
    paths = recordings(tmp_path, ["fine", f"wait for {tmp_path / 'never'}"])
    code = ("import sys, os, signal; sys.path.insert(0, sys.argv[1]); import fleet_test; from pneuservo import fleet\n"
            "def told(*numbers): os.kill(os.getpid(), signal.SIGINT)\n"
            "if __name__ == '__main__':\n"
            "    try: fleet.run_fleet(sys.argv[3:], None, sys.argv[2], workers=2, work=fleet_test.counted, progress=told)\n"
            "    except KeyboardInterrupt: print('stopped')\n")
    script = tmp_path / "script.py"
    script.write_text(code)
    tests = str(pathlib.Path(__file__).parent)
    done = subprocess.run([sys.executable, script, tests, tmp_path / "out", *paths], capture_output=True, text=True)
    assert done.stdout == "stopped\n", done.stderr
    rows = [json.loads(path.read_text()) for path in (tmp_path / "out/rows").iterdir()]
    assert [row["recording"] for row in rows] == [str(paths[0])]
    assert len(pandas.read_parquet(tmp_path / "out/results.parquet")) == 1


def test_the_command_says_what_is_wrong_with_a_recording_and_goes_on(tmp_path):
    path, = recordings(tmp_path, ["no recording at all"])
    command = [sys.executable, "-m", "pneuservo.fleet", path, "--config", CYLINDER, "--workers", "1", "--out", tmp_path / "out"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0 and "written: " in done.stdout and "1 of 1 done, 1 failed" in done.stderr
    row, = fleet.Results(tmp_path / "out").rows()
    assert row["status"] == "failed" and path.name in row["sentence"] and "\n" not in row["sentence"]


def test_sizes_are_those_of_the_improved_config_and_leaks_are_normal_litres(config):
    from pneuservo import sizes

    # 1e-8 m2 from 7 bar at 293 K: 0.6847 * 1e-8 * 7e5 / sqrt(287 * 293) kg/s over 1.2926 kg/m3.
    assert sizes.leak_nlpm_of(1e-8, config) == pytest.approx(0.7672, rel=1e-3)
    answer = {"answers": [{"effect": "coulomb_friction", "parameters": {"force_N": {"value": 5.0, "standard_error": 0.2}}}],
              "detectable": [{"effect": "valve_lag", "parameter": "time_constant_s", "value": 1e-3}]}
    improved = config.with_effects({"coulomb_friction": {"force_N": 5.0}})
    named = sizes._size(answer, improved, sizes.FRICTION)
    assert named["value"] == 5.0 and named["standard_error"] == pytest.approx(0.2) and named["named"]
    hidden = sizes._size(answer, improved, sizes.VALVE)
    assert hidden["value"] == 0.0 and not hidden["named"] and hidden["smallest_visible"] == 1e-3


def test_one_row_a_recording_is_current_the_newest(tmp_path, config):
    path, = recordings(tmp_path, ["fine"])
    out = tmp_path / "out"
    fleet.run_fleet([path], None, out, workers=1, work=counted)
    fleet.run_fleet([path], config, out, workers=1, work=counted)
    path.write_text("fine, and longer")
    table = fleet.run_fleet([path], config, out, workers=1, work=counted)
    assert calls_of(path) == 3 and list(pandas.read_parquet(table)["friction_N"]) == [len("fine, and longer")]
    (out / "rows/of-an-older-version.json").write_text(json.dumps({"recording": str(path), "axis": "a", "date": "", "status": "done"}))
    os.utime(out / "rows/of-an-older-version.json", (1, 1))
    assert [row["status"] for row in fleet.Results(out).rows()] == ["done"] and "made_of" in fleet.Results(out).rows()[0]


def test_equal_files_of_two_axes_are_two_rows_and_what_was_lost_is_replaced(tmp_path):
    paths = [tmp_path / axis / "run-2026-02-30.csv" for axis in ("a", "b")]
    table = fleet.run_fleet(paths, None, tmp_path / "out", workers=1, work=counted)
    assert list(pandas.read_parquet(table)["status"]) == ["lost", "lost"]
    for path in paths:
        path.parent.mkdir()
        path.write_text("fine")
    frame = pandas.read_parquet(fleet.run_fleet(paths, None, tmp_path / "out", workers=1, work=counted))
    assert list(frame["axis"]) == ["a", "b"] and set(frame["status"]) == {"done"}
    assert "2026-02-30" not in set(frame["date"])  # no such day: the file's own date
    paths[0].unlink()
    frame = pandas.read_parquet(fleet.run_fleet(paths, None, tmp_path / "out", workers=1, work=counted))
    assert set(frame["status"]) == {"done"}


@pytest.mark.parametrize("workers", ["-2", "0"])
def test_a_number_of_workers_that_cannot_be_is_refused(tmp_path, capsys, workers):
    path, = recordings(tmp_path, ["fine"])
    assert fleet.main([str(path), "--workers", workers, "--out", str(tmp_path / "out")]) == 2
    assert f"workers: found {workers}, expected at least 1" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_fleet_without_any_recording_that_is_there_fails(tmp_path, capsys):
    assert fleet.main([str(tmp_path / "absent.csv"), "--workers", "1", "--out", str(tmp_path / "out")]) == 1
    assert "found no recording that was done of 1, expected at least one; the first: " in capsys.readouterr().err
