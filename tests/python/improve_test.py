# The improved config from Python: found, predicted, cancelled, refused.
import json
import math
import os
import signal
import subprocess
import threading
import time

import numpy
import pytest

import pneuservo
from conftest import SOURCE, TABLE

FRICTION = "effects.coulomb_friction.force_N"
FREE = {"limits.deviation_m": 0, "limits.speed_deviation_mps": 0}


@pytest.fixture(scope="module")
def owner():
    return pneuservo.Config(SOURCE / "config/cylinder-2m-6.10mm.yaml")


@pytest.fixture(scope="module")
def rubbing(owner):
    """Three seconds of the axis on a machine with 20 N of friction that its config does not know."""
    ran = pneuservo.run(owner.replace({"concealed.coulomb_friction.force_N": 20, "duration_s": 3, **FREE}))
    names = ("t_s", "u_V", "x_m", "p1_port_Pa", "p2_port_Pa", "p_supply_Pa")
    columns = {name: numpy.array(ran.columns[name]) for name in names}
    return pneuservo.Recording(columns, period_s=owner.period_s, rig=owner.name)


def test_the_friction_is_found_and_the_axis_errs_less(owner, rubbing, tmp_path):
    told = []
    result = pneuservo.improve(owner, [rubbing], progress=lambda share, what: told.append((share, what)))
    assert told[0][1].startswith("call 1: ") and all(0.0 <= share <= 1.0 for share, _ in told)
    assert not result.stopped and not result.is_refused and result.without_pass == ""
    assert result.improved[FRICTION] == pytest.approx(20, abs=1)
    assert result.error_after_m < 0.4 * result.error_before_m
    found = pneuservo.to_dict(result)
    assert found["changes"][FRICTION]["after"] == result.improved[FRICTION]
    assert found["predicted"]["after"]["max_position_error_m"] == result.error_after_m
    assert pneuservo.Config.from_text(result.to_yaml()).to_dict() == result.improved.to_dict()
    result.write_report(tmp_path / "page.html")
    assert "Before and after" in (tmp_path / "page.html").read_text()
    # The prediction is a run of the improved config on the model that it is; what is predicted is not supervised.
    (tmp_path / "improved.yaml").write_text(result.to_yaml())
    unsupervised = [word for path, value in FREE.items() for word in ("--set", f"{path}={value}")]
    done = subprocess.run([os.environ["PNEUSERVO_PROGRAM"], "run", tmp_path / "improved.yaml", *unsupervised, "--json", "-"],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["runs"][0]["max_position_error_m"] == pytest.approx(result.error_after_m, rel=1e-6)
    pandas = pytest.importorskip("pandas")
    frame = pneuservo.to_pandas(result)
    assert isinstance(frame, pandas.DataFrame) and frame.loc[FRICTION, "before"] < 1 < frame.loc[FRICTION, "after"]


def test_what_was_found_before_a_stop_is_kept(owner, rubbing):
    result = pneuservo.improve(owner, [rubbing], progress=lambda share, what: what.startswith("call 1: "))
    assert result.stopped and math.isnan(result.error_after_m)
    assert len(pneuservo.to_dict(result)["calls"]) == 1 and result.improved[FRICTION] == pytest.approx(20, abs=1)
    assert result.sentence.startswith("Stopped")


def test_ctrl_c_is_not_lost_after_the_last_look_for_a_stop(owner, rubbing):
    """While the callback waits the prediction goes on to its end, and with it the work."""
    def progress(share, what):
        if share >= 1.0:
            time.sleep(3)
            signal.raise_signal(signal.SIGINT)

    try:
        result = pneuservo.improve(owner, [rubbing], progress=progress)
    except KeyboardInterrupt as interrupt:
        assert "improve: interrupted when all was done" in str(interrupt)
    else:
        assert result.stopped  # on a machine so slow that the last look came later


def test_a_stop_before_anything_is_known(owner, rubbing):
    cancel = threading.Event()
    cancel.set()
    with pytest.raises(pneuservo.DiagnosisStopped, match="improve: stopped before anything was known"):
        pneuservo.improve(owner, [rubbing], cancel=cancel)


def test_what_cannot_be_improved_is_named(owner, rubbing):
    with pytest.raises(pneuservo.InputError, match="improve works on no other rig"):
        pneuservo.improve(pneuservo.Config(TABLE), [rubbing])
    with pytest.raises(pneuservo.InputError, match="found a recording of the rig 'cylinder-2m-6.10mm'"):
        pneuservo.improve(pneuservo.Config(SOURCE / "config/cylinder-5m-6.10mm.yaml"), [rubbing])
