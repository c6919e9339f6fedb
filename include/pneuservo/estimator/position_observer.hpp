// Position of the piston without an encoder: from the air that went into each side, the force of the chambers and the
// passages of switches, with a bound that grows from the last passage. docs/position.md derives it.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace pneuservo {

/// What the observer must know of the axis; shares and deviations are one standard deviation of what the owner knows.
struct PositionObserverParameters {
  double period_s = 1e-3;
  double stroke_m = 0.0;
  std::array<double, 2> area_m2{}, dead_volume_m3{}, line_volume_m3{};
  double gas_constant_J_per_kgK = 0.0, atmosphere_Pa = 0.0;
  double mass_kg = 0.0, viscous_friction_Ns_per_m = 0.0;
  double travel_s = 0.0;  ///< of sound along the longer line
  double mode_s = 0.0;    ///< period of the first mode of the slower line with its chamber

  double mass_share = 0.0, viscous_share = 0.0;
  double unknown_force_N = 0.0;   ///< dry friction and load that nothing tells of
  double valve_area_share = 0.0;  ///< of both edges together
  double valve_edge_share = 0.0;  ///< of each edge by itself
  double volume_share = 0.0;      ///< of line and dead volume
  double wall_heat_share = 0.0;
  double leak_kgps = 0.0;         ///< out of each side
  double switch_m = 0.0;          ///< of the place where a switch changes
};

/// One tick. Flows into each side: by the valve's own law, and by the model of line and chamber at the observer's
/// position. Bounds of the chamber pressures are those that the estimator states.
struct PositionObserverInput {
  std::array<double, 2> valve_flow_kgps{}, line_flow_kgps{};
  std::array<double, 2> chamber_Pa{}, chamber_K{}, chamber_bound_Pa{};
};

/// A Kalman filter of nine errors: position, velocity, acceleration by unknown forces, flow gain of the supplying and
/// of the exhausting edges, and of each side its leak and the mass of air that its balance began with. What is measured
/// is the balance: what the valve gave since the last passage less what the model took. HOT; nothing is allocated.
class PositionObserver {
 public:
  static constexpr double bound_deviations = 2.58;  ///< of a normal error, passed once in 100
  /// Forces that nothing tells of change from stroke to stroke.
  static constexpr double force_s = 0.2;
  /// Gains of the edges beside their area and leaks hang on the point of operation, which changes over several moves.
  static constexpr double operation_s = 10.0;
  /// The way of sound may take so much phase, 40 degrees, from the loop of observer and model.
  static constexpr double travel_phase = 0.7;

  void configure(const PositionObserverParameters& parameters) noexcept {
    p_ = parameters;
    reset(0.0, 0.0);
  }
  /// It stands at x_m with that standard deviation.
  void reset(double x_m, double deviation_m) noexcept {
    x_m_ = x_m, v_mps_ = shift_m_ = acceleration_mps2_ = 0.0;
    state_ = {};
    covariance_ = {};
    side_ = {};
    at(x, x) = square(deviation_m);
    at(a, a) = square(p_.unknown_force_N / p_.mass_kg);
    at(supply, supply) = at(exhaust, exhaust) = square(p_.valve_area_share) + square(p_.valve_edge_share);
    at(supply, exhaust) = at(exhaust, supply) = square(p_.valve_area_share);
    at(leak, leak) = at(leak + 1, leak + 1) = square(p_.leak_kgps);
    balanced_ = false;
  }

  double position_m() const noexcept { return x_m_; }
  double velocity_mps() const noexcept { return v_mps_; }
  /// Of the way since the last tick, what was a correction and no motion.
  double shift_m() const noexcept { return shift_m_; }
  /// The position's error is larger once in 100 ticks where the parameters are what was said.
  double bound_m() const noexcept { return bound_deviations * std::sqrt(at(x, x) + storage_variance_m2()); }
  /// What passages have taught of the edges: true over nominal flow, less 1.
  double supply_gain() const noexcept { return state_[supply]; }
  double exhaust_gain() const noexcept { return state_[exhaust]; }

