// Residuals of a pneumatic cylinder.
#include "diagnosis/residuals/cylinder_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <pneuservo/elements/sensor.hpp>

#include "diagnosis/recordings/held_out.hpp"
#include "diagnosis/recordings/noise_level.hpp"

namespace pneuservo {

namespace {

// The model's own error where nothing is missing: of pressures, and as a share of the drop between port and chamber;
// of the force, with and without sensors at the chambers.
constexpr double pressure_floor_Pa = 35.0, drop_share = 0.001;
/// Of the flow from the supply, as a share of its rms: half of it was measured on lines of 2 m, less on longer ones.
constexpr double flow_share = 0.001;
// The gas may start warmer or colder than its wall, which no pressure shows; the wall takes that out within a second.
// A recording that starts in the midst of motion leaves more: waves in the lines, gas not at its wall's temperature.
constexpr double start_floor_Pa = 200.0, start_share = 0.1, start_fades_s = 0.5;
// It grows with the pressures, and was measured at supplies from 6 bar on.
constexpr double force_floor_N = 0.04, force_floor_ports_N = 0.07, floor_supply_Pa = 5e5;
constexpr double slow_sigma_s = 0.015;
// Of the balance's kernel: a Gaussian this wide has 1e-5 left at the rows' Nyquist frequency. Gas forces have no jumps
// between rows that would have to be spread out.
constexpr double least_sigma_periods = 1.5;
// Of the port's quick answer to the command: what the grid, which lets it through a little late, may be wrong by.
constexpr double answer_share = 0.1, slowest_answer_s = 2e-3;
// A line of 7.65 mm at rest keeps ringing with what went before the recording, and forgets it in 1.2 s (1/e).
constexpr double answer_from_s = 1.5;
constexpr double noise_margin = 1.15;  // a recording this much noisier than its config is believed

// Memories that a slow error may have. Faults of flow add up in the gas and stay; a force is at once what it is, and
// its small faults change as fast as the motion does: a constant one is a load, not a floor.
constexpr std::array slow_memories_s{0.03, 0.1, 0.3, 1.0, 3.0};
constexpr double force_memory_s = 0.1;
/// Levels that a slow error may have, in sigma: none, then in steps of 1.4.
std::vector<double> slow_levels() {
  std::vector<double> levels{0.0, 0.25};
  while (1.4 * levels.back() < 300.0) levels.push_back(1.4 * levels.back());
  return levels;
}

/// Hypotheses whose gas is held at once: 1 MB each for 24 s at 1 kHz, and full lanes for all threads.
constexpr std::size_t most_at_once = 64;
constexpr std::size_t most_known_rows = 15'000'000;  // of columns that are remembered: 120 MB

/// What the sensor would read of true values.
std::vector<double> readings(const SensorEffects<double>& sensor, const std::vector<double>& truth, double period_s) {
  std::vector<double> out(truth);
  SensorLagFilter lag;
  lag.configure(sensor.sensor_lag.time_constant_s, period_s);
  lag.reset(truth.front());
  for (double& value : out) value = sensor.sensor_gain.gain * lag.step(value) + sensor.sensor_offset.offset;
  return out;
}

/// Where nothing was measured the simulation's error lies on a line between its neighbours, so that what is sampled
/// slowly is smoothed like the rest.
std::vector<double> with_gaps_filled(const std::vector<double>& measured, const std::vector<double>& simulated) {
  std::vector<double> out(measured);
  std::size_t last = out.size();  // measured; none yet
  for (std::size_t k = 0; k < out.size(); ++k) {
    if (!std::isfinite(measured[k])) continue;
    const double after = measured[k] - simulated[k];
    const double before = last < out.size() ? measured[last] - simulated[last] : after;
    const std::size_t from = last < out.size() ? last + 1 : 0;
    for (std::size_t i = from; i < k; ++i)
      out[i] = simulated[i] + before +
               (after - before) * static_cast<double>(i + 1 - from) / static_cast<double>(k + 1 - from);
    last = k;
  }
  const double end = last < out.size() ? measured[last] - simulated[last] : 0.0;
  for (std::size_t i = last < out.size() ? last + 1 : 0; i < out.size(); ++i) out[i] = simulated[i] + end;
  return out;
}

double largest_noise(const std::vector<CylinderRecording>& recordings, Signal signal, double configured) {
  double noise = configured;
  for (const CylinderRecording& recording : recordings) {
    const double seen = quiet_noise(recording.measured[signal], recording.period_s());
    if (seen > noise_margin * configured) noise = std::max(noise, seen);
  }
  return noise;
}

/// Error of the gas of one side where it is left to itself.
double start_error(const CylinderRecording& recording, std::size_t side) {
  const std::vector<double>& p = recording.inputs.start_Pa[side];
  const std::size_t count = std::min(p.size(), recording.inputs.release);
  if (count == 0) return start_floor_Pa;
  double sum = 0, squares = 0;
  for (std::size_t k = 0; k < count; ++k) sum += p[k];
  const double mean = sum / static_cast<double>(count);
  for (std::size_t k = 0; k < count; ++k) squares += (p[k] - mean) * (p[k] - mean);
  return std::max(start_floor_Pa, start_share * std::sqrt(squares / static_cast<double>(count)));
}

void add_means(ResidualRow& row, const ImposedInputs& inputs, const std::vector<double>& command, std::size_t first,
               std::size_t count) {
  const auto n = static_cast<double>(count);
  for (std::size_t k = first; k < first + count; ++k) {
    row.position_m += inputs.position_m[k] / n;
    row.velocity_mps += inputs.velocity_mps[k] / n;
    row.command_V += command[k] / n;
  }
}

double rms_drop(const SidedCourse& course, std::size_t side) {
  const std::vector<double>&port = course[port_signals[side]], &chamber = course[chamber_signals[side]];
  double sum = 0;
  for (std::size_t k = 0; k < port.size(); ++k) sum += (port[k] - chamber[k]) * (port[k] - chamber[k]);
  return std::sqrt(sum / static_cast<double>(port.size()));
}

/// What the position's reading may hide of a chamber's pressure: a light slider trembles within a step of its encoder.
double hidden_Pa(const Rig& owner, const CylinderRecording& recording, const SidedCourse& course, std::size_t side) {
  const CylinderParameters<double>& cylinder = owner.axis.cylinder;
  const double area_m2 = side == 0 ? cylinder.area_1_m2 : cylinder.area_2_m2,
               dead_m3 = side == 0 ? cylinder.dead_volume_1_m3 : cylinder.dead_volume_2_m3,
               towards = side == 0 ? 1.0 : -1.0, off_m = owner.sensors.position.quantum_m / std::sqrt(12.0);
  const std::vector<double>& chamber_Pa = course[chamber_signals[side]];
  double squares = 0;
  for (std::size_t k = 0; k < chamber_Pa.size(); ++k) {
    const double way_m = std::max(0.0, 0.5 * cylinder.stroke_m + towards * recording.inputs.position_m[k]);
    const double off_Pa =
        owner.axis.air.heat_capacity_ratio * chamber_Pa[k] * area_m2 * off_m / (dead_m3 + area_m2 * way_m);
    squares += off_Pa * off_Pa;
  }
  return std::sqrt(squares / static_cast<double>(chamber_Pa.size()));
}

/// The model's own error of a channel of the gas, where nothing is missing.
double floor_of(Signal signal, const Rig& owner, const std::vector<CylinderRecording>& recordings,
                const std::vector<SidedCourse>& courses) {
  double size = 0, hidden = 0;
  for (std::size_t r = 0; r < courses.size(); ++r) {
    const SidedCourse& course = courses[r];
    if (is_in_pascal(signal) && info(signal).side != 0) {
      size = std::max(size, rms_drop(course, side_of(signal)));
      hidden = std::max(hidden, hidden_Pa(owner, recordings[r], course, side_of(signal)));
    }
    if (is_in_pascal(signal)) continue;
    const std::vector<double>& flow = course[signal];
    const double squares = std::inner_product(flow.begin(), flow.end(), flow.begin(), 0.0);
    size = std::max(size, std::sqrt(squares / static_cast<double>(flow.size())));
  }
  if (!std::isfinite(size)) size = 0;
  if (!std::isfinite(hidden)) hidden = 0;
  return is_in_pascal(signal) ? std::hypot(pressure_floor_Pa, drop_share * size, hidden) : flow_share * size;
}

}  // namespace

CylinderResiduals::CylinderResiduals(const Rig& owner, const std::vector<Recording>& recordings,
                                     const CylinderResidualsSettings& settings)
    : owner_(owner), jobs_(settings.jobs), stop_(settings.stop) {
  for (const Recording& recording : recordings) {
    look_for_stop(stop_);
    recordings_.push_back(prepare_recording(recording, owner, settings.longest_s));
    const double interval_s = recordings_.back().period_s();
    slow_kernels_.emplace_back(std::max(slow_sigma_s, 2.5 * interval_s), interval_s);
    recordings_.back().held_out = {any_held_out(recordings), recording.is_held_out};
    recordings_.back().changes = machine_changes(owner, recording);
  }
  for (const CylinderRecording& recording : recordings_) {
    balances_.emplace_back(recording.position_m, recording.period_s(), owner.sensors.resolution(Signal::x),
                           least_sigma_periods);
    balances_.back().hold_out([&](std::size_t k) { return recording.held_out(recording.time_s(k)); });
  }
  gas_ = std::make_unique<GasRuns>(owner_, recordings_, jobs_, stop_);
  declare_channels();
  declare_rows();
}

CylinderResiduals::~CylinderResiduals() = default;

void CylinderResiduals::declare_channels() {
  const auto courses = gas_->of(std::vector<Hypothesis>{{owner_, {}}});
  for (const Signal signal : gas_signals) {
    if (std::none_of(recordings_.begin(), recordings_.end(),
                     [&](const CylinderRecording& r) { return !r.measured[signal].empty(); }))
      continue;
    // The flow follows a noisy command at once: its quick changes are no noise of the meter.
    const double resolution = owner_.sensors.resolution(signal).rms();
    ResidualChannel out{std::string(info(signal).name), std::string(info(signal).unit), resolution,
                        floor_of(signal, owner_, recordings_, courses[0])};
    if (is_in_pascal(signal)) out.noise = largest_noise(recordings_, signal, resolution);
    // A supply that swings within the tolerance of its pressure is as its owner says.
    if (const auto stated = owner_.tolerances.find("supply.pressure_Pa");
        signal == Signal::p_supply && stated != owner_.tolerances.end())
      out.stated = stated->second * owner_.axis.supply.pressure_Pa;
    channels_.push_back(out);
    signals_.push_back(signal);
  }
  bool chambers = true;
  for (const CylinderRecording& recording : recordings_)
    chambers =
        chambers && !recording.measured[Signal::p1_chamber].empty() && !recording.measured[Signal::p2_chamber].empty();
  const double supply_Pa = owner_.axis.supply.pressure_Pa - owner_.axis.air.atmosphere_Pa;
  const double share = supply_Pa > 0 ? std::min(1.0, supply_Pa / floor_supply_Pa) : 1.0;
  const RecordedRigs rigs(owner_, recordings_);
  double noise = 0;
  for (std::size_t r = 0; r < recordings_.size(); ++r)
    noise = std::max(
        noise, std::hypot(pressure_noise(r, 1), balances_[r].force_noise(rigs[r], balances_[r].reading_noise(1))));
  channels_.push_back({"F", "N", noise, share * (chambers ? force_floor_N : force_floor_ports_N)});
  signals_.push_back(Signal::F);
}

double CylinderResiduals::pressure_noise(std::size_t recording, std::size_t count) const {
  const double areas[2]{owner_.axis.cylinder.area_1_m2, owner_.axis.cylinder.area_2_m2};
  double squares = 0;
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const bool measured = !recordings_[recording].measured[chamber_signals[side]].empty();
      if (signals_[i] != (measured ? chamber_signals : port_signals)[side]) continue;
      const double gain = (measured ? balances_[recording].kernel() : slow_kernels_[recording]).noise_gain(0, count);
      squares += std::pow(areas[side] * channels_[i].noise * gain, 2);
    }
  return std::sqrt(squares);
}

