// The estimator's figures that a config cannot ask for: wrong starts, and its stated bound with wrong parameters.
#include <catch2/catch.hpp>

#include <cstdio>
#include <functional>

#include <fmt/format.h>

#include "figures/estimator_trial.hpp"

using namespace pneuservo;
using namespace pneuservo::figures;

namespace {

struct NamedTrial {
  const char* name;
  Trial trial;
};

/// What may be wrong by 1 %, with sensor noise; 3 % for the valve, which only the flow correction uses.
const std::array<NamedTrial, 6> wrong_parameters{{{"diameter +1 %", Trial{1.01}},
                                                  {"diameter -1 %", Trial{0.99}},
                                                  {"area +1 %", Trial{1.0, 1.01}},
                                                  {"area -1 %", Trial{1.0, 0.99}},
                                                  {"valve +3 %", Trial{1.0, 1.0, 1.03}},
                                                  {"valve -3 %", Trial{1.0, 1.0, 0.97}}}};
const std::array<std::array<double, 2>, 4> wrong_starts_Pa{
    {{100e3, -100e3}, {-100e3, 100e3}, {100e3, 100e3}, {-100e3, -100e3}}};

/// Within 2 kPa after.
constexpr double asked_start_s = 1.4;
/// The bound with noise alone reaches its figures by little (docs/figures.md says why), and a draw that falls otherwise
/// is no fault.
constexpr double least_noise_holds = 98.8, largest_noise_ratio = 4.1;

/// One realisation has a few hundred independent draws at most, too few for a share of 99 %: seeds are pooled.
TrialOutcome pooled(const std::string& line, const Trial& trial, int seeds) {
  TrialOutcome all;
  for (int seed = 1; seed <= seeds; ++seed) all.add(run_trial(rig_of(line, {fmt::format("seed={}", seed)}), trial));
  return all;
}

/// Worst of the four wrong starts.
double start_s(const std::string& line, PressureSource feedback) {
  double settled_s = 0.0;
  for (const auto& offset : wrong_starts_Pa) {
    const Trial trial{.start_offset_Pa = offset, .feedback = feedback};
    settled_s = std::max(settled_s, run_trial(rig_of(line), trial).settled_s);
  }
  return settled_s;
}

using Show = std::function<void(const char* group, const std::string& what, const std::string& of, double measured,
                                const char* relation, double asked, const char* unit)>;

void each_start(const std::vector<std::string>& lines, const Show& show) {
  for (const auto& line : lines) {
    show("wrong start", line, "2 kPa, estimate in the loop", start_s(line, PressureSource::estimated), "at most",
         asked_start_s, "s");
    show("wrong start", line, "2 kPa, chamber sensors in the loop", start_s(line, PressureSource::chamber), "at most",
         asked_start_s, "s");
  }
}

void each_bound(const std::vector<std::string>& lines, int seeds, const Show& show) {
  TrialOutcome noise_alone;
  for (const auto& line : lines) {
    for (const auto& [name, trial] : wrong_parameters) {
      const TrialOutcome outcome = pooled(line, trial, seeds);
      show("stated bound", fmt::format("{}, {}", line, name), "holds", 100.0 * outcome.held_share(), "at least", 99.0,
           "%");
      // A wrong valve touches the flow correction alone and is hardly an error: no ratio is asked of it.
      if (trial.valve_factor == 1.0)
        show("stated bound", fmt::format("{}, {}", line, name), "median of bound over error", outcome.median_ratio(),
             "at most", 4.0, "");
    }
    noise_alone.add(pooled(line, {}, seeds));
  }
  show("stated bound", "all, noise alone", "holds", 100.0 * noise_alone.held_share(), "at least", 99.0, "%");
  show("stated bound", "all, noise alone", "median of bound over error", noise_alone.median_ratio(), "at most", 4.0,
       "");
}

void check(const char* group, const std::string& what, const std::string& of, double measured, const char* relation,
           double asked, const char*) {
  INFO(group << ": " << what << ": " << of);
  if (what == "all, noise alone" && std::string(relation) == "at most") CHECK(measured <= largest_noise_ratio);
  else if (what == "all, noise alone") CHECK(measured >= least_noise_holds);
  else if (std::string(relation) == "at most") CHECK(measured <= asked);
  else CHECK(measured >= asked);
}

void print(const char* group, const std::string& what, const std::string& of, double measured, const char* relation,
           double asked, const char* unit) {
  fmt::print(R"({{"group":"{}","case":"{}","what":"{}","measured":{},"relation":"{}","asked":{},"unit":"{}"}})"
             "\n",
             group, what, of, measured, relation, asked, unit);
}

const std::vector<std::string> few_lines{"10m-7.65mm", "5m-4.15mm"};
const std::vector<std::string> all_lines(line_names.begin(), line_names.end());

}  // namespace

TEST_CASE("the estimator forgets a start 100 kPa wrong") { each_start(few_lines, check); }

TEST_CASE("the stated bound holds in 99 of 100 ticks and is no more than four times the error") {
  each_bound(few_lines, 2,
             [](auto group, const auto& what, const auto& of, double measured, auto relation, double asked, auto unit) {
               // Two seeds of two lines: noise alone is judged on the nine lines below.
               if (what.find("noise alone") == std::string::npos)
                 check(group, what, of, measured, relation, asked, unit);
             });
}

TEST_CASE("the estimator's figures hold on all nine lines", "[long]") {
  each_start(all_lines, check);
  each_bound(all_lines, 8, check);
}

TEST_CASE("a bound of half the stated one would not hold") {
  TrialOutcome outcome = pooled("10m-7.65mm", wrong_parameters[0].trial, 2);
  for (double& bound_Pa : outcome.bound_Pa) bound_Pa *= 0.5;
  CHECK(outcome.held_share() < 0.97);
}

TEST_CASE("the flow correction calms the estimate of a short wide line") {
  const auto largest_Pa = [](const char* correction) {
    TrialOutcome all;
    for (const char* seed : {"seed=1", "seed=2", "seed=3"})
      all.add(run_trial(rig_of("2m-7.65mm", {seed, correction, "simulation.cells_per_m=10"}), {}));
    return all.largest_error_Pa;
  };
  const double with_Pa = largest_Pa("estimator.flow_correction=0.2");
  CHECK(with_Pa < 1200.0);
  CHECK(with_Pa < 0.7 * largest_Pa("estimator.flow_correction=0"));
}

// What tools/figures prints; not tests.
TEST_CASE("figures of all lines as JSON", "[.table]") {
  each_start(all_lines, print);
  each_bound(all_lines, 8, print);
}
TEST_CASE("figures of a few lines as JSON", "[.table-short]") { each_start(few_lines, print); }
