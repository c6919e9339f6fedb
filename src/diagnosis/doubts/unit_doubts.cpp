// Units and zeros of pressures, command and position as hypotheses.
#include "diagnosis/doubts/unit_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pneuservo/rig/possible_values.hpp>

#include "config/input_error.hpp"
#include "diagnosis/doubts/channel_doubts.hpp"
#include "diagnosis/doubts/misfits.hpp"
#include "diagnosis/doubts/opening_balance.hpp"
#include "diagnosis/doubts/wiring_doubts.hpp"
#include "diagnosis/recordings/stretches.hpp"

namespace pneuservo {

namespace {

enum class Quantity { pressures, command, position };

/// How one group of channels may be meant.
struct ReadingsOf {
  Quantity quantity;
  std::vector<std::string> columns;
  std::vector<UnitReading> readings;
};

using Kinds = std::vector<ReadingsOf>;

bool is_as_recorded(const UnitReading& reading) { return reading.factor == 1 && reading.offset == 0; }

/// One reading of each kind.
using Choice = std::vector<std::size_t>;

std::vector<Choice> choices_of(const Kinds& kinds) {
  std::vector<Choice> out{{}};
  for (const ReadingsOf& kind : kinds) {
    std::vector<Choice> longer;
    for (const Choice& choice : out)
      for (std::size_t i = 0; i < kind.readings.size(); ++i) {
        longer.push_back(choice);
        longer.back().push_back(i);
      }
    out = std::move(longer);
  }
  return out;
}

Recording read_as(const Kinds& kinds, const Choice& choice, Recording recording) {
  for (std::size_t k = 0; k < kinds.size(); ++k)
    for (const std::string& column : kinds[k].columns) apply_reading(kinds[k].readings[choice[k]], recording, column);
  return recording;
}

bool needs_fit(const Kinds& kinds, const Choice& choice) {
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (kinds[k].readings[choice[k]].needs_fit) return true;
  return false;
}

/// Whether a map states another unit or zero than SI for the columns: somebody knew.
bool is_stated(const Recording& recording, const ReadingsOf& of) {
  const ImportedColumn source = source_of(recording, of.columns.front());
  return source.factor != 1 || source.offset != 0;
}

bool has_as_recorded(const ReadingsOf& of) {
  return std::any_of(of.readings.begin(), of.readings.end(), is_as_recorded);
}

std::string name_of(const UnitReading& reading) { return reading.name.empty() ? "as recorded" : reading.name; }

/// Factors and offsets.
using Ways = std::set<std::pair<double, double>>;

/// What a choice supposes: kinds of readings beside as recorded, those of all pressures, settled ones too, counted
/// once; then how many groups of channels are read so.
using Suppositions = std::pair<std::size_t, std::size_t>;

Suppositions suppositions_of(const Kinds& kinds, const Choice& choice, Ways ways) {
  std::size_t others = 0, groups = 0;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const UnitReading& reading = kinds[k].readings[choice[k]];
    if (kinds[k].quantity == Quantity::pressures) ways.emplace(reading.factor, reading.offset);
    else others += !is_as_recorded(reading);
    groups += !is_as_recorded(reading);
  }
  const bool are_as_recorded = ways.empty() || (ways.size() == 1 && ways.contains({1.0, 0.0}));
  return {others + ways.size() + !are_as_recorded, groups};
}

/// Of some choices those that suppose least: what is as recorded stays so where it fits as well.
std::vector<std::size_t> fewest_suppositions(const Kinds& kinds, const std::vector<Choice>& choices,
                                             const Ways& settled, std::vector<std::size_t> some) {
  Suppositions fewest = suppositions_of(kinds, choices[some.front()], settled);
  for (const std::size_t i : some) fewest = std::min(fewest, suppositions_of(kinds, choices[i], settled));
  std::erase_if(some, [&](std::size_t i) { return suppositions_of(kinds, choices[i], settled) > fewest; });
  return some;
}

/// The first kind that two choices read otherwise.
std::size_t first_difference(const Choice& a, const Choice& b) {
  return static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin()).first - a.begin());
}

