# The unit of a column, which ends its name.
"""Units of columns: x_m is in m, p1_port_Pa in Pa, mass_flow_1_kgps in kg/s."""
_UNITS = {"s": "s", "m": "m", "mps": "m/s", "mps2": "m/s2", "V": "V", "Pa": "Pa", "N": "N", "kg": "kg", "kgps": "kg/s",
          "us": "us", "K": "K", "m2": "m2", "m3": "m3", "Nm": "N m"}


def unit_of(column: str) -> str:
    """Unit of a column by its name; empty: a number without one."""
    return _UNITS.get(column.rsplit("_", 1)[-1], "") if "_" in column else ""