std::vector<PossibleRinging> CylinderResiduals::ringing_of_all() const {
  std::vector<PossibleRinging> ringing(recordings_.size());
  const RecordedRigs rigs(owner_, recordings_);
  in_parallel(recordings_.size(), jobs_, [&](std::size_t r) {
    ringing[r] = possible_ringing(recordings_[r].inputs, rigs[r],
                                  grid_for(rigs[r], ringing_effort, recordings_[r].inputs.step_s()), stop_);
  });
  return ringing;
}

void CylinderResiduals::declare_rows() {
  const std::vector<PossibleRinging> ringing = ringing_of_all();
  for (std::size_t r = 0; r < recordings_.size(); ++r) {
    const CylinderRecording& recording = recordings_[r];
    const std::vector<std::vector<double>> gap = gap_errors(r);
    const auto bin = static_cast<std::size_t>(std::max(1.0, std::round(residual_bin_s / recording.period_s())));
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      const Signal signal = signals_[c];
      const bool force = signal == Signal::F;
      const std::vector<double>& command = recording.inputs.command_of(side_of(signal));
      if (!force && recording.measured[signal].empty()) continue;
      Stretch stretch{r, c, rows_.size(), {}, recording.usable, {}, {}, {}};
      if (force) take_reading_noise(stretch, bin);
      const std::vector<char> stops = balances_[r].near_end_stop(owner_.axis.cylinder.stroke_m);
      const std::vector<char> known = recording.usable;
      for (std::size_t k = 0; k < recording.samples(); ++k)
        stretch.usable[k] =
            known[k] && (force ? balances_[r].usable()[k] && !stops[k] : std::isfinite(recording.measured[signal][k]));
      const bool has_start = info(signal).side != 0;
      const double start_Pa = has_start ? start_error(recording, side_of(signal)) : 0.0;
      for (std::size_t first = 0; first + bin <= recording.samples(); first += bin) {
        const auto part = [&](const std::vector<char>& marks) {
          const auto begin = marks.begin() + static_cast<std::ptrdiff_t>(first);
          return std::count_if(begin, begin + static_cast<std::ptrdiff_t>(bin), [](char mark) { return mark != 0; });
        };
        const auto whole = static_cast<std::ptrdiff_t>(bin);
        if (part(known) < whole || part(stretch.usable) < (force ? whole : 1)) continue;
        const auto values = static_cast<double>(part(stretch.usable));
        stretch.bins.push_back({first, bin, values});
        const double bin_s = recording.period_s() * static_cast<double>(bin);
        ResidualRow row{static_cast<int>(c), static_cast<int>(r)};
        row.time_s = recording.time_s(first) + 0.5 * (bin_s - recording.period_s());
        add_means(row, recording.inputs, command, first, bin);
        const double since_s = recording.period_s() * static_cast<double>(first) - first_compared_s,
                     start = start_Pa * std::exp(-since_s / start_fades_s);
        const double between = gap[c].empty() ? 0.0 : gap[c][first + bin / 2];
        row.sigma = std::hypot(noise_of(stretch, stretch.bins.back()),
                               std::hypot(channels_[c].floor, start, between) * std::sqrt(floor_correlation_s / bin_s));
        row.sigma = std::hypot(row.sigma, largest_ringing(ringing[r], r, c, first, bin));
        if (force) stretch.reading_noise.add_row(first, row.sigma);
        row.held_out = recording.held_out(recording.time_s(first));
        stretch.times_s.push_back(row.time_s);
        rows_.push_back(row);
      }
      if (is_port(signal)) declare_answer(stretch, ringing[r]);
      stretches_.push_back(std::move(stretch));
    }
  }
}

