// Learning of a command over repeated moves.
#include <algorithm>
#include <cmath>
#include <utility>

#include <pneuservo/control/repeated_move.hpp>

#include "control/inverse_response.hpp"
#include "control/move_record.hpp"

namespace pneuservo {

RepeatedMove::RepeatedMove(std::vector<double> response_m_per_V, std::vector<double> window, double period_s,
                           double most_V, std::uint64_t identity)
    : response_m_per_V_(std::move(response_m_per_V)), window_(std::move(window)), learned_V_(window_.size(), 0.0),
      best_V_(learned_V_), error_m_(window_.size(), not_recorded), period_s_(period_s), most_V_(most_V),
      identity_(identity), is_on_(!learned_V_.empty()) {}

void RepeatedMove::begin_with(std::vector<double> learned_V) {
  learned_V.resize(learned_V_.size(), 0.0);
  for (double& value : learned_V) value = std::isfinite(value) ? std::clamp(value, -most_V_, most_V_) : 0.0;
  learned_V_ = best_V_ = std::move(learned_V);
}

double RepeatedMove::error_rms_m() const noexcept {
  double sum = 0.0, weight = 0.0;
  for (std::size_t k = 0; k < error_m_.size(); ++k) {
    sum += window_[k] * error_m_[k] * error_m_[k];
    weight += window_[k];
  }
  return weight > 0.0 ? std::sqrt(sum / weight) : 0.0;
}

void RepeatedMove::learn() {
  if (progress_.has_stopped) return;
  if (!fill_skipped(error_m_)) {
    ++progress_.moves_not_learned;
    error_m_.assign(error_m_.size(), not_recorded);
    return;
  }
  std::vector<double>& errors_m = progress_.error_rms_m;
  errors_m.push_back(error_rms_m());
  const std::size_t move = errors_m.size() - 1;
  if (move == 0 || errors_m[move] < errors_m[progress_.best]) progress_.best = move, best_V_ = learned_V_;
  progress_.has_stopped = errors_m[move] > errors_m.front() || move - progress_.best >= patience_moves;
  if (progress_.has_stopped) {
    learned_V_ = best_V_;
    return;
  }
  for (std::size_t k = 0; k < error_m_.size(); ++k) error_m_[k] *= window_[k];
  const std::vector<double> missing_V =
      InverseResponse(response_m_per_V_, error_m_.size(), period_s_).input_for(error_m_, learned_Hz);
  for (std::size_t k = 0; k < learned_V_.size(); ++k)
    learned_V_[k] = window_[k] * std::clamp(learned_V_[k] + share * missing_V[k], -most_V_, most_V_);
  error_m_.assign(error_m_.size(), not_recorded);
}

}  // namespace pneuservo
