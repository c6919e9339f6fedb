// Backend `comedi`.
#include "comedi/comedi_backend.hpp"

#include "config/input_error.hpp"

namespace pneuservo {

ComediBackend::ComediBackend(const Rig& rig)
    : AnalogBackend(rig, "comedi", rig.hal && rig.hal->comedi ? rig.hal->comedi->device : "") {
  if (!rig.hal || !rig.hal->comedi)
    throw InputError(rig.name + ": hal.comedi: found nothing, expected the board (docs/comedi.md)");
}

void ComediBackend::add_inputs(ComediBoard& board) {
  rig_.hal->channels.for_each_input([&](Signal signal, const auto& parameters) {
    const std::string key(info(signal).name);
    if (const auto& analog = parameters.comedi)
      inputs_.push_back({signal, board.add_input(key, analog->channel, analog->range, analog->reference), analog->scale,
                         analog->zero, analog->lowest, analog->highest});
    if (const auto& counter = parameters.comedi_counter)
      inputs_.push_back({signal, board.add_counter(key, counter->subdevice, counter->channel), counter->scale,
                         counter->zero, counter->lowest, counter->highest, true});
  });
}

void ComediBackend::add_outputs(ComediBoard& board) {
  rig_.hal->channels.for_each_command([&](std::string_view name, std::size_t command, const auto& parameters) {
    const std::string key(name);
    const auto& analog = parameters.comedi;
    if (!analog) return;
    Output output =
        output_of(command, board.add_output(key, analog->channel, analog->range, analog->reference), *analog);
    if (const auto& readback = analog->readback) {
      output.is_read_back = true;
      output.readback =
          board.add_input(key + ".comedi.readback", readback->channel, readback->range, analog->reference);
      output.tolerance_V = readback->tolerance_V;
    }
    outputs_.push_back(output);
  });
}

std::unique_ptr<AnalogBoard> ComediBackend::open() {
  auto board = std::make_unique<ComediBoard>(*rig_.hal->comedi);
  add_inputs(*board);
  add_outputs(*board);
  return board;
}

}  // namespace pneuservo
