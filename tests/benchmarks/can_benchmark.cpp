// What CANopen costs a tick beside the kernel's calls: frames to channels, command to frame, nodes watched.
#include <benchmark/benchmark.h>

#include <array>
#include <vector>

#include "bench_tools.hpp"
#include "can/process_image.hpp"

namespace {

using namespace pneuservo;

/// The module and the encoder of config/can: 8 bytes with a readback, 4 bytes, one output.
CanProcessImage image_of_an_axis() {
  const auto pressure = [](Signal signal, unsigned offset) {
    return CanSignal{signal, 0, {offset, 16}, {25.0, 0.0, true, 16}, 5e4, 8.1e5};
  };
  const CountScale volts{3.0517578125e-4, 0.0, true, 16};
  const CanSignal readback{Signal::x, 0, {48, 16}, volts, -5.0, 5.0, true, 1e-3};
  return CanProcessImage(
      {{0x183, 3, 4, true, 2'000'000, 51, {{Signal::x, 0, {0, 32}, {5e-6, 0.0, true, 32}, -0.16, 0.16}}},
       {0x282,
        2,
        8,
        true,
        2'000'000,
        51,
        {pressure(Signal::p1_port, 0), pressure(Signal::p2_port, 16), pressure(Signal::p_supply, 32), readback}}},
      {{0x302, 2, {{Signal::x, 0, {0, 16}, volts, -5.0, 5.0}}}},
      {{"io", 2, 50'000'000, 20'000'000, true}, {"encoder", 3, 50'000'000, 20'000'000, false}}, 126);
}

void can_cycle(benchmark::State& state) {
  CanProcessImage image = image_of_an_axis();
  std::int64_t now_ns = 1'000'000'000;
  image.start(now_ns);
  double sum = 0.0;
  const auto cycle = [&](int k) {
    const std::array<double, 2> command_V{1e-3 * (k % 1000), 0.0};
    CanFrame shown{.id = 0x282, .length = 8, .data = {0x70, 0x49, 0x70, 0x49, 0x60, 0x6D}};
    const CanFrame sent = image.output(0, command_V);
    image.begin_cycle(now_ns, command_V);
    shown.data[6] = sent.data[0];
    shown.data[7] = sent.data[1];
    image.on_frame({shown, now_ns + 200'000});
    image.on_frame({{.id = 0x183, .length = 4, .data = {static_cast<std::uint8_t>(k)}}, now_ns + 250'000});
    if (k % 20 == 0)
      for (const std::uint8_t node : {2, 3}) image.on_frame({heartbeat_frame(node, NmtState::operational), now_ns});
    now_ns += 1'000'000;
    Measurement measured;
    image.take(now_ns, measured);
    sum += measured.channel[Signal::x].value;
  };
  bench::report(state, bench::least_ns(200, 2000, cycle)[0]);
  benchmark::DoNotOptimize(sum);
  if (image.faults() != 0) state.SkipWithError("a fault");
}
BENCHMARK(can_cycle)->Name("can/cycle")->UseManualTime()->Iterations(1);

}  // namespace
