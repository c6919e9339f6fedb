// Entries of what a sensor's channel does to its signal beside noise and quantum. Offset, gain and lag of one channel
// mimic each other.
#include "elements/effect_entry.hpp"

namespace pneuservo {
namespace {

using enum EffectScale;
using enum Signal;

constexpr EffectEntry sensor_entries[] = {
    {.name = "sensor_offset",
     .words = "an offset of the sensor of #",
     .element = "sensor",
     .parameters = {amplitude("offset", channel_offset, 0.03, 1e-4).small(200)},
     .signatures = {{.side = info(p1_port).name,
                     .sizes = {{"offset", 5000}},
                     .words = "One port. Port and its chamber err to both sides, 5 kPa apart.",
                     .channels = {p1_port, p1_chamber},
                     .against = "speed"},
                    {.side = info(x).name,
                     .sizes = {{"offset", 0.01}},
                     .words = "Next to nothing: a ripple at rest, then less than 1 kPa.",
                     .channels = {p1_port, p2_port},
                     .against = "position"}}},
    {.name = "sensor_gain",
     .words = "a wrong gain of the sensor of #",
     .element = "sensor",
     // Beyond half and twice it is another unit or another sensor.
     .parameters = {amplitude("gain", channel_gain, 0.05, 1.7e-3).within(0.5, 2, one)},
     .signatures = {{.side = info(p1_port).name,
                     .sizes = {{"gain", 1.02}},
                     .words = "As an offset, with waves of the pressure in the sine.",
                     .channels = {p1_port, p1_chamber},
                     .against = "speed"},
                    {.side = info(x).name,
                     .sizes = {{"gain", 1.02}},
                     .words = "Sides opposite, by place. Stays while the axis rests.",
                     .channels = {p1_port, p2_port},
                     .against = "position"}}},
    {.name = "sensor_lag",
     .words = "a lag of the sensor of #",
     .element = "sensor",
     .parameters = {amplitude("time_constant_s", one, 0.007, 5e-4).small(3e-4)},
     .signatures = {{.side = info(p1_port).name,
                     .sizes = {{"time_constant_s", 0.015}},
                     .words = "One port, only while its pressure changes. No mean, its chamber is right.",
                     .channels = {p1_port, p1_chamber},
                     .against = "speed"},
                    {.side = info(x).name,
                     .sizes = {{"time_constant_s", 0.008}},
                     .words = "As valve_lag, but F errs too where the speed changes.",
                     .channels = {p1_port, p2_port},
                     .against = "speed"}}},
};

}  // namespace

std::span<const EffectEntry> sensor_effect_entries() { return sensor_entries; }

}  // namespace pneuservo
