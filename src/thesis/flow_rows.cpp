// Rows of 3.3.1: the effective area over the voltage, measured as in Fig 3.6 on a simulated valve.
#include <cmath>

#include <fmt/format.h>

#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/valve.hpp>

#include "config/valve_table.hpp"
#include "thesis/groups.hpp"
#include "thesis/pictures.hpp"

namespace pneuservo {

MeasuredValve thesis_measured_valve(ThesisBench& bench) {
  const Rig rig = bench.rig({"cylinder-10m-7.65mm"});
  const ValveParameters<double>& believed = rig.axis.valve;
  // A spool as they are: overlapped by 0.1 V, a fifth less slope wide open. The config's is straight.
  ValveEffects<double> effects;
  effects.valve_dead_band.width_V = 0.1;
  effects.valve_curve.wide_open = -0.2;
  Valve<double> valve;
  valve.configure(believed, effects, rig.period_s);
  const Air<double> air(rig.axis.air);
  const double from_Pa = 600e3, to_Pa = air.atmosphere_Pa, b = believed.critical_pressure_ratio;
  const double flux = orifice_flux(air, from_Pa, air.temperature_K, to_Pa, b);
  Random random(1);
  MeasuredValve out;
  std::vector<ValvePoint> points;
  for (int i = -20; i <= 20; ++i) {
    const double command_V = 0.25 * i, area_m2 = valve.areas(command_V).supply + valve.areas(command_V).exhaust;
    // A flow meter's 1 % of its reading and 0.1 % of its range.
    const double flow =
        flux * (area_m2 * (1.0 + 0.01 * random.normal()) + 1e-3 * believed.area_max_m2 * random.normal());
    out.command_V.push_back(command_V);
    out.true_m2.push_back(area_m2);
    out.measured_m2.push_back(flow / flux);
    out.straight_m2.push_back(std::fmin(believed.area_per_volt_m2_per_V * std::fabs(command_V), believed.area_max_m2));
    points.push_back({command_V, std::fmax(flow / flux, 0.0)});
  }
  out.fit = fit_valve_table(points, believed.command_max_V);
  out.area_per_volt_m2_per_V = believed.area_per_volt_m2_per_V;
  return out;
}

ThesisGroup thesis_flow_group() {
  const auto row = [](const char* what, const char* unit, const char* held, double (*value)(const MeasuredValve&)) {
    return ThesisRow{.place = "Fig 3.7",
                     .what = what,
                     .unit = unit,
                     .printed = "curve without figures",
                     .plant = ThesisPlant::nonlinear,
                     .ours = [value](ThesisBench& bench) { return value(thesis_measured_valve(bench)); },
                     .held = held,
                     .held_within = searched_within,
                     .why = "41 flows from 600 kPa into the room through a simulated valve, with 1 % of noise, as "
                            "valve.table reads them",
                     .command = "pneuservo thesis --only 'Fig 3.7'"};
  };
  return {"3.3.1 The valve's area",
          {row("overlap found over the true 0.1 V", "", "1.16",
               [](const MeasuredValve& m) { return m.fit.dead_band_V / 0.1; }),
           row("slope found over the true one", "", "0.9974",
               [](const MeasuredValve& m) { return m.fit.area_per_volt_m2_per_V / m.area_per_volt_m2_per_V; }),
           row("area at 5 V found over the true one", "", "1.019",
               [](const MeasuredValve& m) { return m.fit.area_max_m2 / m.true_m2.back(); }),
           row("misfit of the curve over the area at 5 V", "%", "0.5144",
               [](const MeasuredValve& m) { return 100.0 * m.fit.misfit_m2 / m.true_m2.back(); })}};
}

}  // namespace pneuservo
