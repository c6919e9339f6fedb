// What `pneuservo guard` can do to the outputs of a rig.
#include "guard/guard_outputs.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "can/canopen.hpp"
#include "can/open_carrier.hpp"
#include "can/process_data.hpp"
#include "config/input_error.hpp"
#include "rig/can_channels.hpp"

namespace pneuservo {
namespace {

constexpr int most_frames_a_look = 1024;

}  // namespace

GuardOutputs::GuardOutputs(const Rig& rig) : rig_(rig) {
  open_board();
  open_iio();
  prepare_frames();
  if (rig.hal->guard->enable) {
    line_ = request_gpio_line("guard.enable", *rig.hal->guard->enable, true);
    description_.push_back("drops its enable line");
  }
  if (description_.empty())
    throw InputError(rig.name + ": hal.guard: found no output that a guard could close, expected a valve on a board, "
                                "on Industrial I/O or on CAN (not slcan), or hal.guard.enable");
}

void GuardOutputs::open_board() {
  const auto safe_V = safe_outputs_V(rig_);
  rig_.hal->channels.for_each_command([&](std::string_view name, std::size_t valve, const auto& channel) {
    if (!channel.comedi) return;
    if (!board_) board_ = std::make_unique<ComediBoard>(*rig_.hal->comedi, true);
    const auto& out = *channel.comedi;
    const std::size_t number = board_->add_output(std::string(name), out.channel, out.range, out.reference);
    const double volts = std::clamp(safe_V[valve], out.lowest, out.highest);
    board_->set_volts(number, (volts - out.zero) / out.scale);
    description_.push_back(fmt::format("sets output {} of {} to {:g} V", out.channel, rig_.hal->comedi->device,
                                       board_->set_volts_of(number)));
  });
}

void GuardOutputs::open_iio() {
  const auto safe_V = safe_outputs_V(rig_);
  rig_.hal->channels.for_each_command([&](std::string_view name, std::size_t valve, const auto& channel) {
    if (!channel.iio) return;
    if (!iio_) iio_ = std::make_unique<IioBoard>(true);
    const auto& out = *channel.iio;
    const std::size_t number = iio_->add_output(std::string(name) + ".iio", {out.device, out.channel, out.V_per_count});
    const double volts = std::clamp(safe_V[valve], out.lowest, out.highest);
    iio_->set_volts(number, (volts - out.zero) / out.scale);
    description_.push_back(fmt::format("sets {} of {} to {:g} V", out.channel, out.device, iio_->set_volts_of(number)));
  });
}

// Where the mapping is the device's own its places are not known here: NMT stop alone.
void GuardOutputs::prepare_frames() {
  if (!rig_.hal->can || rig_.hal->can->interface.starts_with("slcan:")) return;
  const std::vector<CanChannel> channels = can_channels(*rig_.hal);
  const auto safe_V = safe_outputs_V(rig_);
  std::vector<std::uint8_t> nodes;
  for (const CanPdo& pdo : can_pdos(channels)) {
    if (!pdo.is_output) continue;
    const CanNodeParameters& node = rig_.hal->can->nodes.at(pdo.node);
    nodes.push_back(static_cast<std::uint8_t>(node.node_id));
    if (node.mapping == CanMapping::read) continue;
    CanFrame frame{.id = cob_receive_pdo(pdo.pdo, node.node_id),
                   .length = static_cast<std::uint8_t>((pdo.bits + 7) / 8)};
    std::uint64_t image = 0;
    unsigned offset = 0;
    for (const std::size_t i : pdo.signals) {
      const CanChannel& c = channels[i];
      const CountScale counts{c.scale, c.zero, c.is_signed, c.object.bits()};
      image =
          insert(image, {offset, c.object.bits()}, counts.raw_of(std::clamp(safe_V[c.command], c.lowest, c.highest)));
      offset += c.object.bits();
    }
    put_image(frame.data, image);
    frames_.push_back(frame);
  }
  if (nodes.empty()) return;
  frames_.push_back(sync_frame());
  for (const std::uint8_t node : nodes) frames_.push_back(nmt_frame(NmtCommand::stop, node));
  description_.push_back(fmt::format("sends safe output and NMT stop on {}", rig_.hal->can->interface));
}

bool GuardOutputs::open_bus() {
  if (frames_.empty() || (bus_ && bus_->is_up())) return true;
  bus_.reset();
  try {
    bus_ = open_carrier(rig_.hal->can->interface, rig_.hal->can->bit_rate_bps, false);
    bus_->accept_only({});
  } catch (const std::runtime_error&) { bus_.reset(); }
  return bus_ != nullptr;
}

void GuardOutputs::drain() noexcept {
  if (!bus_) return;
  ReceivedFrame received;
  for (int i = 0; i < most_frames_a_look && bus_->receive(received); ++i) {}
}

bool GuardOutputs::make_board_safe() noexcept {
  const bool board_is_safe = !board_ || board_->write();
  return (!iio_ || iio_->write()) && board_is_safe;
}

bool GuardOutputs::make_safe() noexcept {
  bool all = make_board_safe();
  for (const CanFrame& frame : frames_) all = bus_ && bus_->send(frame) == Sent::sent && all;
  return all;
}

bool GuardOutputs::enable(bool active) noexcept {
  if (!line_ || line_is_on_ == active) return true;
  if (!line_->write(active)) return false;
  line_is_on_ = active;
  return true;
}

}  // namespace pneuservo
