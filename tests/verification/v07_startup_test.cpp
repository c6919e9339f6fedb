// V07: laminar flow started from rest by a constant pressure gradient, with quasi-steady friction and with its memory.
#include "gas_rig.hpp"

using namespace verification;

namespace {
constexpr double viscosity = 1.8e-5, density = p_start / (287.0 * T_start), gradient = 5.0;

// Velocity over time in a line so short (1 cell of 10 mm) that waves do not matter.
double velocity_after(Resolution resolution, double D_mm, double time_s, bool with_memory) {
  const double L = 0.01;
  Line<double> line;
  line.configure(line_of(L, D_mm), nominal_air(), 1);
  LineEffects<double> effects;
  effects.frequency_dependent_losses.share = with_memory ? 1.0 : 0.0;
  line.set_effects(effects);
  line.reset(p_start, T_start);
  const double limit = resolution == Resolution::normal ? 2e-5 : 2e-7;  // 2e-5 s: Courant number 0.7
  const int steps = std::max(1, static_cast<int>(std::ceil(time_s / limit)));
  line.set_time_step(time_s / steps);
  const double head = 0.5 * gradient * L;
  for (int i = 0; i < steps; ++i) line.step_prescribed(p_start + head, {p_start - head, T_start});
  return 0.5 * (line.face_velocity(0) + line.face_velocity(1));
}

double weighting_function(double tau) {
  double sum = 0;
  for (std::size_t i = 0; i < WallLayer<double>::terms; ++i)
    sum += WallLayer<double>::weight[i] * std::exp(-WallLayer<double>::decay[i] * tau);
  return sum;
}

Answer startup_answer(Resolution resolution, const Check& check) {
  if (check.quantity == "weighting_function_W") return weighting_function(check.number("tau"));
  const double D_mm = check.has("D_mm") ? check.number("D_mm") : 4.15, R = 0.5e-3 * D_mm;
  const double diffusion_time = R * R * density / viscosity;
  if (check.quantity == "R^2_over_nu") return diffusion_time;
  const bool exact = check.is("friction", "exact");
  if (check.quantity == "mean_velocity") return velocity_after(resolution, D_mm, check.number("t_s"), exact);
  if (check.quantity == "mean_velocity_over_final")
    return velocity_after(resolution, D_mm, check.number("tau") * diffusion_time, exact) /
           (R * R * gradient / (8.0 * viscosity));
  throw std::runtime_error("quantity is unknown");
}
}  // namespace

TEST_CASE("V07 laminar flow started from rest", "[V07]") {
  Case v07("V07", {"frequency_dependent"});
  for (const auto resolution : {Resolution::normal, Resolution::fine})
    v07.run(resolution, [&](const Check& check) { return startup_answer(resolution, check); });
}
