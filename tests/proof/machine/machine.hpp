// The machine between command and motion: valve, tubes, chambers and slider as one system in time, events cut exactly.
#pragma once

#include "machine_data.hpp"

#include <utility>
#include <vector>

namespace proof {

/// Classical Runge-Kutta steps; a step that contains a reversal, a release or an end stop is cut at that instant.
class Machine {
 public:
  explicit Machine(const MachineData& data);

  void start(double position_m, double pressure_1_Pa, double pressure_2_Pa);
  /// What the valve's electronics are given from now on.
  void command(double volt);
  /// Goes on by this time; the command stays.
  void advance(double seconds);

  double time_s() const { return time_; }
  double position_m() const { return state_[at_x_]; }
  double speed_mps() const { return state_[at_x_ + 1]; }
  double chamber_Pa(int side) const;
  double port_Pa(int side) const { return port_Pa_[static_cast<std::size_t>(side)]; }
  double supply_Pa() const { return valve_supply_Pa(state_.data(), time_); }
  /// Mass of all gas between the valve's ports and the piston, kg, and its energy with that of the walls' heat, J.
  double gas_kg() const;
  double gas_J() const;
  /// What came in through the valve's ports and left by leaks since the start.
  double gained_kg() const { return state_[at_book_]; }
  double gained_J() const { return state_[at_book_ + 1]; }
  double longest_step_s() const;

 private:
  enum class Mode { sliding, resting };
  struct PortFlow {
    EndFlow into_tube;
    double valve_kg_per_s, valve_W;
  };

  void rates(const double* y, double t, double* out);
  PortFlow port(const double* y, double t, std::size_t side, double spool, double* out);
  EndFlow chamber_end(const double* y, std::size_t side, double x);
  void chamber_rates(const double* y, std::size_t side, const EndFlow& in, double* out);
  void supply_rates(const double* y, double t, double drawn, double blown, double* out) const;
  void piston_leak_rates(const double* y, double* out) const;
  void spool_rates(const double* y, double* out) const;
  void slider_rates(const double* y, double t, double* out) const;
  double through_edges(const double* y, double t, std::size_t side, double spool, double p, double gas_K,
                       double* from_supply, double* to_exhaust) const;
  double port_pressure_without_volume(const double* y, double t, std::size_t side, double spool);
  double opening_m2(std::size_t side, double x, bool out_of_chamber) const;
  double area_of(double volt, double t) const;
  double spool_V(const double* y) const;
  double chamber_Pa(const double* y, std::size_t side) const;
  double chamber_K(const double* y, std::size_t side) const;
  double volume_m3(std::size_t side, double x) const;
  double valve_supply_Pa(const double* y, double t) const;
  double exhaust_Pa(const double* y) const;
  double mass_kg(double t) const;
  double push_N(const double* y, double t) const;  // all forces but the dry friction of a direction
  double dry_N(const double* y, double t, double speed, int direction) const;
  bool has_dry_friction() const;

  void runge_kutta(const std::vector<double>& from, double dt, std::vector<double>& to);
  double event(const std::vector<double>& y, double t) const;  // above zero before, below after
  void step(double dt);
  void cut_at_event(double dt);
  void obey_event();
  void judge_rest();
  void book_ports();

  MachineData data_;
  std::array<Tube, 2> tubes_;
  std::array<std::size_t, 2> at_tube_{}, at_port_{}, at_chamber_{};
  std::size_t at_supply_ = 0, at_exhaust_ = 0, at_spool_ = 0, at_x_ = 0, at_bristle_ = 0, at_tail_ = 0, at_book_ = 0,
              size_ = 0;
  std::vector<double> state_, next_, trial_, k1_, k2_, k3_, k4_;
  std::array<double, 2> port_Pa_{};
  double time_ = 0.0, command_ = 0.0, played_ = 0.0;
  Mode mode_ = Mode::resting;
  int direction_ = 1, stop_ = 0;  // of sliding; of the end stop that is touched
  bool regulator_open_ = true;
};

}  // namespace proof
