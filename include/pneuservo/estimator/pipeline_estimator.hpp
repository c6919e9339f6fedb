// Distributed pipeline estimator: chamber pressures and flows in real time from pressures at the valve ports.
//
// Header-only, Eigen alone. A complete use (compiled and run by tests/estimator/example_test.cpp):
//
//   pneuservo::EstimatorParameters parameters;               // nominal air; then what the machine has
//   parameters.supply_pressure_Pa = 700e3;
//   parameters.line_1 = {.length_m = 10.0, .diameter_m = 0.00765};
//   parameters.line_2 = parameters.line_1;
//   parameters.cylinder = {.stroke_m = 0.3, .area_1_m2 = 1.257e-3, .area_2_m2 = 1.056e-3, .dead_volume_1_m3 = 2e-5,
//                          .dead_volume_2_m3 = 2e-5, .wall_heat_W_per_m2K = 50.0};
//   pneuservo::PipelineEstimator estimator;
//   estimator.configure(parameters);                         // once: checks and allocates
//   for (int k = 0; k < 1000; ++k) {                         // every millisecond, in the control loop
//     const auto chambers = estimator.step({p1_port_Pa, p2_port_Pa, x_m, v_mps});
//     const double force_N = 1.257e-3 * chambers.chamber_pressure_Pa[0] - 1.056e-3 * chambers.chamber_pressure_Pa[1];
//   }
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <Eigen/Core>

#include <pneuservo/core/pack.hpp>
#include <pneuservo/core/random.hpp>
#include <pneuservo/elements/orifice.hpp>
#include <pneuservo/elements/valves.hpp>
#include <pneuservo/estimator/axis_estimator.hpp>