double CylinderResiduals::largest_ringing(const PossibleRinging& ringing, std::size_t recording, std::size_t channel,
                                          std::size_t first, std::size_t count) const {
  const Signal signal = signals_[channel];
  const auto& measured = recordings_[recording].measured;
  std::array<double, 2> factor{};
  if (is_port(signal)) factor[side_of(signal)] = 1.0;
  if (signal == Signal::F)  // the force rests on a port's pressure where its chamber has no sensor
    factor = {measured[Signal::p1_chamber].empty() ? owner_.axis.cylinder.area_1_m2 : 0.0,
              measured[Signal::p2_chamber].empty() ? -owner_.axis.cylinder.area_2_m2 : 0.0};
  double largest = 0;
  for (const PossibleCourse& course : ringing) {
    double sum = 0;
    for (std::size_t side = 0; side < 2; ++side)
      for (std::size_t k = first; k < first + count && !course.ringing[side].empty(); ++k)
        sum += factor[side] * course.ringing[side][k];
    largest = std::max(largest, std::abs(sum) / static_cast<double>(count));
  }
  return largest;
}

void CylinderResiduals::declare_answer(Stretch& stretch, const PossibleRinging& possible) {
  const CylinderRecording& recording = recordings_[stretch.recording];
  if (stretch.bins.empty() || recording.period_s() > slowest_answer_s || recording.inputs.steps > 1) return;
  std::vector<char> used(stretch.usable);
  for (std::size_t k = 0; k < used.size(); ++k)
    used[k] = used[k] && !recording.held_out(recording.time_s(k)) &&
              static_cast<double>(k) * recording.period_s() >= answer_from_s;
  const auto side = side_of(signals_[stretch.channel]);
  stretch.answer = CommandAnswer(recording.inputs.command_of(side), used);
  if (stretch.answer.rows() == 0) return;
  const Hypothesis owner{owner_, {}};
  const auto gas = gas_->of(std::span(&owner, 1));
  const RecordedRigs rigs(owner_, recordings_);
  const SampledCourse course = course_of(rigs, gas[0][stretch.recording], stretch);
  const Eigen::VectorXd answer = stretch.answer.of(course.simulated);
  const double size = answer.norm();
  if (!std::isfinite(size)) {
    stretch.answer = {};
    return;
  }
  std::vector<double> difference(course.simulated);
  for (std::size_t k = 0; k < difference.size(); ++k) difference[k] -= course.measured[k];
  // The echoes of earlier steps near half the sampling rate, which no affordable grid carries, are noise here.
  const double noise = std::max(channels_[stretch.channel].noise, stretch.answer.quick_part(difference));
  ResidualRow row = rows_[stretch.first_row];
  row.held_out = false;
  row.over_recording = true;
  // What rings with every stair is an answer too, though not the one of a grid that can be afforded: a machine's was
  // 48 kPa off, and a branch of the line took it.
  std::vector<Eigen::VectorXd> off;
  for (const PossibleCourse& possible_course : possible) {
    GasCourse ports;
    ports[Signal::p1_port] = possible_course.pressure[0];
    ports[Signal::p2_port] = possible_course.pressure[1];
    if (ports[signals_[stretch.channel]].empty()) continue;
    off.emplace_back(stretch.answer.of(course_of(rigs, SidedCourse(std::move(ports)), stretch).simulated) - answer);
  }
  for (const double rings : stretch.answer.turn_along(off)) {
    row.sigma = std::hypot(noise, answer_share * size, rings);
    rows_.push_back(row);
  }
}

