// Runs estimator and controller on a recording and compares every output with the recorded one.
#include "loop/replay.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>

#include <fmt/format.h>

#include "loop/course.hpp"
#include "loop/runner.hpp"

namespace pneuservo {
namespace {

// Equal bits; "no value" equals "no value" whatever its payload.
bool same_bits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

double value_of(const Row& row, std::span<const std::string_view> terms, const std::string& column) {
  double out = Row::none;
  Row::visit_all(
      terms,
      [&](std::string_view name, const auto& member) {
        if (name == column) out = static_cast<double>(member);
      },
      row);
  return out;
}

std::string end_of_course(const Rig& rig, const Course& course, double t_s) {
  if (course.fault_tick() >= 0)
    return fmt::format("the loop has a fault at {:.6g} s, which ends a run {:g} s later",
                       static_cast<double>(course.fault_tick()) * rig.period_s, Course::after_fault_s);
  return fmt::format("the config's run ends at {:.6g} s (duration_s)", t_s);
}

}  // namespace

std::vector<std::string> replayed_columns(ControllerKind law) {
  std::vector<std::string> names{
      "p1_estimated_Pa",  "p2_estimated_Pa", "p1_bound_Pa", "p2_bound_Pa", "mass_flow_1_kgps",
      "mass_flow_2_kgps", "p_ref_Pa",        "x_ref_m",     "v_ref_mps",   "v_mps"};
  for (const std::string_view term : law_columns(law)) names.emplace_back(term);
  names.insert(names.end(), {"u_V", "u1_V", "u2_V", "fault"});
  return names;
}

ReplayResult replay_loop(const Rig& rig, Backend& backend, const std::vector<std::int64_t>& ticks,
                         const std::vector<std::uint32_t>& flags, int moves, const LoadPositions& load,
                         const std::vector<std::pair<std::string, const std::vector<double>*>>& recorded,
                         const std::vector<Ppd2GainSet>& gains, const std::vector<AxisCommand>& commands,
                         const LoadLearned& learned) {
  ReplayResult result;
  const std::span<const std::string_view> terms = law_columns(rig.controller.kind);
  for (const auto& [name, values] : recorded) result.compared.push_back(name);
  result.largest_difference.assign(recorded.size(), 0.0);
  result.one_sided.assign(recorded.size(), 0);
  GainMailbox mailbox;
  const auto link = std::make_unique<CommandLink>();
  const auto made = make_control_loop(rig, load, &mailbox, commands.empty() ? nullptr : link.get());
  ControlLoop& loop = *made;
  if (learned) loop.begin_with_learned(learned);
  Course course(rig, moves, 0);
  result.rows.reserve(ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    if ((flags[i] & row_dropped_before) != 0) {
      result.end = fmt::format("rows were dropped before row {}, and what the loop knew there is lost", i);
      break;
    }
    const std::int64_t skipped = i == 0 ? 0 : ticks[i] - ticks[i - 1] - 1;
    if (i < gains.size()) mailbox.post(gains[i]);
    if (i < commands.size() && commands[i].kind != CommandKind::none) link->commands.push(commands[i]);
    if ((flags[i] & row_pass_begins) != 0 && loop.pass_due()) loop.make_pass();  // as it was ready then
    if (!loop.pass(backend, ticks[i], skipped, nullptr, nullptr)) {
      result.end = fmt::format("the loop ended in row {}", i);
      break;
    }
    for (AxisAnswer answer; link->answers.pop(answer);) {}
    const Row& row = loop.row();
    result.rows.push_back(row);
    for (std::size_t c = 0; c < recorded.size(); ++c) {
      const double was = (*recorded[c].second)[i], is = value_of(row, terms, recorded[c].first);
      if (same_bits(was, is)) continue;
      ++result.differing_values;
      if (std::isnan(was) != std::isnan(is)) ++result.one_sided[c];
      else result.largest_difference[c] = std::max(result.largest_difference[c], std::fabs(was - is));
      if (!result.first) result.first = ReplayDifference{i, row.t_s, recorded[c].first, was, is};
    }
    ++result.compared_rows;
    if (!course.after(ticks[i], loop)) {
      if (i + 1 < ticks.size()) result.end = end_of_course(rig, course, row.t_s);
      break;
    }
    if (loop.learning_due()) loop.learn(rig.axis);
  }
  return result;
}

}  // namespace pneuservo
