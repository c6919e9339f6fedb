// Prints a hash of every number that the estimator gives on drawn machines and pressures: one for every processor and
// build, for nothing in it depends on the compiler, the instruction set or the mathematical library.
#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include <pneuservo/core/random.hpp>
#include <pneuservo/estimator/pipeline_estimator.hpp>

using namespace pneuservo;

namespace {

EstimatorParameters drawn_machine(Random& random) {
  EstimatorParameters parameters;
  parameters.supply_pressure_Pa = random.uniform(5e5, 9e5);
  parameters.line_1.length_m = random.uniform(0.5, 15.0);
  parameters.line_1.diameter_m = random.uniform(0.003, 0.010);
  parameters.line_2.length_m = random.uniform(0.5, 15.0);
  parameters.line_2.diameter_m = random.uniform(0.003, 0.010);
  parameters.cylinder.stroke_m = random.uniform(0.1, 0.5);
  parameters.cylinder.area_1_m2 = random.uniform(3e-4, 2e-3);
  parameters.cylinder.area_2_m2 = random.uniform(3e-4, 2e-3);
  parameters.cylinder.dead_volume_1_m3 = random.uniform(1e-5, 5e-5);
  parameters.cylinder.dead_volume_2_m3 = random.uniform(1e-5, 5e-5);
  parameters.cylinder.wall_heat_W_per_m2K = random.uniform(20.0, 100.0);
  return parameters;
}

// FNV-1a over the bits of each number.
class Hash {
 public:
  void take(double value) noexcept {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int i = 0; i < 8; ++i) hash_ = (hash_ ^ (bits >> (8 * i) & 0xFF)) * 0x100000001B3ULL;
  }
  std::uint64_t value() const noexcept { return hash_; }

 private:
  std::uint64_t hash_ = 0xCBF29CE484222325ULL;
};

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t seed = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1;
  constexpr int machines = 20, ticks = 1000;
  Random random(seed);
  Hash hash;
  double seconds = 0.0;
  for (int machine = 0; machine < machines; ++machine) {
    const EstimatorParameters parameters = drawn_machine(random);
    PipelineEstimator estimator;
    estimator.configure(parameters);
    double p_Pa[2] = {4e5, 4e5}, x_m = 0.0;
    for (int k = 0; k < ticks; ++k) {
      for (double& p : p_Pa) p = std::clamp(p + random.uniform(-3e3, 3e3), 1.5e5, parameters.supply_pressure_Pa);
      const double v_mps = random.uniform(-0.3, 0.3);
      x_m = std::clamp(x_m + 1e-3 * v_mps, -0.4 * parameters.cylinder.stroke_m, 0.4 * parameters.cylinder.stroke_m);
      const auto begin = std::chrono::steady_clock::now();
      const EstimatorOutput out = estimator.step({p_Pa[0], p_Pa[1], x_m, v_mps});
      seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      for (int i : {0, 1}) {
        hash.take(out.chamber_pressure_Pa[i]);
        hash.take(out.error_bound_Pa[i]);
        hash.take(out.mass_flow_kgps[i]);
      }
    }
  }
  std::printf("%016llx\n", static_cast<unsigned long long>(hash.value()));
  std::fprintf(stderr, "%.0f ns a tick\n", 1e9 * seconds / (machines * ticks));
  return 0;
}