std::vector<double> CylinderResiduals::chamber_pressure(const Rig& rig, const SidedCourse& gas, std::size_t recording,
                                                        std::size_t side) const {
  const CylinderRecording& data = recordings_[recording];
  const GaussianKernel& kernel = balances_[recording].kernel();
  const Signal chamber = chamber_signals[side], port = port_signals[side];
  const bool measured = !data.measured[chamber].empty();
  const Signal signal = measured ? chamber : port;
  if (data.measured[signal].empty()) return kernel.apply(gas[chamber], 0);
  const SensorEffects<double>& sensor = rig.sensor_effects[signal];
  const std::vector<double> simulated = readings(sensor, gas[signal], data.period_s());
  const std::vector<double> reading = with_gaps_filled(data.measured[signal], simulated);
  std::vector<double> error(reading.size());
  for (std::size_t k = 0; k < error.size(); ++k) error[k] = reading[k] - simulated[k];
  const double tau = sensor.sensor_lag.time_constant_s, gain = sensor.sensor_gain.gain;
  // Without a lag the measured chamber stands for itself; otherwise the simulation gives what is fast, the sensor the
  // slow rest. Turning a lag round amplifies noise, so its derivative is taken of the simulation and the slow error.
  std::vector<double> out;
  if (measured) {
    out = kernel.apply(reading, 0);
    for (double& value : out) value = (value - sensor.sensor_offset.offset) / gain;
  } else {
    out = kernel.apply(gas[chamber], 0);
    const std::vector<double> slow = slow_kernels_[recording].apply(error, 0);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += slow[k] / gain;
  }
  if (tau > 0) {
    const std::vector<double> slow_rate = slow_kernels_[recording].apply(error, 1);
    for (std::size_t k = 0; k < out.size(); ++k) out[k] += tau * slow_rate[k] / gain;
    if (measured) {
      const std::vector<double> rate = kernel.apply(simulated, 1);
      for (std::size_t k = 0; k < out.size(); ++k) out[k] += tau * rate[k] / gain;
    }
  }
  return out;
}

