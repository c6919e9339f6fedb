// Rows of what is printed wrong or left open where no figure hangs on it: what to read, and what the print would do.
#include <cmath>

#include <pneuservo/elements/orifice.hpp>

#include "thesis/groups.hpp"

namespace pneuservo {
namespace {

struct Misprint {
  const char *place, *what, *printed, *meant, *why;
};

constexpr Misprint chapter_2[] = {
    {"(2.5), (2.6)", "pressure in the discharge flow", "P_s", "P_0, by delta of (2.8)",
     "with P_s and delta as printed the discharge would be 0.82 of the charge; it is 0.22"},
    {"2.2.1", "gas of the chambers", "isothermal, \"from the simulation results of nonlinear model\"",
     "isothermal when slow",
     "in the ramps our nonlinear table warms by some K; only a chamber with a wall of 1e5 W/(m2 "
     "K) is isothermal there (rows of 2.4)"},
    {"(2.23)", "tau_1", "an operator", "normalised time",
     "the operator is s_1 = s/A_3^(1/3); as printed (2.24) has no unit that fits"},
    {"Tables 2.7, 2.8", "unit of the gains", "V/m, V s/m, V s2/m", "V/mm, V s/mm, V s2/mm",
     "per metre the printed move would ask 86 uV of a valve that opens at 1.6 V"},
    {"Table 2.8", "units of the lines, and captions of Figs 2.21, 2.22, 2.29", "L in mm, D in m", "L in m, D in mm",
     "a line of 0.5 mm and 4 m is none"},
    {"Table 2.4", "diameter of a line", "6.5 mm", "5.0 mm", "Figs 2.11 and 2.12 and Re 387.75 belong to 5.0 mm"},
    {"2.3", "\"Kalman filter\" with three fixed gains", "Kalman filter", "observer, Butterworth of 265.3 rad/s",
     "no noise of process or sensor is named; its discretisation is not given"},
    {"2.6.2", "figures of the third order on the curve of Fig 2.31", "22.67 and 21.50 um", "those of Fig 2.20's curve",
     "four digits do not repeat on another curve"},
    {"1.2.1, 1.3", "accuracy with the fifth order", "sub-micrometer", "0.30 um at 8 mm; 1.60 um at 4 mm",
     "Fig 2.32 says 1.60 um"},
};

constexpr Misprint chapter_3[] = {
    {"(3.7)", "lambda at Re = 2300", "jumps from 0.0278 to 0.0457", "linear between 2300 and 4000",
     "with the jump a flow near 2300 switches its friction by 64 % from step to step; turbulent_reynolds: 2300 gives "
     "it"},
    {"(3.8)", "sign of the wall heat beside its term in (3.4)", "theta - theta_a", "theta_a - theta",
     "right as heat that leaves the gas; in (3.4), which needs what enters, the term stands with its right sign"},
    {"(3.9)", "heat transfer of gas at rest", "none", "at least Nu = 3.66",
     "as printed gas at rest stays warm for ever; 0.046 is twice the usual 0.023 and kept"},
    {"3.3.2", "pressure of the line at the start", "supply in grid 0, atmosphere elsewhere",
     "the measured port pressure", "the gas is where the ports say; a wrong start dies by itself (docs/estimator.md)"},
    {"(3.15) to (3.18)", "rate of the volumes", "|x'|, a filled chamber grows", "x' with its sign",
     "wrong where a chamber is filled while it shrinks, as when the piston is braked"},
    {"(3.19), (3.20)", "density of the outlet flow", "picked by direction", "pressure centred, temperature upwind",
     "a pressure that is picked by direction jumps where the flow turns"},
    {"(3.22)", "friction of the piston, force on the rod", "+ B x', no rod", "- B x', the rod sees the atmosphere",
     "with + B friction drives the piston; without the rod 470 and 530 kPa push it by 31 N"},
    {"(3.23), (3.24)", "gas of the chambers", "isothermal", "energy equation (3.17), (3.18)",
     "both cannot hold; the index alone takes the isothermal form"},
};

void add(std::vector<ThesisRow>& rows, std::span<const Misprint> misprints) {
  for (const Misprint& one : misprints)
    rows.push_back({.place = one.place, .what = one.what, .printed = one.printed, .meant = one.meant, .why = one.why});
}

/// Of the shapes that a number can be put to.
std::vector<ThesisRow> with_a_number() {
  return {{.place = "2.2.1",
           .what = "psi at P_0/P_s = 0.44, \"almost equal to the critical ratio\"",
           .printed = "1",
           .ours =
               [](ThesisBench& bench) {
                 const Rig rig = bench.rig({table_4mm.config});
                 return orifice_psi(rig.controller.of<Ppd2>().equilibrium_pressure_Pa / rig.axis.supply.pressure_Pa,
                                    rig.axis.valve.critical_pressure_ratio);
               },
           .within = searched_within,
           .why = "charging counts as choked, which is right to 0.2 %"},
          {.place = "2.3",
           .what = "l_3 of the observer by the pattern of l_1 and l_2",
           .printed = "1.85e7",
           .ours =
               [](ThesisBench&) {
                 // Butterworth: l_1 = 2 w, l_2 = 2 w^2, l_3 = w^3.
                 return std::pow(std::sqrt(0.5 * 140739.9), 3.0);
               },
           .held = "1.867e7",
           .why = "the printed one is 0.9 % less than the Butterworth pattern of the other two"}};
}

}  // namespace

ThesisGroup thesis_misprint_group() {
  ThesisGroup group{"Printed wrong or left open, where no figure hangs on it", {}};
  add(group.rows, chapter_2);
  for (ThesisRow& row : with_a_number()) group.rows.push_back(std::move(row));
  add(group.rows, chapter_3);
  return group;
}

}  // namespace pneuservo
