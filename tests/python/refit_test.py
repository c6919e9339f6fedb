# Sizes of a machine that is known: a refit finds them with their errors, with a flow meter and without, fleets use it.
import math

import numpy
import pytest

import pneuservo
from conftest import SOURCE
from pneuservo import fleet, sizes

CONFIG = SOURCE / "config/cylinder-2m-6.10mm.yaml"
METER = {"range": "0 to 200 Nl/min", "bits": 12, "noise": "0.2 Nl/min"}
LEAK_M2 = 6.5e-9  # half a normal litre a minute from 7 bar
WEAR = {"coulomb_friction": {"force_N": 6.0}, "chamber_leak_1": {"area_m2": LEAK_M2}}


@pytest.fixture(scope="module")
def owner():
    return pneuservo.Config(CONFIG, {"sensors.supply_flow": METER, "duration_s": 6.0})


@pytest.fixture(scope="module")
def worn(owner):
    """The config's own motion on a machine with friction and a leak."""
    run = pneuservo.run(owner.replace({"concealed": WEAR}))
    names = ("t_s", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa", "p_supply_Pa", "supply_flow_kgps")
    return pneuservo.Recording({name: numpy.array(run.columns[name]) for name in names}, period_s=owner.period_s, rig=owner.name)


def without_meter(recording):
    return {name: recording[name] for name in recording.keys() if name != "supply_flow_kgps"}


def test_the_flow_of_the_meter_is_what_the_plant_takes(owner, worn):
    flow = worn["supply_flow_kgps"]
    assert numpy.isfinite(flow).all() and flow.max() > 1e-4
    # A period of the sine fills both chambers' stroke once: 0.16 m of (1.257 + 1.056)e-3 m2 at some 5 bar, and the lines.
    assert 1e-3 < flow.mean() < 1e-2
    assert owner["sensors.supply_flow.quantum_kgps"] == pytest.approx(200 / 60e3 * 1.2926 / 4096, rel=2e-3)


def test_misfit_warns_of_what_a_refit_was_not_asked_for(owner, worn):
    """docs/fleet.md: below 0.5 where nothing is missing; above it beside a dead band, which moves the leak off."""
    effects = ["coulomb_friction", "chamber_leak_1"]
    assert pneuservo.refit(owner, [without_meter(worn)], effects, jobs=2).misfit < 0.5
    banded = pneuservo.run(owner.replace({"concealed": {**WEAR, "valve_dead_band": {"width_V": 0.03}}})).columns
    names = ("t_s", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa", "p_supply_Pa")
    recording = pneuservo.Recording({name: numpy.array(banded[name]) for name in names}, period_s=owner.period_s, rig=owner.name)
    found = pneuservo.refit(owner, [recording], effects, jobs=2)
    assert found.misfit > 0.5 and abs(found.values[1] - LEAK_M2) > 4.0 * math.sqrt(found.covariance[1, 1])


def test_sizes_are_found_within_their_errors(owner, worn):
    found = pneuservo.refit(owner, [worn], ["coulomb_friction", "chamber_leak_1"], jobs=2)
    assert found.paths == ["effects.coulomb_friction.force_N", "effects.chamber_leak_1.area_m2"]
    assert found.covariance.shape == (2, 2) and found.misfit < 2.0
    # What of friction the model makes itself is beyond the noise's error: 2 % were measured.
    assert found.values[0] == pytest.approx(6.0, rel=0.04)
    assert abs(found.values[1] - LEAK_M2) < 5.0 * math.sqrt(found.covariance[1, 1])
    assert found.refitted["effects.coulomb_friction.force_N"] == pytest.approx(found.values[0])


def test_a_flow_meter_takes_nothing_away_from_a_leak(owner, worn):
    effects = ["coulomb_friction", "chamber_leak_1", "chamber_leak_2"]
    leak_error = [math.sqrt(pneuservo.refit(owner, [recording], effects, jobs=2).covariance[1:, 1:].sum())
                  for recording in (worn, without_meter(worn))]
    assert leak_error[0] < 1.02 * leak_error[1]


def test_what_has_no_size_is_refused(owner, worn):
    with pytest.raises(pneuservo.InputError, match="found the effect nothing, expected effects whose sizes"):
        pneuservo.refit(owner, [worn], ["nothing"])


def test_a_row_of_a_fleet_by_a_refit(owner, worn, tmp_path):
    worn.write(tmp_path / "2026-03-30.csv.gz", owner)
    row = fleet.refitted(str(tmp_path / "2026-03-30.csv.gz"), None)
    assert row["friction_N"] == pytest.approx(6.0, rel=0.04) and row["friction_N_standard_error"] > 0.0
    assert row["leak_nlpm"] == pytest.approx(sizes.leak_nlpm_of(LEAK_M2, owner), abs=6.0 * row["leak_nlpm_standard_error"])
    assert row["leak_nlpm_named"] and row["supply_Pa"] == pytest.approx(7e5, abs=500.0)