CylinderResiduals::SampledCourse CylinderResiduals::force_course(const Rig& rig, const SidedCourse& gas,
                                                                 std::size_t recording) const {
  const std::array<std::vector<double>, 2> p{chamber_pressure(rig, gas, recording, 0),
                                             chamber_pressure(rig, gas, recording, 1)};
  const CylinderParameters<double>& cylinder = rig.axis.cylinder;
  const double atmosphere = rig.axis.air.atmosphere_Pa;
  SampledCourse out;
  std::vector<double> gauge_sum(p[0].size());
  out.measured.resize(p[0].size());
  for (std::size_t k = 0; k < p[0].size(); ++k) {
    out.measured[k] = cylinder.area_1_m2 * (p[0][k] - atmosphere) - cylinder.area_2_m2 * (p[1][k] - atmosphere);
    gauge_sum[k] = std::max(p[0][k] - atmosphere, 0.0) + std::max(p[1][k] - atmosphere, 0.0);
  }
  out.simulated =
      balances_[recording].required_force(rig, out.measured, gauge_sum, rest_noises * channels_.back().noise);
  return out;
}

CylinderResiduals::SampledCourse CylinderResiduals::course_of(const RecordedRigs& rigs, const SidedCourse& gas,
                                                              const Stretch& stretch) const {
  const Rig& rig = rigs[stretch.recording];
  const Signal signal = signals_[stretch.channel];
  if (signal == Signal::F) return force_course(rig, gas, stretch.recording);
  const CylinderRecording& data = recordings_[stretch.recording];
  return {data.measured[signal], readings(rig.sensor_effects[signal], gas[signal], data.period_s())};
}

