// Moving mass with friction laws, loads and end stops (thesis 3.22 with the friction opposing the motion).
#pragma once
#include <pneuservo/elements/coupled_load.hpp>
#include <pneuservo/elements/effects.hpp>
#include <pneuservo/elements/oscillation.hpp>
#include <pneuservo/elements/parameters.hpp>

namespace pneuservo {

/// What the slider's friction laws look at beside its own motion.
template <class S> struct SliderSurroundings {
  S gauge_pressure_sum_Pa{};  ///< max(p1 - p_atm, 0) + max(p2 - p_atm, 0)
};

/// m dv/dt = F_drive - B v - F_friction(v, x, p) - F_load(x). Friction that holds at rest holds exactly: a slider below
/// breakaway does not move at all, and one that comes to rest within a step rests from that instant.
template <class S> class Slider {
 public:
  /// stroke: end stops at +-stroke/2 with coefficient of restitution.
  void configure(const SliderParameters<S>& slider, const MotionEffects<S>& effects, const S& stroke_m,
                 const S& restitution) noexcept {
    own_mass_ = slider.mass_kg + slider.payload_kg - effects.elastic_load.mass_kg - effects.load_backlash.mass_kg;
    viscous_ = slider.viscous_friction_Ns_per_m + effects.viscous_friction.coefficient_Ns_per_m;
    effects_ = effects;
    half_stroke_ = S(0.5) * stroke_m;
    restitution_ = restitution;
    const S dry = effects.coulomb_friction.force_N + effects.stribeck_friction.coulomb_force_N +
                  absolute(effects.stribeck_friction.extra_force_N) + effects.direction_dependent_friction.forward_N +
                  effects.direction_dependent_friction.backward_N +
                  effects.pressure_dependent_friction.force_per_pressure_N_per_Pa + effects.friction_zone.force_N;
    has_speed_table_ = effects.friction_over_speed.is_there();
    has_place_table_ = effects.force_over_position.is_there();
    has_time_table_ = effects.force_over_time.is_there();
    has_dry_friction_ = has_speed_table_ || any(!(dry == S(0)));
    load_.configure(effects.elastic_load);
    loose_load_.configure(effects.load_backlash);
    has_couplings_ = load_.is_there() || loose_load_.is_there();
    const PeriodicForce<S>& periodic = effects.periodic_force;
    disturbance_.configure(periodic.amplitude_N, periodic.frequency_Hz, periodic.phase_rad);
    is_disturbed_ = disturbance_.is_there();
    has_gravity_ = any(!(effects.gravity_load.sine_N == S(0))) || any(!(effects.gravity_load.cosine_N == S(0)));
    has_bristles_ = any(!(effects.elastic_friction.force_N == S(0)));
    has_presliding_ = has_dry_friction_ && any(effects.presliding.way_m > S(0));
    builds_up_ = has_bristles_ || has_presliding_;
    const PayloadChange<S>& change = effects.payload_change;
    is_timed_ = has_time_table_ || any(!(change.mass_kg == S(0))) || any(!(change.weight_N == S(0)));
    set_time(time_);
  }
  /// Time from the run's start, which steps carry on; reset begins at 0.
  void set_time(const S& time_s) noexcept {
    time_ = time_s;
    const PayloadChange<S>& change = effects_.payload_change;
    const auto changed = time_ >= change.time_s;
    mass_ = own_mass_ + select(changed, change.mass_kg, S(0));
    added_weight_ = select(changed, change.weight_N, S(0));
    if (has_time_table_) added_weight_ += effects_.force_over_time.at(time_);
    inverse_mass_ = S(1) / mass_;
  }
  /// With coupled loads at rest in the middle of their couplings.
  void reset(const S& position_m, const S& velocity_mps) noexcept {
    position_ = position_m;
    velocity_ = velocity_mps;
    if (has_couplings_) load_.reset(position_m, velocity_mps), loose_load_.reset(position_m, velocity_mps);
    if (is_disturbed_) disturbance_.reset();
    bristles_ = S(0);
    sheared_ = S(0);
    if (is_timed_) set_time(S(0));
  }

  /// Dry friction [N] (a magnitude) at speed `speed` in direction sign (+1, -1).
  S dry_friction(const S& speed, const S& sign, const S& x, const SliderSurroundings<S>& around) const noexcept {
    const MotionEffects<S>& e = effects_;
    const S ratio = speed / e.stribeck_friction.velocity_mps;
    const S offset = (x - e.friction_zone.center_m) / e.friction_zone.width_m;
    const S law =
        e.coulomb_friction.force_N + e.stribeck_friction.coulomb_force_N +
        e.stribeck_friction.extra_force_N * exponential(-ratio * ratio) +
        select(sign > S(0), e.direction_dependent_friction.forward_N, e.direction_dependent_friction.backward_N) +
        S(0.5) * e.pressure_dependent_friction.force_per_pressure_N_per_Pa * around.gauge_pressure_sum_Pa +
        e.friction_zone.force_N * exponential(-offset * offset);
    return has_speed_table_ ? maximum(law + e.friction_over_speed.at(speed), S(0)) : law;
  }

  /// Force [N] that is left of a driving force beside the loads at x.
  S less_load(const S& driving_force_N, const S& x) const noexcept {
    const S left = driving_force_N - effects_.constant_force.force_N -
                   effects_.spring_load.stiffness_N_per_m * (x - effects_.spring_load.rest_m);
    S beside = has_gravity_ ? left - effects_.gravity_load.at(x) : left;
    if (has_place_table_) beside -= effects_.force_over_position.at(x);
    return is_timed_ ? beside - added_weight_ : beside;
  }
  /// Force over velocity [N s/m] of all friction that vanishes with the speed, in direction sign (+1, -1; 0: without
  /// what depends on the direction).
  S damping_coefficient(const S& speed, const S& sign) const noexcept {
    const DirectionDependentViscousFriction<S>& own = effects_.direction_dependent_viscous_friction;
    return viscous_ + effects_.quadratic_drag.coefficient_Ns2_per_m2 * speed +
           select(sign > S(0), own.forward_Ns_per_m, select(sign < S(0), own.backward_Ns_per_m, S(0)));
  }

  /// Force [N] of the drive that lets it move at x with v and a, coupled loads going along. Dry friction turns over as
  /// tanh(v/turning_mps); bristles and a periodic force are left out.
  S driving_force_for(const S& x, const S& v, const S& a, const SliderSurroundings<S>& around,
                      double turning_mps) const noexcept {
    const S direction = select(v > S(0), S(1), select(v < S(0), S(-1), S(0))), speed = absolute(v);
    const S carried_kg = mass_ + effects_.elastic_load.mass_kg + effects_.load_backlash.mass_kg;
    S force = carried_kg * a + damping_coefficient(speed, direction) * v - less_load(S(0), x);
    if (has_dry_friction_) {
      const S decay = exponential(S(-2.0 / turning_mps) * speed);
      force += direction * dry_friction(speed, direction, x, around) * (S(1) - decay) / (S(1) + decay);
    }
    return force;
  }

  /// One step of h [s] under the constant driving force [N]. Viscous friction and couplings are trapezoidal, dry
  /// friction is taken at the start speed; the position follows the mean velocity. Dry friction with presliding acts as
  /// bristles do, and holds by what has built up.
  void step(double h_s, const S& driving_force_N, const SliderSurroundings<S>& around) noexcept {
    const S h(h_s), zero(0);
    const S alone =
        less_load(is_disturbed_ ? driving_force_N + disturbance_.value(0.5 * h_s) : driving_force_N, position_);
    const S shearing = has_presliding_ ? shearing_friction(around) : zero;
    const S held_by = builds_up_ ? alone - bristles_ - sheared_ * shearing : alone;
    const S force = has_couplings_ ? held_by + load_.force() + loose_load_.force() : held_by;
    const auto resting = velocity_ == zero;
    const S direction = select(resting, select(force >= zero, S(1), S(-1)), select(velocity_ > zero, S(1), S(-1)));
    const S speed = absolute(velocity_);
    const S dry = jumping_friction(speed, direction, around), holds_most = jumping_friction(zero, direction, around);
    const auto held = resting & (absolute(force) <= holds_most);
    S coefficient = damping_coefficient(speed, direction);
    if (builds_up_) coefficient += S(0.5) * h * built_up_stiffness(direction, shearing);
    const S damping = S(0.5) * h * coefficient * inverse_mass_;
    S pushed = h * (held_by - direction * dry), carried = S(1) + damping;
    if (has_couplings_) {
      const auto load = load_.given(h_s, position_, velocity_), loose = loose_load_.given(h_s, position_, velocity_);
      pushed -= load.free + loose.free;
      carried += (load.by_velocity + loose.by_velocity) * inverse_mass_;
    }
    const S v_free = (velocity_ * (S(1) - damping) + pushed * inverse_mass_) / carried;
    // Dry friction cannot turn the motion round: it ends at rest at the instant where v = 0.
    const auto moving = !resting;
    const auto stops = moving & (v_free * direction <= zero) & (dry > zero);
    const S fraction =
        has_dry_friction_ ? clamp(speed / maximum(absolute(velocity_ - v_free), S(1e-30)), zero, S(1)) : zero;
    const S v_new = select(held | stops, zero, v_free);
    const S moved =
        select(held, zero, select(stops, S(0.5) * fraction * h * velocity_, S(0.5) * h * (velocity_ + v_free)));
    const S start_position = position_, start_velocity = velocity_;
    position_ += moved;
    const S gained = absolute(v_new - velocity_);
    velocity_ = v_new;
    stop_at_ends(gained);
    if (has_couplings_) {
      load_.step(h_s, start_position, start_velocity, position_, velocity_);
      loose_load_.step(h_s, start_position, start_velocity, position_, velocity_);
    }
    if (is_disturbed_) disturbance_.step(h_s);
    if (is_timed_) set_time(time_ + h);
    if (!builds_up_) return;
    if (has_bristles_) bristles_ = effects_.elastic_friction.carried(bristles_, position_ - start_position);
    if (has_presliding_) sheared_ = effects_.presliding.carried(sheared_, position_ - start_position);
  }

  S position() const noexcept { return position_; }
  S velocity() const noexcept { return velocity_; }
  /// Without coupled loads, at the time that has come.
  S mass() const noexcept { return mass_; }

 private:
  /// Dry friction that jumps where the motion turns. Without any its exponentials would cost more than all else here.
  S jumping_friction(const S& speed, const S& direction, const SliderSurroundings<S>& around) const noexcept {
    if (!has_dry_friction_) return S(0);
    const S dry = dry_friction(speed, direction, position_, around);
    return has_presliding_ ? select(effects_.presliding.way_m > S(0), S(0), dry) : dry;
  }
  /// What dry friction with presliding comes to once it has built up.
  S shearing_friction(const SliderSurroundings<S>& around) const noexcept {
    const S dry = dry_friction(absolute(velocity_), select(sheared_ < S(0), S(-1), S(1)), position_, around);
    return select(effects_.presliding.way_m > S(0), dry, S(0));
  }
  /// dF/dx of the friction that the way builds up; with the trapezoidal rule it acts as a damping of half a step of it.
  S built_up_stiffness(const S& direction, const S& shearing) const noexcept {
    const ElasticFriction<S>& own = effects_.elastic_friction;
    return (own.force_N - direction * bristles_) / own.way_m +
           shearing * effects_.presliding.stiffness(sheared_, direction);
  }
  // Inelastic end stop: the way beyond it is travelled back with the reflected speed. A rebound slower than what the
  // force gains in a step would be back before the step ends: it is rest.
  void stop_at_ends(const S& gained) noexcept {
    const S beyond = absolute(position_) - half_stroke_;
    const auto hit = beyond > S(0);
    if (!any(hit)) return;
    const S side = select(position_ > S(0), S(1), S(-1));
    const auto outward = velocity_ * side > S(0);
    const S rebound = -restitution_ * velocity_;
    const auto rests = absolute(rebound) < maximum(gained, S(rest_speed_mps));
    const S back = select(outward & !rests, restitution_ * beyond, S(0));
    position_ = select(hit, side * (half_stroke_ - back), position_);
    velocity_ = select(hit & outward, select(rests, S(0), rebound), velocity_);
  }
  /// Slower rebounds than this are rest: the last bounces of a series that never ends by itself.
  static constexpr double rest_speed_mps = 1e-4;

  S mass_ = S(1), inverse_mass_ = S(1), own_mass_ = S(1), added_weight_{}, time_{}, viscous_{}, half_stroke_ = S(1),
    restitution_{};
  MotionEffects<S> effects_;
  bool has_dry_friction_ = true, has_couplings_ = false, is_disturbed_ = false, has_gravity_ = false,
       has_bristles_ = false, has_presliding_ = false, builds_up_ = false, is_timed_ = false, has_place_table_ = false,
       has_speed_table_ = false, has_time_table_ = false;
  CoupledLoad<S> load_, loose_load_;
  Oscillation<S> disturbance_;
  S position_{}, velocity_{}, bristles_{};
  S sheared_{};  ///< share of the dry friction that presliding has built up, with its sign
};

}  // namespace pneuservo