/// What the range of columns says, as recorded.
std::string evidence_of(const Rig& rig, const Recording& recording, Quantity quantity,
                        const std::vector<std::string>& columns) {
  double low = infinite_misfit, high = -infinite_misfit;
  for (const std::string& column : columns) {
    const auto [lowest, highest] = quantiles(recording.column(column), lowest_share, highest_share);
    low = std::min(low, lowest), high = std::max(high, highest);
  }
  const std::string range = fmt::format("{}: {} go{} from {:.4g} to {:.4g}", recording.path, fmt::join(columns, ", "),
                                        columns.size() == 1 ? "es" : "", low, high);
  switch (quantity) {
    case Quantity::command: {
      const std::string unit = stated_command_unit(recording);
      return fmt::format("{} {}, the valve takes +-{:g} V", range,
                         unit == "%" || unit == "mA" ? fmt::format("in {}, which the file states", unit) : "V",
                         rig.axis.valve.command_max_V);
    }
    case Quantity::position:
      return fmt::format("{} m, the stroke is +-{:g} m", range, 0.5 * rig.axis.cylinder.stroke_m);
    case Quantity::pressures: break;
  }
  const PossibleRange possible = possible_pressure_Pa(rig);
  return fmt::format("{} Pa, possible are {:.0f} to {:.0f} Pa absolute", range, possible.lowest, possible.highest);
}

bool are_whole(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == std::round(v) || std::isnan(v); });
}

/// Pressures by the kind of their sensors: whoever buys gauge sensors buys them for all ports.
std::vector<std::vector<std::string>> by_sensors(const Recording& recording) {
  std::vector<std::vector<std::string>> out(3);
  for (const std::string& column : pressure_columns(recording)) {
    const Signal signal = *signal_of_column(column);
    out[is_port(signal) ? 0 : is_chamber(signal) ? 1 : 2].push_back(column);
  }
  std::erase_if(out, [](const auto& columns) { return columns.empty(); });
  return out;
}

/// What the recording's channels may be meant as; throws where a kind has no reading.
Kinds possible_readings(const Rig& rig, const Recording& recording) {
  const auto has = [&](const std::string& column) {
    return recording.has(column) && has_value(recording.column(column));
  };
  Kinds out;
  for (const std::vector<std::string>& pressures : by_sensors(recording))
    out.push_back({Quantity::pressures, pressures, pressure_readings(rig, recording, pressures)});
  if (has("u_V")) out.push_back({Quantity::command, {"u_V"}, command_readings(rig, recording)});
  if (has("x_m")) out.push_back({Quantity::position, {"x_m"}, position_zeros(rig, recording)});
  for (const ReadingsOf& kind : out)
    if (kind.readings.empty())
      throw InputError(
          fmt::format("{}, expected that: {}? State it, as SI = factor x value + offset: "
                      "import: {{columns: {{{}: {{column: \"{}\", factor: ..., offset: ...}}}}}}",
                      evidence_of(rig, recording, kind.quantity, kind.columns),
                      are_whole(recording.column(kind.columns.front())) ? "counts of a converter" : "in which unit",
                      kind.columns.front(), source_of(recording, kind.columns.front()).column));
  return out;
}

/// One way to judge, and of what.
struct Judge {
  double (*misfit_of)(const Rig&, const Recording&);
  bool judges_command;
  double decisive;  ///< of the misfit as recorded, that another reading must come down to
  double doubtful;  ///< misfit as recorded below which nothing is doubted
  double fitting;   ///< misfit that a reading must stay below to be taken
  bool is_last;     ///< then a tie is asked for
};

/// Readings differ by a factor of 6.9, 10 or 1000, or by an atmosphere.
constexpr double decisive = 0.4;
/// Where both tell: on 52 recordings of machines with faults an atmosphere too much or too little left 0.99 times what
/// the right one left, or more, and with channels reversed or exchanged 0.79 times what is so as recorded.
constexpr double decisive_together = 0.6;