namespace pneuservo {

/// What the stated error bound takes into account. All one standard deviation of what the owner knows.
struct EstimatorUncertainty {
  double port_noise_Pa = 300.0;         ///< white noise of the port pressure sensors, rms
  double relative_diameter = 0.0;       ///< of the lines
  double relative_area = 0.0;           ///< of the piston
  double relative_valve_area = 0.0;     ///< of the valve, where flow_correction uses it
  double start_pressure_Pa = 100e3;     ///< how wrong the gas state may be at the first tick
};

/// Everything the estimator must know of the axis.
struct EstimatorParameters {
  AirParameters<double> air;
  double supply_pressure_Pa = 0.0;
  LineParameters<double> line_1, line_2;
  CylinderParameters<double> cylinder;
  double period_s = 0.001;
  ValveParameters<double> valve;  ///< for the flow correction; the orifices of effects have its critical ratio
  ValveArrangement arrangement = ValveArrangement::five_port;
  double flow_correction = 0.0;   ///< share of the flow innovation that corrects the port pressure, 0 (off) to 0.5
  double cells_per_m = 1.0;  ///< at least one cell a line; 1 is enough for the accuracy stated in docs/estimator.md
  EstimatorUncertainty uncertainty;
  /// Known of the axis beside the nominal model. Restrictions, leaks, branches and hoses that swell count; what the
  /// valve's command path does counts for the flow correction.
  AxisEffects<double> effects;
  /// Those of the effects count, too: a tick costs more (docs/estimator.md).
  bool frequency_dependent_losses = false;
};

/// One tick's measurements: absolute pressures at the valve ports, position (0 at mid-stroke) and velocity of the
/// piston. NaN or an impossible value means "no measurement": the last one is held and a health bit says so.
struct EstimatorInput {
  double p1_port_Pa;
  double p2_port_Pa;
  double x_m;
  double v_mps;
  /// What the valve was given over the period that ends now; NaN: unknown, and the flow correction rests.
  double valve_command_V = std::numeric_limits<double>::quiet_NaN();
  /// The same of the valve at side 2; NaN: one valve serves both sides, and side 2 has the opposite.
  double valve_command_2_V = std::numeric_limits<double>::quiet_NaN();
  /// Of the way since the last tick, what is a better knowledge of x_m and no motion: pressures stay as they are.
  double shift_m = 0.0;
};

/// Health bits of one tick.
enum EstimatorHealth : std::uint32_t {
  estimator_port_1_held = 1,  ///< port pressure 1 missing or outside [0.3 p_atm, 1.5 p_supply]
  estimator_port_2_held = 2,
  estimator_position_held = 4,  ///< position missing or beyond 0.6 stroke
  estimator_position_limited = 8,  ///< position moved faster than 5 m/s
  estimator_state_guarded = 16,  ///< a line limited a speed or a temperature
  estimator_not_started = 32,  ///< no usable measurement yet
};

/// Index 0 is chamber 1, 1 is chamber 2.
struct EstimatorOutput {
  Eigen::Array2d chamber_pressure_Pa = Eigen::Array2d::Zero();
  Eigen::Array2d mass_flow_kgps = Eigen::Array2d::Zero();  ///< into the chamber
  Eigen::Array2d port_mass_flow_kgps = Eigen::Array2d::Zero();  ///< into the line at the valve port
  Eigen::Array2d chamber_temperature_K = Eigen::Array2d::Zero();
  Eigen::Array2d error_bound_Pa = Eigen::Array2d::Zero();  ///< holds in 99 of 100 ticks, given the uncertainty
  std::array<bool, 2> valid{false, false};  ///< false: inputs missing for too long to be trusted
  std::uint32_t health = 0;
};

/// Both lines and chambers run in SIMD lanes, and beside them a shadow pair with the same inputs plus one more draw of
/// the sensor noise, the parameters at the edge of their uncertainty and another start. How far the shadow strays is
/// what the estimate may be wrong by: its distance, held at its peaks, is the stated bound. docs/estimator.md.
class PipelineEstimator {
 public:
  /// Checks and allocates. Throws std::invalid_argument naming the parameter, its value and what is expected.
  void configure(const EstimatorParameters& parameters) {
    check(parameters);
    parameters_ = parameters;
    using L = LineParameters<Lanes>;
    const auto& c = parameters.cylinder;
    const double thin = 1.0 - parameters.uncertainty.relative_diameter,
                 wide = 1.0 + parameters.uncertainty.relative_area;
    auto line = cast<L>(parameters.line_1);
    set_parameters_lane(line, 1, parameters.line_2);
    auto shadow_line = parameters.line_1;
    shadow_line.diameter_m *= thin;
    set_parameters_lane(line, 2, shadow_line);
    shadow_line = parameters.line_2;
    shadow_line.diameter_m *= thin;
    set_parameters_lane(line, 3, shadow_line);
    const ChamberGeometry<Lanes> geometry{lanes(c.area_1_m2, c.area_2_m2, c.area_1_m2 * wide, c.area_2_m2 * wide),
                                          both(c.dead_volume_1_m3, c.dead_volume_2_m3), Lanes(c.wall_heat_W_per_m2K)};
    const int cells = std::max(cell_count(parameters.line_1.length_m, parameters.cells_per_m),
                               cell_count(parameters.line_2.length_m, parameters.cells_per_m));
    axis_.configure(line, geometry, cast<AirParameters<Lanes>>(parameters.air), Lanes(0.5 * c.stroke_m),
                    both(1.0, -1.0), parameters.period_s, cells);
    air_ = Air<Lanes>(cast<AirParameters<Lanes>>(parameters.air));
    configure_effects(parameters);
    // A plane wave that leaves the line changes the port's pressure by c G / A.
    const double sound_mps = lane(air_.sound_speed(), 0);
    const auto impedance = [&](const LineParameters<double>& l) {
      return parameters.flow_correction * sound_mps / l.section_m2();
    };
    correction_gain_ = both(impedance(parameters.line_1), impedance(parameters.line_2));
    corrects_flow_ = parameters.flow_correction > 0.0 && !(parameters.valve.natural_frequency_Hz > 0.0);
    grid_share_of_cell_ = grid_share / cells;
    alike_ = parameters.line_1.length_m == parameters.line_2.length_m &&
             parameters.line_1.diameter_m == parameters.line_2.diameter_m;
    open_per_m_ = 1.0 / (nearly_closed * 0.5 * c.stroke_m);
    start_decay_ = std::exp(-parameters.period_s / start_time_s);
    peak_decay_ = std::exp(-parameters.period_s / peak_time_s);
    rms_gain_ = -std::expm1(-parameters.period_s / rms_time_s);
    grid_decay_ = std::exp(-parameters.period_s / grid_time_s);
    random_ = Random(0x5EED);
    reset();
  }

