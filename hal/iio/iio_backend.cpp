// Backend `iio`.
#include "iio/iio_backend.hpp"

#include <cmath>
#include <stdexcept>

#include "config/input_error.hpp"

namespace pneuservo {
namespace {

constexpr double timeout_periods = 2.5;  // two scans are missing, and the third is half a period late

}  // namespace

IioBackend::IioBackend(const Rig& rig) : AnalogBackend(rig, "iio", "hal.iio") {
  if (!rig.hal || !rig.hal->iio)
    throw InputError(rig.name + ": hal.iio: found nothing, expected the section (docs/iio.md; it may be {})");
  parameters_ = *rig.hal->iio;
  period_ns_ = std::llround(rig.period_s * 1e9);
  const double timeout_s =
      parameters_.sample_timeout_s > 0.0 ? parameters_.sample_timeout_s : timeout_periods * rig.period_s;
  timeout_ns_ = std::llround(timeout_s * 1e9);
}

void IioBackend::add_inputs(IioBoard& board) {
  rig_.hal->channels.for_each_input([&](Signal signal, const auto& parameters) {
    const auto& iio = parameters.iio;
    if (!iio) return;
    const IioPlace place{iio->device, iio->channel, iio->V_per_count};
    inputs_.push_back({signal, board.add_input(std::string(info(signal).name) + ".iio", place), iio->scale, iio->zero,
                       iio->lowest, iio->highest});
  });
}

void IioBackend::add_outputs(IioBoard& board) {
  rig_.hal->channels.for_each_command([&](std::string_view name, std::size_t command, const auto& parameters) {
    const std::string key = std::string(name) + ".iio";
    const auto& iio = parameters.iio;
    if (!iio) return;
    Output output = output_of(command, board.add_output(key, {iio->device, iio->channel, iio->V_per_count}), *iio);
    if (const auto& readback = iio->readback) {
      output.is_read_back = true;
      const std::string& device = readback->device.empty() ? iio->device : readback->device;
      output.readback = board.add_input(key + ".readback", {device, readback->channel, readback->V_per_count});
      output.tolerance_V = readback->tolerance_V;
    }
    outputs_.push_back(output);
  });
}

std::unique_ptr<AnalogBoard> IioBackend::open() {
  auto board = std::make_unique<IioBoard>();
  add_inputs(*board);
  add_outputs(*board);
  if (is_paced()) board->start_scans(parameters_.trigger, rig_.period_s);
  else board->time_readings(rig_.period_s);
  iio_ = board.get();
  is_silent_ = false;
  return board;
}

// After a silence the loop goes on by itself, a tick a period, so that the safe output is repeated.
Pace IioBackend::await_sample() noexcept {
  const Pace pace = iio_->await_scan(is_silent_ ? period_ns_ : timeout_ns_);
  is_silent_ = pace.samples == 0;
  return pace;
}

std::vector<std::string> iio_refusals(const Rig& rig) {
  std::vector<std::string> all;
  const auto collect = [&](auto&& part) {
    try {
      part();
    } catch (const std::runtime_error& error) { all.emplace_back(error.what()); }
  };
  collect([&] {
    IioBackend backend(rig);
    IioBoard board(true);
    collect([&] { backend.add_inputs(board); });
    collect([&] { backend.add_outputs(board); });
  });
  return all;
}

}  // namespace pneuservo