void CylinderResiduals::take_reading_noise(Stretch& stretch, std::size_t count) const {
  const ForceBalance& balance = balances_[stretch.recording];
  stretch.reading_noise = balance.reading_noise(count);
  stretch.reading_noise.owner_N =
      balance.force_noise(RecordedRigs(owner_, recordings_)[stretch.recording], stretch.reading_noise);
}

double CylinderResiduals::noise_of(const Stretch& stretch, const Bin& bin) const {
  if (signals_[stretch.channel] != Signal::F) return channels_[stretch.channel].noise / std::sqrt(bin.values);
  return std::hypot(stretch.reading_noise.of_row_N(bin.first), pressure_noise(stretch.recording, bin.count));
}

Eigen::VectorXd CylinderResiduals::plain_column(const Rig& rig, const std::vector<SidedCourse>& gas) const {
  Eigen::VectorXd out(static_cast<Eigen::Index>(rows_.size()));
  const RecordedRigs rigs(rig, recordings_);
  for (const Stretch& stretch : stretches_) {
    look_for_stop(stop_);
    const SampledCourse course = course_of(rigs, gas[stretch.recording], stretch);
    double* row = out.data() + stretch.first_row;
    for (std::size_t b = 0; b < stretch.bins.size(); ++b) {
      const Bin& bin = stretch.bins[b];
      double sum = 0;
      for (std::size_t k = bin.first; k < bin.first + bin.count; ++k)
        if (stretch.usable[k]) sum += course.simulated[k] - course.measured[k];
      *row++ = sum / bin.values / rows_[stretch.first_row + b].sigma;
    }
    if (signals_[stretch.channel] == Signal::F) {
      auto force =
          out.segment(static_cast<Eigen::Index>(stretch.first_row), static_cast<Eigen::Index>(stretch.bins.size()));
      const double noise_N = balances_[stretch.recording].force_noise(rigs[stretch.recording], stretch.reading_noise);
      force *= stretch.reading_noise.factor({force.data(), stretch.bins.size()},
                                            std::span(rows_).subspan(stretch.first_row, stretch.bins.size()), noise_N);
    }
    if (stretch.answer.rows() == 0) continue;
    std::vector<double> difference(course.simulated);
    for (std::size_t k = 0; k < difference.size(); ++k) difference[k] -= course.measured[k];
    std::size_t at = stretch.first_row + stretch.bins.size();
    for (const double value : stretch.answer.of(difference)) *row++ = value / rows_[at++].sigma;
  }
  return out;
}

