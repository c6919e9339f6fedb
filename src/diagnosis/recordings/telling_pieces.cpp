// Pieces of long recordings by a D-optimal choice.
#include "diagnosis/recordings/telling_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include "diagnosis/recordings/stretches.hpp"

namespace pneuservo {

namespace {

/// As much as is compared at most. The verdicts on pneumatic machines were calibrated with 9 to 27 s
/// (tools/diagnose-cases on machines with known truth), and more of the same motion narrows no size below what the
/// model itself leaves. A force balance costs little.
constexpr double most_compared_s = 30, most_of_an_axis_s = 300;
/// Long against the 0.35 s in which the gas of a piece finds its state, and with the last second of four held out.
constexpr double piece_s = 6;
/// Motion is looked at in steps of this length, or of the rows: noise of single rows is no motion.
constexpr double step_s = 0.02;
/// Information that is there before the first piece [s]: a thousandth of a piece keeps the determinant positive.
constexpr double prior_s = 1e-3 * piece_s;

enum Signal : std::size_t { time, position, speed, acceleration, drive, signals };
using Signals = std::array<std::vector<double>, signals>;

constexpr Eigen::Index terms = 12;
using Terms = Eigen::Matrix<double, terms, 1>;
using Information = Eigen::Matrix<double, terms, terms>;

double step_of(const Recording& recording) { return std::max(step_s, row_interval_s(recording)); }

/// A column at every step; where it has no value, the last one.
std::vector<double> seen(const Recording& recording, const std::string& column) {
  const std::vector<double>&t = recording.t_s(), &y = recording.column(column);
  std::vector<double> out;
  const double step = step_of(recording);
  double last = 0, next_s = t.front();
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (std::isfinite(y[i])) last = y[i];
    for (; next_s <= t[i]; next_s += step) out.push_back(last);
  }
  return out;
}

std::string drive_column(const Recording& recording) {
  for (const char* name : {"u_V", "u1_V", "F_N"})
    if (recording.has(name)) return name;
  return "x_m";
}

Signals signals_of(const Recording& recording) {
  Signals out;
  out[position] = seen(recording, "x_m");
  out[drive] = seen(recording, drive_column(recording));
  const std::vector<double>& x = out[position];
  const double step = step_of(recording);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double before = x[i - std::min<std::size_t>(i, 1)], after = x[std::min(i + 1, x.size() - 1)];
    out[time].push_back(recording.t_s().front() + step * static_cast<double>(i));
    out[speed].push_back((after - before) / (2 * step));
    out[acceleration].push_back((after - 2 * x[i] + before) / (step * step));
  }
  return out;
}

/// Mean and deviation of each signal over all recordings.
struct Scale {
  std::array<double, signals> mean{}, deviation{};
};

Scale scale_of(const std::vector<Signals>& all) {
  Scale out;
  for (std::size_t s = 0; s < signals; ++s) {
    double count = 1e-300, squares = 0;
    for (const Signals& one : all)
      for (const double value : one[s]) out.mean[s] += value, ++count;
    out.mean[s] /= count;
    for (const Signals& one : all)
      for (const double value : one[s]) squares += std::pow(value - out.mean[s], 2);
    out.deviation[s] = std::max(std::sqrt(squares / count), 1e-12);
  }
  return out;
}

/// What forces, flows and their usual faults depend on, of one instant: offset, drift, stiffness and its bend, damping
/// by direction, dry friction, mass, valve gain by direction, and compression.
Terms terms_at(const Signals& all, const Scale& scale, std::size_t i) {
  const auto relative = [&](Signal s) { return (all[s][i] - scale.mean[s]) / scale.deviation[s]; };
  const double x = relative(position), v = all[speed][i] / scale.deviation[speed], u = relative(drive);
  constexpr double slow = 0.05;  // of the usual speed: there dry friction turns
  Terms out;
  out << 1, relative(time), x, x * x, v, std::abs(v), v / (std::abs(v) + slow), relative(acceleration), u, std::abs(u),
      x * v, u * v;
  return out;
}

/// A piece and what it tells.
struct Piece {
  std::size_t recording;
  TimeSpan span;
  Information information;
  double seconds() const { return span.second - span.first; }
};

