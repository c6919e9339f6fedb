# What the tests of the Python package share: configs of the tree, short recordings made by the simulation.
import pathlib

import numpy
import pytest

import pneuservo

SOURCE = pathlib.Path(__file__).resolve().parents[2]
CYLINDER = SOURCE / "config/cylinder-10m-7.65mm.yaml"
TABLE = SOURCE / "config/servo-table-1m-8mm.yaml"


@pytest.fixture(scope="session")
def config():
    return pneuservo.Config(CYLINDER)


@pytest.fixture(scope="session")
def swept(config):
    """Two seconds of an axis under a swept command, as a recording without noise."""
    t_s = numpy.arange(2000) * config.period_s
    u_V = 1.5 * numpy.sin(2 * numpy.pi * (0.5 + t_s) * t_s)
    columns = pneuservo.Plant(config).run(u_V)
    return pneuservo.Recording({"t_s": t_s, "u_V": u_V, **columns}, period_s=config.period_s, rig=config.name)