  /// Forgets everything; the next valid measurement starts it again.
  void reset() noexcept {
    started_ = false;
    peak_ = mean_square_ = drop_peak_ = correction_ = surplus_ = port_ = Lanes(0);
    missing_s_ = {0.0, 0.0, 0.0};
    guards_seen_ = axis_.side().line().guard_actions();
  }
  /// Starts at a known gas state at rest instead of the first port pressures.
  void start(double pressure_1_Pa, double pressure_2_Pa, double position_m) noexcept {
    input_ = {pressure_1_Pa, pressure_2_Pa, position_m, 0.0};
    begin();
  }

  /// One tick; allocates nothing, throws nothing, of nearly the same cost whatever happens.
  EstimatorOutput step(const EstimatorInput& measured) noexcept {
    std::uint32_t health = guard_input(measured);
    if (!started_) {
      if (health & (estimator_port_1_held | estimator_port_2_held | estimator_position_held))
        return {.health = health | estimator_not_started};
      begin();
    } else {
      const double sigma = parameters_.uncertainty.port_noise_Pa;
      const double p_1 = input_.p1_port_Pa, p_2 = input_.p2_port_Pa;
      // Uniform noise of the same variance: the line filters it to a normal one.
      const double scale = sigma * 3.4641016151377544;
      // One after the other: the order in which a compiler evaluates arguments is its own.
      const double noise_2 = scale * (random_.uniform() - 0.5), noise_1 = scale * (random_.uniform() - 0.5);
      const Lanes port = lanes(p_1, p_2, p_1 + noise_1, p_2 + noise_2);
      ChamberInflow<Lanes> extra = leaks_ ? chamber_leaks() : ChamberInflow<Lanes>{};
      if (measured.shift_m != 0.0) extra = shifted(extra, measured.shift_m);
      axis_.step(port + correction_, input_.x_m, -start_shares() * surplus_, extra);
      if (corrects_flow_) correct(measured, port);
    }
    return output(health);
  }

  const EstimatorParameters& parameters() const noexcept { return parameters_; }
  const AxisEstimator<Pack<double, 4>>& axis() const noexcept { return axis_; }

 private:
  using Lanes = Pack<double, 4>;  // chamber 1, chamber 2, shadow of 1, shadow of 2

  /// A port pressure missing longer than this, or a position, and the estimate is no longer called valid.
  static constexpr double trusted_gap_s = 0.02;
  /// A missing position goes on with the last velocity for this long, then stays.
  static constexpr double position_bridge_s = 0.01;
  static constexpr double fastest_position_mps = 5.0;
  /// Mean square of the shadows' distance over about this time, the mean of both chambers where their lines are alike:
  /// noise makes of them two draws of one spread. About 2.6 of its root is passed once in 100 by normal noise.
  static constexpr double rms_time_s = 0.5;
  static constexpr double rms_factor = 2.6;
  /// A distance that rises is followed at once: its peaks, with a margin, fade with this time constant.
  static constexpr double peak_time_s = 0.25;
  static constexpr double peak_factor = 1.34;
  /// Error of the grid and of sampling the ports once a period: a floor, and a share of the pressure drop of one cell
  /// (held at its peaks over a stroke) that grows with the drop over the line.
  static constexpr double grid_time_s = 0.5;
  static constexpr double grid_share = 0.017;
  static constexpr double grid_growth_per_Pa = 5e-6;
  static constexpr double grid_floor_Pa = 55.0;
  /// Share of the port's surplus flow that goes into the chamber after a start, and how fast that fades: a valve whose
  /// area is not known well must not bend the estimate for ever.
  static constexpr double start_gain = 1.0;
  static constexpr double start_time_s = 0.5;
  static constexpr double nearly_closed = 0.2;  ///< of half the stroke
  /// A wave of more than this is no error of a model but a valve that does something else.
  static constexpr double correction_limit_Pa = 20e3;