std::vector<Piece> pieces_of(const std::vector<Recording>& recordings) {
  std::vector<Signals> all;
  all.reserve(recordings.size());
  for (const Recording& recording : recordings) all.push_back(signals_of(recording));
  const Scale scale = scale_of(all);
  std::vector<Piece> out;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const double from = recordings[r].t_s().front(), length = recordings[r].t_s().back() - from;
    const double count = std::max(1.0, std::round(length / piece_s));
    const std::size_t steps = all[r][time].size();
    for (double i = 0; i < count; ++i) {
      Piece piece{r, {from + length * i / count, from + length * (i + 1) / count - 1e-9}, Information::Zero()};
      const auto end = static_cast<std::size_t>(static_cast<double>(steps) * (i + 1) / count);
      for (auto k = static_cast<std::size_t>(static_cast<double>(steps) * i / count); k < std::min(end, steps); ++k) {
        const Terms t = terms_at(all[r], scale, k);
        piece.information += step_of(recordings[r]) * t * t.transpose();
      }
      out.push_back(std::move(piece));
    }
  }
  return out;
}

double log_determinant(const Information& information) {
  return information.ldlt().vectorD().array().max(1e-300).log().sum();
}

/// One piece after the other, each that which adds most; in order of time.
std::vector<Piece> chosen_of(std::vector<Piece> pieces, double most_s) {
  std::vector<Piece> out;
  Information known = prior_s * Information::Identity();
  double kept_s = 0;
  while (!pieces.empty()) {
    const auto best = std::max_element(pieces.begin(), pieces.end(), [&](const Piece& a, const Piece& b) {
      return log_determinant(known + a.information) < log_determinant(known + b.information);
    });
    if (!out.empty() && kept_s + best->seconds() > 1.001 * most_s) break;
    known += best->information;
    kept_s += best->seconds();
    out.push_back(*best);
    pieces.erase(best);
  }
  std::stable_sort(out.begin(), out.end(), [](const Piece& a, const Piece& b) {
    return std::pair(a.recording, a.span) < std::pair(b.recording, b.span);
  });
  return out;
}

/// Neighbours in one: each start costs the gas 0.35 s to find its state.
std::vector<Piece> joined(const std::vector<Piece>& pieces) {
  std::vector<Piece> out;
  for (const Piece& piece : pieces) {
    const bool is_next =
        !out.empty() && out.back().recording == piece.recording && piece.span.first - out.back().span.second < 1e-6;
    if (is_next) out.back().span.second = piece.span.second;
    else out.push_back(piece);
  }
  return out;
}

double length_of(const Recording& recording) { return recording.t_s().back() - recording.t_s().front(); }

/// Adds recordings of one kind, fitted or held out, whole or in pieces.
void add_pieces(std::vector<Recording> recordings, double most_s, TellingPieces& out) {
  double all_s = 0;
  for (const Recording& recording : recordings) all_s += length_of(recording);
  out.coverage.recorded_s += all_s;
  const auto add = [&](const std::string& path, Recording recording) {
    out.coverage.spans.push_back({path, recording.t_s().front(), recording.t_s().back()});
    out.recordings.push_back(std::move(recording));
  };
  if (all_s <= most_s) {
    for (Recording& recording : recordings) {
      const std::string path = recording.path;
      add(path, std::move(recording));
    }
    return;
  }
  for (const Piece& piece : joined(chosen_of(pieces_of(recordings), most_s)))
    add(recordings[piece.recording].path, part_of(recordings[piece.recording], piece.span));
  out.coverage.choice = fmt::format(
      "one after the other the pieces of {:g} s that add most to what is known of position, speed, acceleration, drive "
      "and time (D-optimal), up to {:g} s",
      piece_s, most_s);
}

}  // namespace

TellingPieces telling_pieces(const Rig& rig, std::vector<Recording> recordings) {
  TellingPieces out;
  const bool can_be_cut = rig.kind != RigKind::vessel && rig.kind != RigKind::switched_cylinder;
  const double most_s = !can_be_cut                        ? std::numeric_limits<double>::infinity()
                        : rig.kind == RigKind::driven_axis ? most_of_an_axis_s
                                                           : most_compared_s;
  std::vector<Recording> held_out;
  for (Recording& recording : recordings)
    if (recording.is_held_out) held_out.push_back(std::move(recording));
  std::erase_if(recordings, [](const Recording& recording) { return recording.is_held_out; });
  add_pieces(std::move(recordings), most_s, out);
  add_pieces(std::move(held_out), most_s, out);
  return out;
}

}  // namespace pneuservo
