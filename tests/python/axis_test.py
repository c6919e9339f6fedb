# Estimator, plant, machine and law, step by step and by arrays.
import concurrent.futures
import math
import multiprocessing

import numpy
import pytest

import pneuservo
from conftest import TABLE


def test_the_estimator_gives_the_same_step_by_step_and_by_arrays(config, swept):
    ports = [swept[name] for name in ("p1_port_Pa", "p2_port_Pa", "x_m", "v_mps", "u_V")]
    by_arrays = pneuservo.Estimator(config).run(*ports)
    estimator = pneuservo.Estimator(config)
    for row in range(0, 500):
        one = estimator.step(*(column[row] for column in ports))
        assert one.p1_estimated_Pa == by_arrays["p1_estimated_Pa"][row]
        assert one.p2_bound_Pa == by_arrays["p2_bound_Pa"][row]
    assert by_arrays["health"].dtype == numpy.uint32 and not by_arrays["health"].any()


def test_the_estimate_lies_on_the_chamber_and_not_on_the_port(config, swept):
    estimate = pneuservo.Estimator(config).run(swept["p1_port_Pa"], swept["p2_port_Pa"], swept["x_m"], swept["v_mps"])
    late = slice(1000, None)
    error = estimate["p1_estimated_Pa"][late] - swept["p1_chamber_Pa"][late]
    port = swept["p1_port_Pa"][late] - swept["p1_chamber_Pa"][late]
    assert numpy.sqrt(numpy.mean(error**2)) < 0.1 * numpy.sqrt(numpy.mean(port**2))


def test_an_estimate_goes_on_where_it_ended(config, swept):
    names = ("p1_port_Pa", "p2_port_Pa", "x_m", "v_mps")
    whole = pneuservo.Estimator(config).run(*(swept[name] for name in names))
    estimator = pneuservo.Estimator(config)
    parts = [estimator.run(*(swept[name][span] for name in names)) for span in (slice(0, 700), slice(700, None))]
    assert numpy.array_equal(numpy.concatenate([p["p1_estimated_Pa"] for p in parts]), whole["p1_estimated_Pa"])


def test_the_estimator_of_a_servo_table_takes_both_commands():
    config = pneuservo.Config(TABLE).replace({"estimator.flow_correction": 0.2, "valve.natural_frequency_Hz": 0.0})
    start = config["initial.pressure_1_Pa"]
    pressure = start + 1e3 * numpy.sin(0.1 * numpy.arange(400.0))
    ports = [pressure, pressure, 0.0, 0.0]
    estimate = {second: pneuservo.Estimator(config).run(*ports, 1.0, *second) for second in ((), (-1.0,), (1.0,))}
    stepped = pneuservo.Estimator(config)
    for row in range(400):
        one = stepped.step(pressure[row], pressure[row], 0.0, 0.0, 1.0, 1.0)
    assert one.p2_estimated_Pa == estimate[1.0,]["p2_estimated_Pa"][-1]
    assert numpy.array_equal(estimate[()]["p2_estimated_Pa"], estimate[-1.0,]["p2_estimated_Pa"])
    assert not numpy.array_equal(estimate[1.0,]["p2_estimated_Pa"], estimate[-1.0,]["p2_estimated_Pa"])
    assert numpy.array_equal(estimate[1.0,]["p1_estimated_Pa"], estimate[-1.0,]["p1_estimated_Pa"])


def test_arrays_are_read_where_they_lie(config, swept):
    names = ("p1_port_Pa", "p2_port_Pa", "x_m", "v_mps")
    apart = numpy.column_stack([swept[name] for name in names])  # a column is every fourth number
    estimate = pneuservo.Estimator(config).run(*apart.T)
    whole = pneuservo.Estimator(config).run(*(swept[name] for name in names))
    assert numpy.array_equal(estimate["p2_estimated_Pa"], whole["p2_estimated_Pa"])
    assert not swept["x_m"].flags.writeable and not swept["x_m"].flags.owndata