std::vector<CylinderResiduals::Column> CylinderResiduals::plain_columns(std::span<const Hypothesis> hypotheses) {
  std::vector<Column> out(hypotheses.size());
  std::vector<std::vector<double>> keys(hypotheses.size());
  std::vector<std::size_t> missing;
  std::vector<Hypothesis> wanted;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    const auto keep = [&](std::size_t, const auto& value) { keys[i].push_back(static_cast<double>(value)); };
    const EachNumber<decltype(keep)> collect{keep};
    AxisParameters<double>::visit(collect, hypotheses[i].rig.axis);
    for (const SensorEffects<double>& sensor : hypotheses[i].rig.sensor_effects.all)
      SensorEffects<double>::visit(collect, sensor);
    for (const std::vector<double>& own : {hypotheses[i].start_factors, hypotheses[i].swing_Pa})
      keys[i].insert(keys[i].end(), own.begin(), own.end());
    keys[i].push_back(hypotheses[i].swing_Hz);
    const auto known = known_columns_.find(keys[i]);
    if (known != known_columns_.end()) {
      out[i] = known->second;
    } else {
      missing.push_back(i);
      wanted.push_back(hypotheses[i]);
    }
  }
  for (std::size_t first = 0; first < wanted.size(); first += most_at_once) {
    const auto some = std::span(wanted).subspan(first, std::min(most_at_once, wanted.size() - first));
    const auto gas = gas_->of(some);
    in_parallel(some.size(), jobs_, [&](std::size_t m) {
      out[missing[first + m]] = std::make_shared<const Eigen::VectorXd>(plain_column(some[m].rig, gas[m]));
    });
  }
  if ((known_columns_.size() + missing.size()) * rows_.size() > most_known_rows) known_columns_.clear();
  for (const std::size_t i : missing) known_columns_.emplace(std::move(keys[i]), out[i]);
  return out;
}