  // Joined in registers: four numbers stored one by one and loaded as one would wait for the stores.
  static Lanes lanes(double a, double b, double c, double d) noexcept { return join(join(a, b), join(c, d)); }
  static Lanes both(double a, double b) noexcept { return lanes(a, b, a, b); }

  static void require(bool good, const char* key, double value, const char* expected) {
    if (!good)
      throw std::invalid_argument(std::string("estimator: ") + key + " is " + std::to_string(value) + ", expected " +
                                  expected);
  }
  static void check(const EstimatorParameters& p) {
    require(p.supply_pressure_Pa > p.air.atmosphere_Pa, "supply_pressure_Pa", p.supply_pressure_Pa,
            "an absolute pressure above atmosphere");
    for (const auto* line : {&p.line_1, &p.line_2}) {
      require(line->length_m > 0.0, "line length_m", line->length_m, "a length above 0");
      require(line->diameter_m > 0.0, "line diameter_m", line->diameter_m, "a diameter above 0");
      require(line->turbulent_reynolds >= line->laminar_reynolds, "line turbulent_reynolds", line->turbulent_reynolds,
              "at least laminar_reynolds");
    }
    require(p.cylinder.stroke_m > 0.0, "cylinder.stroke_m", p.cylinder.stroke_m, "a stroke above 0");
    require(p.cylinder.area_1_m2 > 0.0, "cylinder.area_1_m2", p.cylinder.area_1_m2, "an area above 0");
    require(p.cylinder.area_2_m2 > 0.0, "cylinder.area_2_m2", p.cylinder.area_2_m2, "an area above 0");
    require(p.cylinder.dead_volume_1_m3 > 0.0, "cylinder.dead_volume_1_m3", p.cylinder.dead_volume_1_m3,
            "a volume above 0");
    require(p.cylinder.dead_volume_2_m3 > 0.0, "cylinder.dead_volume_2_m3", p.cylinder.dead_volume_2_m3,
            "a volume above 0");
    require(p.period_s > 0.0 && p.period_s <= 0.1, "period_s", p.period_s, "0 to 0.1 s");
    require(p.flow_correction >= 0.0 && p.flow_correction <= 0.5, "flow_correction", p.flow_correction, "0 to 0.5");
    require(p.cells_per_m > 0.0, "cells_per_m", p.cells_per_m, "a number above 0");
  }

