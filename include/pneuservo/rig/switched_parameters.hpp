// Parameters of rigs that an on/off valve switches: a vessel, and a cylinder that goes from end stop to end stop.
#pragma once
#include <vector>

#include <pneuservo/core/field.hpp>

namespace pneuservo {

/// A rigid volume with what its wall does.
struct VesselParameters {
  double volume_m3 = 0.0;
  double wall_heat_W_per_K = 0.0;
  double gas_temperature_K = 293.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"volume_m3", "m3", 1e-9, 1e3, "of the gas, fittings and sensors included"}, p.volume_m3...);
    v(Field{"wall_heat_W_per_K", "W/K", 0, 1e6, "heat flow over gas temperature less air.temperature_K",
            Presence::optional},
      p.wall_heat_W_per_K...);
    v(Field{"gas_temperature_K", "K", 150, 600, "of the gas at the start of a recording", Presence::optional},
      p.gas_temperature_K...);
  }
};

/// On/off valve of a vessel: command 1 opens it to the supply, -1 to exhaust, 0 closes it.
struct OnOffValveParameters {
  double supply_area_m2 = 0.0;
  double exhaust_area_m2 = 0.0;
  double critical_pressure_ratio = 0.528;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"supply_area_m2", "m2", 0, 1e-2, "effective area from the supply", Presence::optional},
      p.supply_area_m2...);
    v(Field{"exhaust_area_m2", "m2", 0, 1e-2, "effective area to atmosphere", Presence::optional},
      p.exhaust_area_m2...);
    v(Field{"critical_pressure_ratio", "-", 0.05, 0.9, "b of ISO 6358; 0.528 is an ideal nozzle", Presence::optional},
      p.critical_pressure_ratio...);
  }
};

/// Flow control valve of one chamber in series with the directional valve, as one effective area each way.
struct ThrottleParameters {
  double inflow_area_m2 = 0.0;
  double outflow_area_m2 = 0.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"inflow_area_m2", "m2", 1e-12, 1e-2, "effective area from supply to chamber"}, p.inflow_area_m2...);
    v(Field{"outflow_area_m2", "m2", 1e-12, 1e-2, "effective area from chamber to exhaust"}, p.outflow_area_m2...);
  }
};

/// What even a healthy machine's model misses by, root mean square: strokes are not repeated exactly.
struct ModelErrorParameters {
  double position_m = 1e-4;
  double pressure_Pa = 100.0;
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"position_m", "m", 0, 1, "of positions", Presence::optional}, p.position_m...);
    v(Field{"pressure_Pa", "Pa", 0, 1e6, "of pressures", Presence::optional}, p.pressure_Pa...);
  }
};

/// Command of an on/off valve where a recording has no column u_V: each value from its time on.
struct ProgramParameters {
  std::vector<double> times_s{0.0};
  std::vector<double> commands{0.0};
  template <class V, class... P> static void visit(V&& v, P&... p) {
    v(Field{"times_s", "s", 0, 1e6, "after the recording's first row, increasing"}, p.times_s...);
    v(Field{"commands", "-", -1, 1, "1, 0 or -1; as many as times"}, p.commands...);
  }
};

}  // namespace pneuservo