Eigen::MatrixXd CylinderResiduals::residuals(std::span<const Hypothesis> hypotheses) {
  const std::vector<Column> plain = plain_columns(hypotheses);
  Eigen::MatrixXd out(static_cast<Eigen::Index>(rows_.size()), static_cast<Eigen::Index>(hypotheses.size()));
  for (Eigen::Index i = 0; i < out.cols(); ++i) {
    out.col(i) = *plain[static_cast<std::size_t>(i)];
    if (!out.col(i).allFinite()) out.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

void CylinderResiduals::set_working_point(const Hypothesis& hypothesis) {
  gas_->set_working_point(hypothesis);
  known_columns_.clear();
}

LikeliestErrors CylinderResiduals::likeliest_slow_errors(const Hypothesis& hypothesis) {
  LikeliestErrors out{std::vector<SlowError>(channels_.size()), -std::numeric_limits<double>::infinity()};
  const Eigen::VectorXd column = *plain_columns(std::span(&hypothesis, 1)).front();
  if (!column.allFinite()) return out;
  std::vector<double> best(channels_.size(), -std::numeric_limits<double>::infinity());
  // The likeliest of a grid.
  for (const double memory_s : slow_memories_s)
    for (const double level : slow_levels()) {
      std::vector<double> likelihood(channels_.size(), 0.0);
      for (const Stretch& stretch : stretches_) {
        std::vector<double> rows(column.data() + stretch.first_row,
                                 column.data() + stretch.first_row + stretch.bins.size());
        likelihood[stretch.channel] -= SlowError{memory_s, level}.whiten(stretch.times_s, rows);
        for (const double row : rows) likelihood[stretch.channel] -= 0.5 * row * row;
      }
      for (std::size_t c = 0; c < channels_.size(); ++c)
        if (likelihood[c] > best[c] && (signals_[c] != Signal::F || memory_s <= force_memory_s)) {
          best[c] = likelihood[c];
          out.of_channel[c] = {memory_s, level};
        }
    }
  out.log_likelihood = std::accumulate(best.begin(), best.end(), 0.0);
  return out;
}

std::vector<ChannelMisfit> CylinderResiduals::sample_misfit(const Hypothesis& hypothesis) {
  const auto gas = gas_->of(std::vector<Hypothesis>{hypothesis});
  std::vector<ChannelMisfit> out(channels_.size());
  std::vector<std::array<double, 2>> squares(channels_.size()), counts(channels_.size());
  const RecordedRigs rigs(hypothesis.rig, recordings_);
  for (const Stretch& stretch : stretches_) {
    const SampledCourse course = course_of(rigs, gas[0][stretch.recording], stretch);
    for (std::size_t b = 0; b < stretch.bins.size(); ++b) {
      const std::size_t held_out = rows_[stretch.first_row + b].held_out;
      for (std::size_t k = stretch.bins[b].first; k < stretch.bins[b].first + stretch.bins[b].count; ++k) {
        if (!stretch.usable[k]) continue;
        squares[stretch.channel][held_out] += std::pow(course.simulated[k] - course.measured[k], 2);
        counts[stretch.channel][held_out] += 1;
      }
    }
  }
  for (std::size_t c = 0; c < channels_.size(); ++c)
    out[c] = {std::sqrt(squares[c][0] / std::max(1.0, counts[c][0])),
              std::sqrt(squares[c][1] / std::max(1.0, counts[c][1]))};
  return out;
}

std::vector<ResidualCourse> CylinderResiduals::courses(const Hypothesis& hypothesis) {
  const auto gas = gas_->of(std::vector<Hypothesis>{hypothesis});
  const RecordedRigs rigs(hypothesis.rig, recordings_);
  std::vector<ResidualCourse> out;
  for (const Stretch& stretch : stretches_) {
    const SampledCourse course = course_of(rigs, gas[0][stretch.recording], stretch);
    ResidualCourse compared{static_cast<int>(stretch.channel), static_cast<int>(stretch.recording), {}, {}, {}};
    for (std::size_t k = 0; k < stretch.usable.size(); ++k) {
      if (!stretch.usable[k]) continue;
      compared.time_s.push_back(recordings_[stretch.recording].time_s(k));
      compared.measured.push_back(course.measured[k]);
      compared.simulated.push_back(course.simulated[k]);
    }
    out.push_back(std::move(compared));
  }
  return out;
}

}  // namespace pneuservo