  template <class To, class From> static To sides(const From& side_1, const From& side_2) {
    To out = cast<To>(side_1);
    set_parameters_lane(out, 1, side_2);
    set_parameters_lane(out, 3, side_2);
    return out;
  }
  void configure_effects(const EstimatorParameters& parameters) {
    const AxisEffects<double>& e = parameters.effects;
    LineEffects<Lanes> of_lines;
    const auto of_line_1 = LineEffects<double>::of_line_1(e), of_line_2 = LineEffects<double>::of_line_2(e);
    LineEffects<Lanes>::visit([](auto& to, const auto& side_1,
                                 const auto& side_2) { to = sides<std::remove_cvref_t<decltype(to)>>(side_1, side_2); },
                              of_lines, of_line_1, of_line_2);
    if (!parameters.frequency_dependent_losses) of_lines.frequency_dependent_losses = {};
    of_lines.critical_pressure_ratio = Lanes(parameters.valve.critical_pressure_ratio);
    axis_.side().line().set_effects(of_lines);
    chamber_leak_m2_ = both(e.chamber_leak_1.area_m2, e.chamber_leak_2.area_m2);
    chamber_relief_ = sides<ChamberRelief<Lanes>>(e.chamber_relief_1, e.chamber_relief_2);
    leaks_ = any(chamber_leak_m2_ + chamber_relief_.area_per_pressure_m2_per_Pa > Lanes(0)) ||
             e.piston_leak.area_m2 > 0.0 || e.piston_leak_zone.area_m2 > 0.0;
    leak_table_ = sides<LeakOverPressure<Lanes>>(e.leak_over_pressure_1, e.leak_over_pressure_2);
    leaks_by_table_ = leak_table_.is_there();
    leaks_ = leaks_ || leaks_by_table_;
    moves_otherwise_ = parameters.valve.on_off.has_value();
    ValveEffects<double>::visit(
        [this](const Field&, const auto& effect) {
          using Effect = std::remove_cvref_t<decltype(effect)>;
          const Effect none;
          Effect::visit([this](const Field&, double known, double neutral) { moves_otherwise_ |= known != neutral; },
                        effect, none);
        },
        e.valve);
    if (!moves_otherwise_) return;
    valves_.configure(parameters.arrangement, parameters.valve, e.valve, parameters.period_s);
    valves_.set_time_step(parameters.period_s);
  }

  // Out of each chamber to the atmosphere, and past the piston into the other one.
  ChamberInflow<Lanes> chamber_leaks() const noexcept {
    const auto& e = parameters_.effects;
    const Lanes p = axis_.chamber_pressure(), T = axis_.chamber_temperature();
    const Lanes other_p = other_side(p), other_T = other_side(T), b(parameters_.valve.critical_pressure_ratio);
    const Lanes past_piston(e.piston_leak.area_m2 + e.piston_leak_zone.area_at(input_.x_m));
    Lanes area = chamber_leak_m2_ + chamber_relief_.area_at(p);
    if (leaks_by_table_) area += leak_table_.at(p);
    const Lanes out = orifice_mass_flow(air_, area, b, p, T, air_.atmosphere_Pa, air_.temperature_K);
    const Lanes across = orifice_mass_flow(air_, past_piston, b, p, T, other_p, other_T);
    return {-out - across,
            -orifice_enthalpy_flow(air_, out, T, air_.temperature_K) - orifice_enthalpy_flow(air_, across, T, other_T)};
  }
  // With what a shift of the piston adds to the chambers at their pressure and temperature.
  ChamberInflow<Lanes> shifted(const ChamberInflow<Lanes>& others, double shift_m) const noexcept {
    const auto& c = parameters_.cylinder;
    const double volume_rate = shift_m / parameters_.period_s;
    const Lanes p = axis_.chamber_pressure(), T = axis_.chamber_temperature();
    const Lanes mass_flow = p * both(volume_rate * c.area_1_m2, -volume_rate * c.area_2_m2) / (air_.R * T);
    return {others.mass_flow_kgps + mass_flow, others.enthalpy_flow_W + mass_flow * air_.cp * T};
  }
  static Lanes other_side(const Lanes& side) noexcept { return lanes(side[1], side[0], side[3], side[2]); }

  void begin() noexcept {
    valves_.reset(0.0);
    const double p_1 = input_.p1_port_Pa, p_2 = input_.p2_port_Pa, off = parameters_.uncertainty.start_pressure_Pa;
    // The shadow starts wrong towards the middle of what is possible, so that it starts from a possible pressure.
    const double middle = 0.5 * (parameters_.air.atmosphere_Pa + parameters_.supply_pressure_Pa);
    axis_.reset(lanes(p_1, p_2, p_1 + (p_1 < middle ? off : -off), p_2 + (p_2 < middle ? off : -off)), input_.x_m);
    port_ = lanes(p_1, p_2, p_1, p_2);
    correction_ = surplus_ = Lanes(0);
    start_gain_ = start_gain;
    started_ = true;
  }

