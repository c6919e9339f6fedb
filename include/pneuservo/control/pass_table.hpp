// What a command pass found (docs/physics/command_pass.md): the command along a reference, and what a law sees there.
#pragma once
#include <cstddef>
#include <vector>

namespace pneuservo {

/// One tick of a pass; measured values as the law's sensors or estimator show them.
struct PassRow {
  double asked_V = 0.0;              ///< over the period that begins, before the valve's known dead band or play
  double x_m = 0.0;                  ///< position
  double p1_Pa = 0.0, p2_Pa = 0.0;   ///< of the law's pressure source, absolute
  double supply_Pa = 0.0;
  double port_1_Pa = 0.0, port_2_Pa = 0.0;
};

/// What the law takes of a tick: the pass' command and force, and what of them the formula has already.
struct PassTick {
  double u_V = 0.0, formula_V = 0.0, F_N = 0.0, motion_N = 0.0;
};

/// Ticks from the reference's time 0 on. It rests before the first row as there.
struct PassTable {
  static constexpr double rest_s = 0.5;  ///< the rest before time 0 from which it begins
  std::size_t repeats = 1;    ///< ticks at the end that stand for all later ones, again and again
  std::vector<PassRow> rows;  ///< none: set points come at run time, and passes with them
  /// Position in the ticks after one more volt for a period, in the closed loop; empty: not asked for.
  std::vector<double> response_m_per_V{};
};

}  // namespace pneuservo