@pytest.mark.parametrize("wrong, kind, words", [
    (numpy.zeros(2000, numpy.float32), TypeError, "x_m: found float32, expected an array of float64"),
    (numpy.zeros((2000, 2)), ValueError, r"x_m: found the shape \(2000, 2\), expected one axis"),
    (numpy.zeros(1999), ValueError, "x_m: found 1999 rows, expected 2000 as p1_port_Pa has"),
    ([0.0] * 2000, TypeError, "x_m: found list, expected an array of float64"),
    ("0", TypeError, "x_m: found str"),
])
def test_a_wrong_array_is_named(config, swept, wrong, kind, words):
    with pytest.raises(kind, match=words):
        pneuservo.Estimator(config).run(swept["p1_port_Pa"], swept["p2_port_Pa"], wrong, 0.0)


def test_the_plant_gives_the_same_step_by_step_and_by_arrays(config):
    u_V = 2.0 * numpy.sin(0.01 * numpy.arange(300))
    columns = pneuservo.Plant(config).run(u_V)
    plant = pneuservo.Plant(config)
    for row, command in enumerate(u_V):
        assert plant.now.x_m == columns["x_m"][row] and plant.now.p1_chamber_Pa == columns["p1_chamber_Pa"][row]
        plant.step(command)


def test_a_leak_empties_a_chamber(config):
    still = numpy.zeros(1000)
    leaking = config.with_effects({"chamber_leak_1": {"area_m2": 1e-7}})
    tight, leaks = pneuservo.Plant(config).run(still), pneuservo.Plant(leaking).run(still)
    assert leaks["p1_chamber_Pa"][-1] < tight["p1_chamber_Pa"][-1] - 1e3


def test_simulate_is_the_plant_on_a_recorded_command(config, swept):
    again = pneuservo.simulate(config, swept)
    assert numpy.array_equal(again["x_m"], swept["x_m"])
    assert numpy.array_equal(again["p2_port_Pa"], swept["p2_port_Pa"])
    with pytest.raises(pneuservo.InputError, match="u_V"):
        pneuservo.simulate(config, {"t_s": swept["t_s"]})


def test_a_loop_of_parts_is_the_program_s_loop(config):
    """Machine, estimator and law by hand against run(), as long as the program's own supervision has not let go."""
    run = pneuservo.run(config)
    assert not run.faults
    columns = run.columns
    machine, estimator, law = pneuservo.Machine(config), pneuservo.Estimator(config), pneuservo.Law(config)
    u_V = 0.0
    for row in range(len(run)):
        seen = machine.read()
        assert seen.x_m == columns["x_m"][row], row
        chambers = estimator.step(seen.p1_port_Pa, seen.p2_port_Pa, seen.x_m, law.v_mps, u_V)
        u_V = law.step(seen.x_m, chambers.p1_estimated_Pa, chambers.p2_estimated_Pa, seen.p1_port_Pa, seen.p2_port_Pa,
                       seen.p_supply_Pa)
        machine.write(u_V)


def test_a_servo_table_has_two_commands():
    config = pneuservo.Config(TABLE)
    law = pneuservo.Law(config)
    u_V = law.step(0.0, 3e5, 3e5)
    assert len(u_V) == 2 and all(math.isfinite(u) for u in u_V)
    assert set(law.terms)
    columns = pneuservo.Plant(config).run(numpy.full(50, 0.5), numpy.full(50, 0.5))
    assert columns["p1_chamber_Pa"][-1] > columns["p1_chamber_Pa"][0]


def test_the_reference_and_its_derivatives(config):
    t_s = numpy.linspace(0.0, 2.0, 2001)
    wanted = pneuservo.Law(config).reference(t_s)
    assert wanted.shape == (2001, 8)
    slope = numpy.gradient(wanted[:, 0], t_s)
    assert numpy.abs(slope - wanted[:, 1])[1:-1].max() < 1e-3


def estimated(columns):
    config = pneuservo.Config(TABLE.parent / "cylinder-10m-7.65mm.yaml")
    return pneuservo.Estimator(config).run(*columns)["p1_estimated_Pa"]