/// The one opening of both sides first, for no effect of the valve, of a leak or of the motion disturbs it; then the
/// opening that the command asks for; then both together; then all by simulation. Sides that are wired wrongly fit no
/// reading: on the 52 recordings the right one left 0.14 at most.
constexpr Judge judges[] = {{&sides_misfit, false, decisive, 0, doubtful, false},
                            {&gas_misfit, true, decisive, 0, own_swing, false},
                            {&opening_misfit, false, decisive_together, 0, doubtful, false},
                            {&port_misfit, true, decisive, doubtful, own_swing, true}};

std::vector<double> misfits_of(const Rig& rig, const Recording& judged, const Kinds& kinds,
                               const std::vector<Choice>& choices, const Judge& judge) {
  std::vector<double> out;
  for (const Choice& choice : choices) {
    const double misfit = judge.misfit_of(rig, read_as(kinds, choice, judged));
    out.push_back(needs_fit(kinds, choice) && !(misfit < own_swing) ? infinite_misfit : misfit);
  }
  return out;
}

/// Of the choices that fit about as well as the best one, the one that keeps what is stated, else the one that supposes
/// least; throws where that leaves two.
std::size_t one_of_fitting(const Rig& rig, const Recording& recording, const Kinds& kinds,
                           const std::vector<Choice>& choices, const Ways& settled,
                           const std::vector<std::size_t>& fitting, std::vector<std::string>& notes) {
  std::vector<std::size_t> as_stated;
  std::copy_if(fitting.begin(), fitting.end(), std::back_inserter(as_stated), [&](std::size_t i) {
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (is_stated(recording, kinds[k]) && !is_as_recorded(kinds[k].readings[choices[i][k]])) return false;
    return true;
  });
  const bool is_by_statement = as_stated.size() == 1;
  const auto left = is_by_statement
                        ? as_stated
                        : fewest_suppositions(kinds, choices, settled, as_stated.empty() ? fitting : as_stated);
  const std::size_t taken = left.front();
  const std::size_t other = left.size() > 1 ? left[1] : fitting[0] == taken ? fitting[1] : fitting[0];
  const std::size_t k = first_difference(choices[other], choices[taken]);
  const UnitReading &one = kinds[k].readings[choices[taken][k]], &another = kinds[k].readings[choices[other][k]];
  const std::string evidence = evidence_of(rig, recording, kinds[k].quantity, kinds[k].columns);
  if (left.size() != 1)
    throw InputError(fmt::format("{}: {} or {}? State it: {}", evidence, name_of(one), name_of(another),
                                 stated_reading(recording, kinds[k].columns.front(), one)));
  const bool is_twice = another.offset != 0 && source_of(recording, kinds[k].columns.front()).offset != 0;
  if (!is_twice)  // a zero that was stated already is no second reading
    notes.push_back(fmt::format("{}: taken {}; {} would fit as well", evidence,
                                is_by_statement ? "as stated" : name_of(one), name_of(another)));
  return taken;
}

std::optional<std::size_t> as_recorded_of(const Kinds& kinds, const std::vector<Choice>& choices) {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    bool is_so = true;
    for (std::size_t k = 0; k < kinds.size(); ++k) is_so = is_so && is_as_recorded(kinds[k].readings[choices[i][k]]);
    if (is_so) return i;
  }
  return std::nullopt;
}

/// Readings by kind; empty: not decided.
using Decided = std::vector<std::optional<std::size_t>>;