  /// From the last tick to this one, and position and velocity on to the next.
  void step(const PositionObserverInput& in) noexcept {
    shift_m_ = 0.0;
    for (std::size_t i = 0; i < 2; ++i)
      side_[i].air_per_way_kg_per_m =
          sign(i) * in.chamber_Pa[i] * p_.area_m2[i] / (p_.gas_constant_J_per_kgK * in.chamber_K[i]);
    if (!balanced_) begin_balance(in);
    since_s_ += p_.period_s;
    for (std::size_t i = 0; i < 2; ++i) book_air(i, in);
    const double force_N = force_deviation_N(in);
    for (std::size_t i = 0; i < 2; ++i) weigh_air(i, in, force_N);
    predict(in, force_N);
  }
  /// A switch changed in the period that ends now: the slider was at x_m. It teaches the gains; the balance begins
  /// anew.
  void pass(double x_m) noexcept {
    const double way_m = p_.period_s * v_mps_;  // at an even chance of each moment
    const double place_m2 = square(p_.switch_m) + square(way_m) / 12.0, here_m = x_m + 0.5 * way_m;
    Column h{};
    h[x] = 1.0;
    update(h, here_m - x_m_, place_m2 + storage_variance_m2());
    shift(here_m - x_m_);
    for (std::size_t j = 0; j < count; ++j) at(x, j) = at(j, x) = 0.0;
    at(x, x) = place_m2;
    for (Side& side : side_) side.storage_m = 0.0;
    balanced_ = false;
  }

 private:
  enum : std::size_t { x, v, a, supply, exhaust, leak, mass = leak + 2, count = mass + 2 };
  using Column = std::array<double, count>;
  struct Side {
    double air_per_way_kg_per_m = 0.0;  ///< at constant pressure and temperature
    double missing_kg = 0.0;  ///< given by the valve and not taken by the model, since the balance began
    double supplied_kg = 0.0, exhausted_kg = 0.0;
    double begin_Pa = 0.0, begin_K = 0.0;
    double storage_m = 0.0;  ///< deviation by air that the model holds wrongly, as a way
  };
  static constexpr double square(double value) noexcept { return value * value; }
  static constexpr double sign(std::size_t i) noexcept { return i == 0 ? 1.0 : -1.0; }
  double& at(std::size_t i, std::size_t j) noexcept { return covariance_[i][j]; }
  double at(std::size_t i, std::size_t j) const noexcept { return covariance_[i][j]; }