def test_threads_and_forked_processes_give_the_same(config, swept):
    columns = tuple(numpy.array(swept[name]) for name in ("p1_port_Pa", "p2_port_Pa", "x_m", "v_mps"))
    alone = estimated(columns)
    with concurrent.futures.ThreadPoolExecutor(4) as threads:
        assert all(numpy.array_equal(one, alone) for one in threads.map(estimated, [columns] * 8))
    with multiprocessing.get_context("fork").Pool(2) as processes:
        assert all(numpy.array_equal(one, alone) for one in processes.map(estimated, [columns] * 2))


@pytest.mark.parametrize("wrong, words", [
    (numpy.zeros(2000, ">f8"), "x_m: found >f8, expected an array of float64"),
    (numpy.zeros(2000, object), "x_m: found object, expected an array of float64"),
])
def test_the_elements_of_a_wrong_array_are_named(config, swept, wrong, words):
    with pytest.raises(TypeError, match=words):
        pneuservo.Estimator(config).run(swept["p1_port_Pa"], swept["p2_port_Pa"], wrong, 0.0)


def test_a_mask_is_refused_where_it_hides_values(config):
    command = numpy.ma.masked_array(numpy.zeros(5), mask=[0, 0, 1, 0, 0])
    with pytest.raises(ValueError, match="u_V: found masked values, expected an array without a mask"):
        pneuservo.Plant(config).run(command)
    assert len(pneuservo.Plant(config).run(numpy.ma.masked_array(numpy.zeros(5)))["x_m"]) == 5


@pytest.mark.parametrize("start, words", [
    ({"x_m": math.nan}, "x_m: found nan, expected a place within the stroke"),
    ({"x_m": 5.0}, "x_m: found 5, expected a place within the stroke"),
    ({"p1_Pa": -1.0}, "p1_Pa: found -1, expected an absolute pressure above 0 Pa"),
    ({"p2_Pa": math.inf}, "p2_Pa: found inf, expected an absolute pressure"),
])
def test_a_start_that_cannot_be_is_refused(config, start, words):
    with pytest.raises(ValueError, match=words):
        pneuservo.Plant(config).reset(**start)


def test_commands_that_are_none_are_refused(config, swept):
    plant, machine = pneuservo.Plant(config), pneuservo.Machine(config)
    command = numpy.zeros(10)
    command[3] = math.nan
    for call, words in ((lambda: plant.step(math.nan), "Plant.step: u_V: found nan"),
                        (lambda: plant.run(command), "Plant.run: u_V: found nan in row 3"),
                        (lambda: machine.write(math.inf), "Machine.write: u_V: found inf"),
                        (lambda: plant.step(0.0, 0.0), "u2_V: found a second command, expected none: the rig has one valve"),
                        (lambda: plant.run(numpy.zeros(10), numpy.zeros(10)), "u2_V: found a second command"),
                        (lambda: pneuservo.Estimator(config).step(5e5, 5e5, 0.0, 0.0, 0.0, 0.0), "u2_V: found a second command")):
        with pytest.raises(ValueError, match=words):
            call()
    with pytest.raises(pneuservo.InputError, match="u_V: found no value in any row"):
        pneuservo.simulate(config, {"t_s": swept["t_s"], "u_V": numpy.full(len(swept), math.nan)})


def test_a_law_in_use_by_another_thread_is_not_read(config):
    law = pneuservo.Law(config)
    still = numpy.zeros(400_000)
    refused = set()
    with concurrent.futures.ThreadPoolExecutor(1) as threads:
        running = threads.submit(law.run, still, 5e5, 5e5)
        while not running.done():
            for name in ("tick", "v_mps", "limited", "terms"):
                try:
                    getattr(law, name)
                except RuntimeError as error:
                    assert "found in use by another thread" in str(error)
                    refused.add(name)
        try:
            running.result()
        except RuntimeError:
            pass  # it came while a value was read
    assert refused == {"tick", "v_mps", "limited", "terms"} or law.tick == 0
    assert law.tick in (0, len(still))


def test_a_law_for_another_rig_names_the_rig():
    config = pneuservo.Config(TABLE.parent / "machines/tank-discharge.yaml")
    for kind in (pneuservo.Law, pneuservo.Plant, pneuservo.Estimator, pneuservo.Machine):
        with pytest.raises(pneuservo.InputError, match=f"rig: found vessel, expected a rig with proportional valves: {kind.__name__}"):
            kind(config)
