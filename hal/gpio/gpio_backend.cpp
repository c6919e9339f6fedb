// Backend `gpio`.
#include "gpio/gpio_backend.hpp"

#include <ctime>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

constexpr std::size_t emergency_stop = 0;

std::int64_t monotonic_now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

GpioBackend::GpioBackend(const Rig& rig, Requester request) : rig_(rig), request_(std::move(request)) {
  if (!rig.hal || !rig.hal->gpio)
    throw InputError(rig.name + ": hal.gpio: found nothing, expected the digital lines (docs/gpio.md)");
  parameters_ = *rig.hal->gpio;
}

void GpioBackend::configure() {
  deactivate();
  const std::array<const std::optional<GpioLineParameters>*, digital_line_count> wanted{
      &parameters_.emergency_stop, &parameters_.limit_low,  &parameters_.limit_high,
      &parameters_.valve_power,    &parameters_.switch_low, &parameters_.switch_high};
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (*wanted[i]) inputs_[i] = {request_(digital_line_names[i], **wanted[i], false)};
  if (parameters_.enable) enable_ = request_("enable", *parameters_.enable, true);
  enabled_ = false;
  rig_.hal->channels.for_each_command([&](std::string_view name, std::size_t output, const auto& valve) {
    if (valve.gpio) coils_.push_back({output, request_(std::string(name), *valve.gpio, true)});
  });
}

void GpioBackend::activate() {
  if (!set_coils(safe_outputs_V(rig_))) throw std::runtime_error("gpio: the chip refuses to set a valve's line");
  safe_output_ = {.has_outputs = !coils_.empty()};
}

bool GpioBackend::read(std::int64_t, Measurement& measurement) noexcept {
  const std::int64_t now_ns = monotonic_now_ns();
  const auto lines = lines_of(measurement.digital);
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    Input& input = inputs_[i];
    if (!input.line) continue;
    const GpioLine::Edges edges = input.line->take_edges();
    if (edges.last_ns != 0) {
      input.edge_ns = edges.last_ns;
      ++input.edges;
    }
    const std::optional<bool> level = input.line->read();
    input.is_unreadable = input.is_unreadable || !level;
    const bool active = level.value_or(false) || (i == emergency_stop && edges.became_active);
    lines[i]->state = !level ? LineState::unreadable : active ? LineState::on : LineState::off;
    if (input.edge_ns != 0) lines[i]->edge_age_s = static_cast<double>(now_ns - input.edge_ns) * 1e-9;
  }
  return true;
}

bool GpioBackend::set_enable(bool active) noexcept {
  if (!enable_ || enabled_ == active) return true;
  if (!enable_->write(active)) return false;
  enabled_ = active;
  return true;
}

bool GpioBackend::gives_power(double output_V) const noexcept { return output_V > 0.5 * rig_.axis.valve.command_max_V; }

bool GpioBackend::set_coils(const std::array<double, 2>& outputs_V) noexcept {
  bool all = true;
  for (Coil& coil : coils_) {
    const bool power = gives_power(outputs_V[coil.output]);
    if (power == coil.has_power) continue;
    const bool done = coil.line->write(power);
    if (done) coil.has_power = power;
    all = all && done;
  }
  return all;
}

bool GpioBackend::write(std::int64_t tick, const Command& command) noexcept {
  const bool set = set_coils(outputs_V(rig_, {command.valve_V, command.valve_2_V}));
  if (set && command.ended && safe_output_.has_outputs && safe_output_.sent_tick < 0) safe_output_.sent_tick = tick;
  return set_enable(command.enable) && set;
}

// Every line, whatever it is believed to be: the loop may have died between a line and the note of it.
bool GpioBackend::emergency_write() noexcept {
  const std::array<double, 2> safe_V = safe_outputs_V(rig_);
  bool all = !enable_ || enable_->write(false);
  for (Coil& coil : coils_) all = coil.line->write(gives_power(safe_V[coil.output])) && all;
  return all;
}

void GpioBackend::deactivate() noexcept {
  set_coils(safe_outputs_V(rig_));
  coils_.clear();
  set_enable(false);
  enable_.reset();
  for (Input& input : inputs_) input.line.reset();
}

Origins GpioBackend::origins() const {
  Origins all{.command = coils_.empty() ? Origin::absent : Origin::real};
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    if (inputs_[i].line) all.lines[i] = Origin::real;
  return all;
}

std::vector<std::string> GpioBackend::notes() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    if (inputs_[i].is_unreadable) lines.push_back(fmt::format("gpio: {} could not be read", digital_line_names[i]));
    if (inputs_[i].edges > 0)
      lines.push_back(fmt::format("gpio: {} changed in {} tick{}", digital_line_names[i], inputs_[i].edges,
                                  inputs_[i].edges > 1 ? "s" : ""));
  }
  return lines;
}

}  // namespace pneuservo