/// What all choices agree on that fit about as well as the best one. Where as recorded is not among them, the last
/// judge chooses.
Decided decided(const Rig& rig, const Recording& recording, const Kinds& kinds, const Ways& settled, const Judge& judge,
                std::vector<std::string>& notes) {
  const std::vector<Choice> choices = choices_of(kinds);
  if (choices.size() == 1) return {choices.front().begin(), choices.front().end()};
  const Recording judged = most_moving_part(recording, judged_s);
  const std::optional<std::size_t> as_recorded = as_recorded_of(kinds, choices);
  if (as_recorded && judge.doubtful > 0 && judge.misfit_of(rig, judged) < judge.doubtful) return Decided(kinds.size());
  const std::vector<double> misfits = misfits_of(rig, judged, kinds, choices, judge);
  const double best = *std::min_element(misfits.begin(), misfits.end());
  std::vector<std::size_t> fitting;
  for (std::size_t i = 0; i < misfits.size(); ++i)
    if (!(best < judge.decisive * misfits[i])) fitting.push_back(i);
  if (!(best < judge.fitting) && (as_recorded || !judge.is_last)) return Decided(kinds.size());
  const bool as_recorded_fits = as_recorded && std::count(fitting.begin(), fitting.end(), *as_recorded) > 0;
  if (judge.is_last && !as_recorded_fits) {
    const std::size_t one =
        fitting.size() == 1 ? fitting[0] : one_of_fitting(rig, recording, kinds, choices, settled, fitting, notes);
    return {choices[one].begin(), choices[one].end()};
  }
  Decided out(kinds.size());
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (std::all_of(fitting.begin(), fitting.end(), [&](auto i) { return choices[i][k] == choices[fitting[0]][k]; }))
      out[k] = choices[fitting[0]][k];
  return out;
}

/// Pressures whose sensors are of several kinds, in SI as recorded. Channels that are exchanged look so, too.
bool are_mixed(const Kinds& kinds, const std::vector<UnitReading>& taken) {
  Ways ways;
  for (std::size_t k = 0; k < kinds.size(); ++k)
    if (kinds[k].quantity == Quantity::pressures) ways.emplace(taken[k].factor, taken[k].offset);
  return ways.size() > 1 && ways.contains({1.0, 0.0});
}

/// Applied, and told: groups of pressures that are read alike in one sentence.
void take(const Rig& rig, Recording& recording, const Kinds& kinds, const std::vector<UnitReading>& taken,
          std::vector<std::string>& notes) {
  if (std::all_of(taken.begin(), taken.end(), [](const UnitReading& one) { return is_as_recorded(one); })) return;
  const Recording as_recorded = recording;
  std::vector<char> is_told(kinds.size(), false);
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (is_told[k] || is_as_recorded(taken[k])) continue;
    std::vector<std::string> columns;
    for (std::size_t other = k; other < kinds.size(); ++other) {
      const bool is_alike = kinds[other].quantity == kinds[k].quantity && taken[other].factor == taken[k].factor &&
                            taken[other].offset == taken[k].offset;
      if (!is_alike) continue;
      is_told[other] = true;
      columns.insert(columns.end(), kinds[other].columns.begin(), kinds[other].columns.end());
    }
    for (const std::string& column : columns) apply_reading(taken[k], recording, column);
    notes.push_back(fmt::format("{}: taken for {}; to state it: {}",
                                evidence_of(rig, as_recorded, kinds[k].quantity, columns), taken[k].name,
                                stated_sources(recording, columns)));
  }
}

}  // namespace

void doubt_units(const Rig& rig, Recording& recording, std::vector<std::string>& notes) {
  if (rig.kind != RigKind::cylinder) return;
  const Kinds kinds = possible_readings(rig, recording);
  std::vector<UnitReading> taken(kinds.size());
  std::vector<char> is_settled(kinds.size(), false);
  Recording read = recording;
  Ways settled;
  for (const Judge& judge : judges) {
    std::vector<std::size_t> of;
    Kinds judged;
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (!is_settled[k] && (judge.judges_command || kinds[k].quantity != Quantity::command))
        of.push_back(k), judged.push_back(kinds[k]);
    const Decided found = decided(rig, read, judged, settled, judge, notes);
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (!found[i]) continue;
      taken[of[i]] = judged[i].readings[*found[i]], is_settled[of[i]] = true;
      if (judged[i].quantity == Quantity::pressures) settled.emplace(taken[of[i]].factor, taken[of[i]].offset);
      for (const std::string& column : judged[i].columns) apply_reading(taken[of[i]], read, column);
    }
  }
  if (are_mixed(kinds, taken) && is_rather_rewired(rig, recording, read))
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (kinds[k].quantity == Quantity::pressures && has_as_recorded(kinds[k])) taken[k] = {};
  take(rig, recording, kinds, taken, notes);
}

}  // namespace pneuservo