  // The valve's flow over the period less the model's corrects the next port pressure, as the pressure of the wave that
  // leaves by the valve: it damps the ringing that sensor noise feeds. While the start is not yet forgotten it also
  // goes into the chamber: the line's resistance R holds an error of the chamber's capacity C for the time R C; with a
  // share k of the surplus it takes R C / (1 + k).
  void correct(const EstimatorInput& measured, const Lanes& port) noexcept {
    const Lanes middle = Lanes(0.5) * (port + port_);
    port_ = port;
    start_gain_ *= start_decay_;
    correction_ = surplus_ = Lanes(0);
    const double command_V = measured.valve_command_V, second_V = measured.valve_command_2_V;
    if (!std::isfinite(command_V)) return;
    const Pair<double> edges = edge_areas(command_V, std::isfinite(second_V) ? second_V : -command_V);
    const Lanes area = join(edges, Pair<double>(1.0 + parameters_.uncertainty.relative_valve_area) * edges);
    const auto feeds = area >= Lanes(0);
    const Lanes outside = select(feeds, Lanes(parameters_.supply_pressure_Pa), Lanes(parameters_.air.atmosphere_Pa));
    const Lanes flow = orifice_mass_flow(air_, absolute(area), Lanes(parameters_.valve.critical_pressure_ratio),
                                         outside, air_.temperature_K, middle, air_.temperature_K);
    const Lanes largest(correction_limit_Pa);
    surplus_ = flow - axis_.flow().port_mass_flow_kgps;
    correction_ = maximum(minimum(correction_gain_ * surplus_, largest), -largest);
  }

  // Of the edge that is open at each port: positive to the supply, negative to the exhaust.
  Pair<double> edge_areas(double command_V, double second_V) noexcept {
    const auto area = [&valve = parameters_.valve](double of_V) {
      return std::copysign(std::min(std::fabs(of_V) * valve.area_per_volt_m2_per_V, valve.area_max_m2), of_V);
    };
    if (!moves_otherwise_) return join(area(command_V), area(second_V));
    valves_.set_commands(command_V, second_V);
    const PortAreas<Pair<double>> areas = valves_.step(0.0);
    return areas.supply - areas.exhaust;
  }

  // Of the surplus that goes into each chamber. One that is nearly closed has its line's pressure anyway, and would
  // make much of the noise.
  Lanes start_shares() const noexcept {
    const double half = 0.5 * parameters_.cylinder.stroke_m, x = input_.x_m;
    const Lanes open = both(half + x, half - x) * Lanes(open_per_m_);
    return Lanes(start_gain_) * minimum(maximum(open, Lanes(0)), Lanes(1));
  }

  // Replaces what cannot be by what was, and says so.
  std::uint32_t guard_input(const EstimatorInput& measured) noexcept {
    std::uint32_t health = 0;
    const double lowest = 0.3 * parameters_.air.atmosphere_Pa, highest = 1.5 * parameters_.supply_pressure_Pa;
    const auto port = [&](double value, double& kept, double& missing_s, std::uint32_t bit) {
      const bool good = value >= lowest && value <= highest;
      if (good) kept = value;
      else health |= bit;
      missing_s = good ? 0.0 : missing_s + parameters_.period_s;
    };
    port(measured.p1_port_Pa, input_.p1_port_Pa, missing_s_[0], estimator_port_1_held);
    port(measured.p2_port_Pa, input_.p2_port_Pa, missing_s_[1], estimator_port_2_held);
    const double reach = 0.6 * parameters_.cylinder.stroke_m, longest = fastest_position_mps * parameters_.period_s;
    const bool placed = std::fabs(measured.x_m) <= reach;
    missing_s_[2] = placed ? 0.0 : missing_s_[2] + parameters_.period_s;
    if (std::fabs(measured.v_mps) <= fastest_position_mps) input_.v_mps = measured.v_mps;
    double wanted = measured.x_m;
    const double from = input_.x_m + measured.shift_m;
    if (!placed) {
      health |= estimator_position_held;
      wanted = input_.x_m + (missing_s_[2] <= position_bridge_s ? input_.v_mps * parameters_.period_s : 0.0);
      wanted = std::clamp(wanted, -reach, reach);
    }
    if (started_ && std::fabs(wanted - from) > longest) {
      health |= estimator_position_limited;
      wanted = from + std::copysign(longest, wanted - from);
    }
    input_.x_m = wanted;
    return health;
  }

