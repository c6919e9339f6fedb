// The machine in time: Runge-Kutta steps, cut where the slider reverses, lets go or meets an end stop.
#include "machine.hpp"

namespace proof {

double Machine::longest_step_s() const {
  double step = 1e-3;
  // Four Gauss-Lobatto nodes and classical Runge-Kutta are stable up to 0.24 elements a step (measured by the check).
  for (std::size_t s = 0; s < 2; ++s)
    step = std::min(step, 0.2 * tubes_[s].element_m() / tubes_[s].fastest(state_.data() + at_tube_[s]));
  for (const SideData& side : data_.side)
    if (side.port_m3 > 0.0) {
      const double bore = side.tube.diameter_m * side.tube.diameter_m * 0.785;
      step =
          std::min(step, 1.2 * side.port_m3 / (bore * 400.0));  // the port's volume empties into the tube's impedance
    }
  const MotionData& m = data_.motion;
  const double stiff = std::max(m.bristle_N > 0.0 ? m.bristle_N / m.bristle_m : 0.0, m.bumper_N_per_m);
  if (stiff > 0.0) step = std::min(step, 0.8 / std::sqrt(stiff / (m.mass_kg - m.tail_kg)));
  if (data_.valve.frequency_Hz > 0.0) step = std::min(step, 0.15 / data_.valve.frequency_Hz);
  if (data_.valve.lag_s > 0.0) step = std::min(step, 1.0 * data_.valve.lag_s);
  return step;
}

void Machine::runge_kutta(const std::vector<double>& from, double dt, std::vector<double>& to) {
  const auto along = [&](const std::vector<double>& k, double h) {
    for (std::size_t i = 0; i < size_; ++i) trial_[i] = from[i] + h * k[i];
  };
  rates(from.data(), time_, k1_.data());
  along(k1_, dt / 2.0);
  rates(trial_.data(), time_ + dt / 2.0, k2_.data());
  along(k2_, dt / 2.0);
  rates(trial_.data(), time_ + dt / 2.0, k3_.data());
  along(k3_, dt);
  rates(trial_.data(), time_ + dt, k4_.data());
  for (std::size_t i = 0; i < size_; ++i) to[i] = from[i] + dt / 6.0 * (k1_[i] + 2.0 * k2_[i] + 2.0 * k3_[i] + k4_[i]);
}

/// Above zero until something happens: sliding, what is left to a reversal or to an end stop; at rest, to letting go.
double Machine::event(const std::vector<double>& y, double t) const {
  const double x = y[at_x_], v = y[at_x_ + 1], half = data_.motion.stroke_m / 2.0;
  if (mode_ == Mode::sliding) {
    double left = half - std::abs(x);
    if (stop_ != 0 && v * stop_ <= 0.0) left = half + stop_ * x + 1e-9;  // leaves the stop that it has just met
    if (has_dry_friction() && direction_ * v < left) left = direction_ * v;
    return left;
  }
  const double push = push_N(y.data(), t);
  const int way = push > 0.0 ? 1 : -1;
  if (stop_ == way) return 1.0;  // held by the stop
  return dry_N(y.data(), t, 0.0, way) - std::abs(push);
}

void Machine::cut_at_event(double dt) {
  double low = 0.0, high = dt;
  for (int i = 0; i < 40 && high - low > 1e-12; ++i) {
    const double middle = 0.5 * (low + high);
    runge_kutta(state_, middle, next_);
    (event(next_, time_ + middle) > 0.0 ? low : high) = middle;
  }
  runge_kutta(state_, high, next_);
  time_ += high;
  state_ = next_;
  obey_event();
}

void Machine::judge_rest() {
  const double push = push_N(state_.data(), time_);
  const int way = push > 0.0 ? 1 : -1;
  state_[at_x_ + 1] = 0.0;
  const bool held = stop_ == way || (has_dry_friction() && std::abs(push) <= dry_N(state_.data(), time_, 0.0, way));
  mode_ = held ? Mode::resting : Mode::sliding;
  direction_ = way;
}

void Machine::obey_event() {
  double& x = state_[at_x_];
  double& v = state_[at_x_ + 1];
  const double half = data_.motion.stroke_m / 2.0;
  if (mode_ == Mode::sliding && std::abs(x) >= half - 1e-10 && x * v > 0.0) {
    stop_ = x > 0.0 ? 1 : -1;
    x = stop_ * half;
    v *= -data_.motion.restitution;
    direction_ = -stop_;
    if (std::abs(v) < 2e-3) judge_rest();  // slower than that it stays
    return;
  }
  if (std::abs(x) < half - 1e-6) stop_ = 0;
  judge_rest();
}

void Machine::step(double dt) {
  for (std::size_t s = 0; s < 2; ++s) tubes_[s].begin_step(state_.data() + at_tube_[s]);
  const double begin = time_;
  const SupplyData& supply = data_.supply;
  if (supply.regulator_gap_Pa > 0.0) {
    if (state_[at_supply_] < supply.pressure_Pa - supply.regulator_gap_Pa / 2.0) regulator_open_ = true;
    if (state_[at_supply_] > supply.pressure_Pa + supply.regulator_gap_Pa / 2.0) regulator_open_ = false;
  }
  runge_kutta(state_, dt, next_);
  if (event(next_, time_ + dt) <= 0.0) {
    // What lies on the wrong side from the start (a load that jumped) is obeyed at once.
    if (event(state_, time_) <= 0.0 && mode_ == Mode::resting) judge_rest();
    cut_at_event(dt);
  } else {
    state_.swap(next_);
    time_ += dt;
    if (stop_ != 0 && std::abs(state_[at_x_]) < data_.motion.stroke_m / 2.0 - 1e-6) stop_ = 0;
  }
  for (std::size_t s = 0; s < 2; ++s) tubes_[s].end_step(state_.data() + at_tube_[s], time_ - begin);
}

void Machine::book_ports() {
  // The last rates of a step were those before its end: the ports are looked at once more.
  rates(state_.data(), time_, k1_.data());
}

void Machine::advance(double seconds) {
  const double end = time_ + seconds, longest = longest_step_s();
  const double even = seconds / std::ceil(seconds / longest - 1e-9);
  int without_progress = 0;
  while (end - time_ > 1e-12) {
    const double before = time_;
    step(std::min(even, end - time_));
    without_progress = time_ - before < 1e-11 ? without_progress + 1 : 0;
    if (without_progress > 20) {  // chatter between rest and sliding: rest for one step
      mode_ = Mode::resting;
      state_[at_x_ + 1] = 0.0;
      const double dt = std::min(even, end - time_);
      runge_kutta(state_, dt, next_);
      state_.swap(next_);
      time_ += dt;
      judge_rest();
      without_progress = 0;
    }
  }
  book_ports();
}

}  // namespace proof
