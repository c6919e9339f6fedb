// A tube: compressible flow with wall friction and heat, by a discontinuous Galerkin spectral element method.
#pragma once

#include "gas.hpp"

#include <array>
#include <cstddef>
#include <vector>

namespace proof {

struct TubeData {
  double length_m = 1.0, diameter_m = 0.006, wall_K = 293.0;
  double memory_share = 0.0;     // of the losses that depend on frequency; 1: theory of the laminar layers
  double swelling_per_Pa = 0.0;  // relative growth of the bore with pressure
  double leak_m2 = 0.0, leak_place = 0.5;
  double critical_ratio = 0.35;  // of the leak
  double least_nusselt = 3.66;   // laminar flow, wall of constant temperature
  double refine = 1.0;           // more elements, for grid studies
};

/// What crosses an end, positive along the tube (from the valve to the chamber).
struct EndFlow {
  double mass = 0.0, momentum = 0.0, energy = 0.0;  // kg/s, N, W
  double pressure_Pa = 0.0;                         // static, in the end plane
};

/// Elements with four Gauss-Lobatto nodes. Volume terms are the split form of Kennedy and Gruber (Gassner, Winters and
/// Kopriva 2016), so that no kinetic energy is made by aliasing; between elements an acoustic Riemann flux.
class Tube {
 public:
  static constexpr int nodes = 4;

  Tube(const Gas& gas, const TubeData& data);

  std::size_t points() const { return points_; }
  std::size_t size() const { return 3 * points_; }  // of the state: densities of mass, momentum, energy
  double area_m2() const { return area_; }
  double element_m() const { return element_; }
  const TubeData& data() const { return data_; }

  void fill(double* state, double pressure_Pa, double temperature_K) const;
  /// Speed of the fastest wave in m/s.
  double fastest(const double* state) const;
  double mass_kg(const double* state) const;
  double energy_J(const double* state) const;
  double pressure_at(const double* state, std::size_t point) const;

  /// Prepares what the ends and the rates need of a state.
  void look(const double* state);
  /// The gas beside an end: 0 at the valve, 1 at the chamber.
  struct Beside {
    double density, speed_mps, pressure_Pa, stagnation_K, sound_mps;
  };
  Beside beside(int end) const;
  /// Flow over an end whose static pressure is `pressure_Pa`; what enters has the stagnation temperature `outside_K`.
  EndFlow end_flow(int end, double pressure_Pa, double outside_K) const;
  void rates(const EndFlow& first, const EndFlow& last, double* out) const;
  /// Kept over a step: heat transfer of the walls, and the memory of the layers.
  void begin_step(const double* state);
  void end_step(const double* state, double dt);

 private:
  void volume_terms(double* out) const;
  void surface_terms(const EndFlow& first, const EndFlow& last, double* out) const;
  void wall_terms(double* out) const;
  void leak_terms(double* out) const;
  std::array<double, 3> between(std::size_t left, std::size_t right) const;

  Gas gas_;
  TubeData data_;
  std::size_t elements_, points_;
  double area_, element_;
  std::array<std::array<double, nodes>, nodes> derivative_{};
  std::vector<double> rho_, u_, p_, e_, t_;  // per point, of the state looked at
  std::vector<double> heat_W_per_m3K_, drag_, cooling_, speed_before_, temperature_before_;
  static constexpr int terms = 5;
  std::array<std::vector<double>, terms> layer_u_, layer_t_;
};

}  // namespace proof