  EstimatorOutput output(std::uint32_t health) noexcept {
    const Lanes p = axis_.chamber_pressure(), T = axis_.chamber_temperature(), G = axis_.flow().chamber_mass_flow_kgps,
                G_port = axis_.flow().port_mass_flow_kgps;
    const Lanes distance = absolute(join(high(p), high(p)) - p);
    const Lanes drop = absolute(both(input_.p1_port_Pa, input_.p2_port_Pa) - p);
    peak_ = maximum(distance, Lanes(peak_decay_) * peak_);
    // Not above the fading peak: the wrong start is large and must not linger in the mean.
    mean_square_ = minimum(mean_square_ + Lanes(rms_gain_) * (distance * distance - mean_square_), peak_ * peak_);
    drop_peak_ = maximum(drop, Lanes(grid_decay_) * drop_peak_);
    const auto squares = low(mean_square_);
    const Lanes mean_square = alike_ ? Lanes(0.5 * (low(squares) + high(squares))) : mean_square_;
    const Lanes stray_squared =
        maximum(Lanes(rms_factor * rms_factor) * mean_square, Lanes(peak_factor * peak_factor) * (peak_ * peak_));
    const Lanes grid = Lanes(grid_floor_Pa) +
                       Lanes(grid_share_of_cell_) * drop_peak_ * (Lanes(1) + Lanes(grid_growth_per_Pa) * drop_peak_);
    const Lanes bound = square_root(stray_squared + grid * grid);
    const std::int64_t guards = axis_.side().line().guard_actions();
    if (guards != guards_seen_) health |= estimator_state_guarded;
    guards_seen_ = guards;
    const auto trusted = [&](std::size_t i) {
      return missing_s_[i] <= trusted_gap_s && missing_s_[2] <= trusted_gap_s;
    };
    return {.chamber_pressure_Pa = {p[0], p[1]},
            .mass_flow_kgps = {G[0], G[1]},
            .port_mass_flow_kgps = {G_port[0], G_port[1]},
            .chamber_temperature_K = {T[0], T[1]},
            .error_bound_Pa = {bound[0], bound[1]},
            .valid = {trusted(0), trusted(1)},
            .health = health};
  }

  EstimatorParameters parameters_;
  AxisEstimator<Lanes> axis_;
  EstimatorInput input_{};
  std::array<double, 3> missing_s_{};  // port 1, port 2, position
  Lanes peak_, mean_square_, drop_peak_;
  Air<Lanes> air_;
  Lanes correction_, correction_gain_, port_;  // Pa, Pa s/kg, Pa of the last tick
  Lanes surplus_;  // of the valve's flow over the model's in the last tick, kg/s
  double start_gain_ = 0.0, start_decay_ = 1.0, open_per_m_ = 0.0;
  Valves<double> valves_;
  Lanes chamber_leak_m2_;
  ChamberRelief<Lanes> chamber_relief_;
  LeakOverPressure<Lanes> leak_table_;
  bool leaks_by_table_ = false;
  bool corrects_flow_ = false, alike_ = true, leaks_ = false, moves_otherwise_ = false;
  double grid_share_of_cell_ = grid_share;
  double peak_decay_ = 0.0, rms_gain_ = 1.0, grid_decay_ = 0.0;
  Random random_;
  bool started_ = false;
  std::int64_t guards_seen_ = 0;
};

}  // namespace pneuservo