  // What is missing is 0 now: the mass that the balance begins with is as wrong as the position is.
  void begin_balance(const PositionObserverInput& in) noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      Side& side = side_[i];
      side = {
          .air_per_way_kg_per_m = side.air_per_way_kg_per_m, .begin_Pa = in.chamber_Pa[i], .begin_K = in.chamber_K[i]};
      state_[mass + i] = 0.0;
      for (std::size_t j = 0; j < mass; ++j) at(mass + i, j) = at(j, mass + i) = -side.air_per_way_kg_per_m * at(x, j);
    }
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t j = 0; j < 2; ++j)
        at(mass + i, mass + j) = side_[i].air_per_way_kg_per_m * side_[j].air_per_way_kg_per_m * at(x, x);
    since_s_ = 0.0;
    balanced_ = true;
  }

  void book_air(std::size_t i, const PositionObserverInput& in) noexcept {
    const double given_kg = p_.period_s * in.valve_flow_kgps[i];
    (given_kg > 0.0 ? side_[i].supplied_kg : side_[i].exhausted_kg) += given_kg;
    side_[i].missing_kg += given_kg - p_.period_s * in.line_flow_kgps[i];
  }

  // The balance says where the piston is: missing air over air per way. Its error is fast where the estimator errs in
  // the rhythm of the line, and no quicker than the line tells the port of the chamber.
  void weigh_air(std::size_t i, const PositionObserverInput& in, double force_N) noexcept {
    Side& side = side_[i];
    const double chamber_m3 = p_.dead_volume_m3[i] + p_.area_m2[i] * std::max(0.0, 0.5 * p_.stroke_m + sign(i) * x_m_);
    const double gas_J_per_kg = p_.gas_constant_J_per_kgK * in.chamber_K[i];
    const double by_pressure_kg =
        in.chamber_bound_Pa[i] / bound_deviations * (chamber_m3 + 0.5 * p_.line_volume_m3[i]) / gas_J_per_kg;
    const double by_volume_kg = p_.volume_share * (p_.line_volume_m3[i] + p_.dead_volume_m3[i]) *
                                (in.chamber_Pa[i] - side.begin_Pa) / gas_J_per_kg;
    const double by_heat_kg = p_.wall_heat_share * chamber_m3 * in.chamber_Pa[i] / gas_J_per_kg *
                              (in.chamber_K[i] - side.begin_K) / in.chamber_K[i];
    side.storage_m = std::sqrt(square(by_pressure_kg) + square(by_volume_kg) + square(by_heat_kg)) /
                     std::fabs(side.air_per_way_kg_per_m);
    const double fast_kg2_s = square(by_pressure_kg) * 2.0 * p_.mode_s;
    const double slow_kg2_s = 2.0 * force_s * square(force_N / p_.mass_kg * side.air_per_way_kg_per_m) *
                              square(square(p_.travel_s / travel_phase));
    Column h{};
    h[x] = side.air_per_way_kg_per_m;
    h[supply] = -side.supplied_kg, h[exhaust] = -side.exhausted_kg;
    h[leak + i] = since_s_, h[mass + i] = 1.0;
    double expected_kg = 0.0;
    for (std::size_t j = supply; j < count; ++j) expected_kg += h[j] * state_[j];
    update(h, side.missing_kg - expected_kg, std::max(fast_kg2_s, slow_kg2_s) / p_.period_s);
  }

  /// Standard deviation of what the model of the slider does not know of its forces.
  double force_deviation_N(const PositionObserverInput& in) const noexcept {
    const double side_1 = p_.area_m2[0] * in.chamber_bound_Pa[0] / bound_deviations,
                 side_2 = p_.area_m2[1] * in.chamber_bound_Pa[1] / bound_deviations;
    return std::sqrt(square(p_.unknown_force_N) + square(side_1) + square(side_2) +
                     square(p_.viscous_share * p_.viscous_friction_Ns_per_m * v_mps_) +
                     square(p_.mass_share * p_.mass_kg * acceleration_mps2_));
  }

  /// Of the mean of what both sides say.
  double storage_variance_m2() const noexcept {
    return 0.25 * (square(side_[0].storage_m) + square(side_[1].storage_m));
  }

  void update(const Column& h, double innovation, double variance) noexcept {
    Column ph{};
    double s = variance;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) ph[i] += at(i, j) * h[j];
      s += h[i] * ph[i];
    }
    if (!(s > 0.0)) return;
    const double inverse = 1.0 / s, step = innovation * inverse;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j <= i; ++j) at(i, j) = at(j, i) = at(i, j) - ph[i] * ph[j] * inverse;
    shift(ph[x] * step);
    v_mps_ += ph[v] * step;
    for (std::size_t i = a; i < count; ++i) state_[i] += ph[i] * step;
  }
  // The air of the model follows, so it is missing no more.
  void shift(double way_m) noexcept {
    x_m_ += way_m, shift_m_ += way_m;
    for (Side& side : side_) side.missing_kg -= side.air_per_way_kg_per_m * way_m;
  }

  void predict(const PositionObserverInput& in, double force_deviation) noexcept {
    const double dt = p_.period_s, forget = 1.0 - dt / force_s,
                 damp = 1.0 - dt * p_.viscous_friction_Ns_per_m / p_.mass_kg;
    const double force_N = p_.area_m2[0] * in.chamber_Pa[0] - p_.area_m2[1] * in.chamber_Pa[1] -
                           (p_.area_m2[0] - p_.area_m2[1]) * p_.atmosphere_Pa;
    acceleration_mps2_ = (force_N - p_.viscous_friction_Ns_per_m * v_mps_) / p_.mass_kg + state_[a];
    x_m_ += dt * (v_mps_ + 0.5 * dt * acceleration_mps2_);
    v_mps_ += dt * acceleration_mps2_;
    state_[a] *= forget;
    for (std::size_t j = 0; j < count; ++j) {
      at(x, j) += dt * at(v, j);
      at(v, j) = damp * at(v, j) + dt * at(a, j);
      at(a, j) *= forget;
    }
    for (std::size_t i = 0; i < count; ++i) {
      at(i, x) += dt * at(i, v);
      at(i, v) = damp * at(i, v) + dt * at(i, a);
      at(i, a) *= forget;
    }
    at(a, a) += 2.0 * dt / force_s * square(force_deviation / p_.mass_kg);
    const double changed = 2.0 * dt / operation_s, edges = changed * square(p_.valve_edge_share),
                 leaks = changed * square(p_.leak_kgps);
    at(supply, supply) += edges, at(exhaust, exhaust) += edges;
    at(leak, leak) += leaks, at(leak + 1, leak + 1) += leaks;
  }

  PositionObserverParameters p_;
  double x_m_ = 0.0, v_mps_ = 0.0, shift_m_ = 0.0, acceleration_mps2_ = 0.0, since_s_ = 0.0;
  Column state_{};
  std::array<Column, count> covariance_{};
  std::array<Side, 2> side_{};
  bool balanced_ = false;
};

}  // namespace pneuservo
