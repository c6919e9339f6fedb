# Diagnosis and design from Python: results, progress, cancelling, Ctrl-C.
import os
import signal
import subprocess
import sys
import threading

import numpy
import pytest

import pneuservo
from conftest import CYLINDER


@pytest.fixture(scope="module")
def leaking(config):
    """What a machine with a leak does, with the noise of its sensors."""
    machine = pneuservo.Machine(config.with_effects({"chamber_leak_1": {"area_m2": 1e-7}}))
    names = ("x_m", "p1_port_Pa", "p2_port_Pa", "p_supply_Pa")
    t_s = numpy.arange(4000) * config.period_s
    u_V = 1.5 * numpy.sin(2 * numpy.pi * (0.4 + 0.2 * t_s) * t_s)
    columns = {name: numpy.empty(len(t_s)) for name in names}
    for row, command in enumerate(u_V):
        seen = machine.read()
        for name in names:
            columns[name][row] = getattr(seen, name)
        machine.write(command)
    return pneuservo.Recording({"t_s": t_s, "u_V": u_V, **columns}, period_s=config.period_s, rig=config.name)


def test_what_is_there_is_told_and_the_rest_is_cancelled(config, leaking):
    told = []
    result = None
    cancel = threading.Event()

    def progress(share, what):
        told.append((share, what))
        if share > 0.1:
            cancel.set()

    try:
        result = pneuservo.diagnose(config, [leaking], jobs=2, progress=progress, cancel=cancel)
    except pneuservo.DiagnosisStopped as stopped:
        assert "before anything was known" in str(stopped)
    assert told and all(0.0 <= share <= 1.0 and share == round(share, 3) and what for share, what in told)
    if result is not None:
        assert result.stopped
        assert pneuservo.to_dict(result)["verdict"] == result.verdict
        assert isinstance(result.improved, pneuservo.Config)


def test_an_error_of_the_callback_ends_the_diagnosis(config, leaking):
    def progress(share, what):
        raise ZeroDivisionError("mine")

    with pytest.raises(ZeroDivisionError, match="mine"):
        pneuservo.diagnose(config, [leaking], jobs=2, progress=progress)


def test_ctrl_c_ends_a_diagnosis_with_what_there_is(config, leaking):
    def progress(share, what):
        os.kill(os.getpid(), signal.SIGINT)

    try:
        result = pneuservo.diagnose(config, [leaking], jobs=2, progress=progress)
    except KeyboardInterrupt as interrupt:
        assert "before anything was known" in str(interrupt)
    else:
        assert result.stopped


def test_a_recording_that_cannot_be_compared_is_named(config):
    with pytest.raises(pneuservo.InputError, match="x_m"):
        pneuservo.diagnose(config, [{"t_s": numpy.arange(100) * 1e-3, "u_V": numpy.zeros(100)}])


def test_a_design_is_the_verb_s_and_gives_a_state_space(config):
    design = pneuservo.design(config)
    figures = pneuservo.to_dict(design)
    assert design.is_stable and figures
    A, B, C, D = design.matrices(3)
    assert A.shape == (3, 3) and B.shape == (3, 1) and C.shape == (3, 3) and not D.any()
    # The third order model is an integrator behind the air spring: one pole at 0 and a pair at its frequency.
    poles = numpy.sort_complex(numpy.linalg.eigvals(A))
    assert numpy.abs(poles).min() < 1e-6 * numpy.abs(poles).max()
    with pytest.raises(ValueError, match="order: found 4, expected one of 3"):
        design.matrices(4)
    with pytest.raises(ValueError, match="method: found 'best', expected one of config"):
        pneuservo.design(config, "best")


def test_python_control_takes_the_design(config):
    control = pytest.importorskip("control")
    system = pneuservo.state_space(pneuservo.design(config), 3)
    assert isinstance(system, control.StateSpace) and system.output_labels == ["x_m", "v_mps", "a_mps2"]


def test_the_end_of_python_waits_for_a_diagnosis_in_a_thread(config, swept, tmp_path):
    """A daemon thread at work ends with the interpreter, not with an abort."""
    path = tmp_path / "swept.csv.gz"
    swept.write(path, config)
    code = (f"import pneuservo, threading, time\nc = pneuservo.Config({str(CYLINDER)!r})\n"
            f"threading.Thread(target=pneuservo.diagnose, args=(c, [{str(path)!r}]), daemon=True).start()\ntime.sleep(0.3)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and "terminate" not in done.stderr, done.stderr


def test_one_mapping_is_one_recording(config, swept):
    columns = {name: swept[name] for name in swept.keys()}
    assert pneuservo.diagnose(config, columns).verdict == pneuservo.diagnose(config, [swept]).verdict


@pytest.mark.parametrize("name", ["position_gain_V_per_m", "alpha", "beta", "c6", "c5"])
@pytest.mark.parametrize("value", [float("nan"), float("inf"), 0.0, -1.0, 1e300])
def test_a_design_from_a_number_that_cannot_be_is_refused(config, name, value):
    with pytest.raises(pneuservo.InputError, match="found .*, expected a number above 0"):
        pneuservo.design(config, "alpha_beta", **{name: value})


def test_what_is_no_recording_is_named(config):
    with pytest.raises(TypeError, match="Recording: found int, expected a file"):
        pneuservo.diagnose(config, [5])
    with pytest.raises(TypeError, match="recordings: found int, expected a list"):
        pneuservo.diagnose(config, 5)
