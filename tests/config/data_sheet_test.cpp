// Values with units and data-sheet keys say the same as the SI keys; what cannot be meant is refused.
#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include <fmt/format.h>

#include "config/data_sheet.hpp"
#include "config/dump_rig.hpp"
#include "config/number_text.hpp"
#include "config/read_rig.hpp"
#include "config/rig_parameters.hpp"
#include "config/same_rig.hpp"
#include "config/test_rigs.hpp"
#include "config/units.hpp"
#include "core/test_seed.hpp"

using namespace pneuservo;
using Catch::Contains;
using test::accepted;
using test::plain_rig;
using test::refusal;
using test::with;

namespace {

double read(const std::string& unit, const std::string& text, double minimum = 0.0) {
  const ReadQuantity found = read_quantity({"key", unit, minimum, infinite, ""}, text, {1e5, 0.2});
  return found.value.value_or(std::nan(""));
}

std::string with_cylinder(const std::string& areas) {
  return with(plain_rig, "  area_1_m2: 1.257e-3\n  area_2_m2: 1.056e-3\n", areas);
}

}  // namespace

TEST_CASE("units of data sheets become SI") {
  CHECK(read("m", "3.5 m") == 3.5);
  CHECK(read("m", "32mm") == 0.032);
  CHECK(read("m", "0.1 mm") == 1e-4);
  CHECK(read("m", "1 in") == 0.0254);
  CHECK(read("m2", "2.6 mm2") == 2.6e-6);
  CHECK(read("m3", "20 cm^3") == 2e-5);
  CHECK(read("m3", "0.5 l") == 5e-4);
  CHECK(read("kg", "250 g") == 0.25);
  CHECK(read("s", "2 ms") == 0.002);
  CHECK(read("Pa", "0.3 kPa") == 300.0);
  CHECK(read("Pa", "2 mbar") == 200.0);
  CHECK(read("Pa", "1 psi") == Approx(6894.757).epsilon(1e-6));
  CHECK(read("Hz", "1.5 kHz") == 1500.0);
  CHECK(read("m/s", "6 m/min") == 0.1);
  CHECK(read("m2/V", "2.6 mm2/V") == 2.6e-6);
  CHECK(read("N s/m", "60 N s/m") == 60.0);
  CHECK(read("N s/m", "0.06 N*s/mm") == Approx(60.0));
  CHECK(read("W/(m2 K)", "50 W/(m2 K)") == 50.0);
  CHECK(read("J/(kg K)", "0.287 kJ/(kg K)") == 287.0);
  CHECK(read("rad", "90 deg") == Approx(std::numbers::pi / 2));
  CHECK(read("m3/(s Pa)", "2.5 l/(s bar)") == Approx(2.5e-8));
  CHECK(read("m3/s", "60 l/min") == Approx(1e-3));
  // Free air: 20 degC against 0 degC, 1 bar against 1.01325 bar.
  CHECK(read("m3/s", "60 Nl/min") == Approx(1.0874e-3).epsilon(1e-4));
}

TEST_CASE("values that count from somewhere say from where") {
  CHECK(read("Pa", "6 bar gauge", 1e4) == 7e5);
  CHECK(read("Pa", "7 bar absolute", 1e4) == 7e5);
  CHECK(read("Pa", "7 bar abs", 1e4) == 7e5);
  CHECK(std::isnan(read("Pa", "6 bar", 1e4)));
  CHECK(read("Pa", "6 bar") == 6e5);
  CHECK(read("K", "20 degC") == 293.15);
  CHECK(read("m", "20 mm", -1.0) == 0.02);
  CHECK(read("m", "20 mm from end 1", -1.0) == Approx(-0.08));
  CHECK(read("m", "20 mm from end 2", -1.0) == Approx(0.08));
  CHECK(std::isnan(read("m", "20 mm from end 1")));
}

TEST_CASE("text that is no quantity of that dimension is none") {
  for (const char* text : {"", "m", "3.5", "3.5 kg", "3.5 m2", "3,5 m", "3.5 m m", "1e999 m", "--3 m", "3 m from",
                           "3 (m", "3 m)", "3 m/", "3 m/1/1/1/1/1/1/1/1/1", "nan m", ".inf m", "3 x"})
    CHECK(std::isnan(read("m", text)));
}

TEST_CASE("a number with a decimal unit is the number that SI would be, to the last bit") {
  const unsigned seed = test::stated_seed().value_or(20261125u);
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> digits(1, 999999), places(-9, 3);
  const std::vector<std::pair<std::string, int>> units{{"mm", -3}, {"um", -6}, {"cm", -2}, {"km", 3}, {"m", 0}};
  for (int i = 0; i < 2000; ++i) {
    const auto& [unit, power] = units[static_cast<std::size_t>(i) % units.size()];
    const int mantissa = digits(random), place = places(random);
    const std::string text = fmt::format("{}e{} {}", mantissa, place, unit);
    INFO(text);
    REQUIRE(read("m", text) == number_from_text(fmt::format("{}e{}", mantissa, place + power)).value());
  }
}

TEST_CASE("every key that carries its unit takes a value with that unit") {
  const Rig rig = parse_rig(plain_rig, "rig.yaml");
  int tried = 0;
  for (const ParameterPath& parameter : parameter_paths(rig)) {
    const std::string key(key_without_unit(parameter.field));
    const bool is_plain_number =
        parameter.field.unit.empty() || parameter.field.unit == "-" || parameter.field.unit == "SI";
    INFO(parameter.path << " in " << parameter.field.unit);
    REQUIRE(key.empty() == is_plain_number);
    const bool is_stated = !parameter.path.starts_with("effects") && !parameter.path.starts_with("sensors.chamber") &&
                           !parameter.path.starts_with("sensors.supply") &&
                           !parameter.path.starts_with("sensors.differential");
    const bool is_in_range = parameter.value >= parameter.field.minimum && std::isfinite(parameter.value);
    if (key.empty() || !is_stated || !is_in_range) continue;
    const std::size_t dot = parameter.path.rfind('.');
    const std::string path = dot == std::string::npos ? key : parameter.path.substr(0, dot + 1) + key;
    const char* words = datum_of(parameter.field) == Datum::vacuum ? " absolute" : "";
    const std::string text = fmt::format("{}={} {}{}", path, number_text(parameter.value), parameter.field.unit, words);
    const Rig stated = parse_rig(plain_rig, "rig.yaml", {text});
    REQUIRE(get_parameter(stated, parameter.path) == parameter.value);
    ++tried;
  }
  CHECK(tried > 40);
}

TEST_CASE("bore and rod are the piston areas") {
  const Rig rig = parse_rig(with_cylinder("  bore: 32 mm\n  rod: 12 mm\n"), "rig.yaml");
  CHECK(rig.axis.cylinder.area_1_m2 == Approx(8.0425e-4).epsilon(1e-4));
  CHECK(rig.axis.cylinder.area_2_m2 == Approx(6.9115e-4).epsilon(1e-4));
  const Rig through = parse_rig(with_cylinder("  bore: 32 mm\n  rod: 12 mm\n  rod_1: 12 mm\n"), "rig.yaml");
  CHECK(through.axis.cylinder.area_1_m2 == through.axis.cylinder.area_2_m2);
}

TEST_CASE("a rod thicker than its bore leaves no piston") {
  CHECK_THAT(refusal(with_cylinder("  bore: 12 mm\n  rod: 32 mm\n")),
             Contains("cylinder.area_2_m2: found -") && Contains("(by bore), expected a number in m2"));
}

TEST_CASE("half a form names its other half, a key beside its SI key is refused, a --set wins") {
  CHECK(refusal(with_cylinder("  bore: 32 mm\n")) ==
        "rig.yaml:19: cylinder.rod: found nothing, expected it beside the others of its form (pi/4 (bore^2 - rod^2))");
  CHECK_THAT(
      refusal(with(plain_rig, "length_m: 10.0", "length: 10 m\n  length_m: 10.0")),
      Contains("rig.yaml:13: line_1.length: found it beside length_m (at rig.yaml:14), expected one of the two"));
  const Rig rig = parse_rig(with(plain_rig, "length_m: 10.0", "length: 10 m"), "rig.yaml", {"line_1.length_m=3"});
  CHECK(rig.axis.line_1.length_m == 3.0);
  CHECK(parse_rig(plain_rig, "rig.yaml", {"line_1.length=400 cm"}).axis.line_1.length_m == 4.0);
}

TEST_CASE("flow by ISO 6358 or by the nominal flow gives one valve") {
  const auto valve = [](const std::string& flow) {
    return parse_rig(with(plain_rig, "  area_per_volt_m2_per_V: 2.6e-6\n  area_max_m2: 1.3e-5\n", flow), "rig.yaml")
        .axis.valve;
  };
  // C = K_f S/(rho_0 sqrt(R T_0)) with rho_0 = 1.1886 kg/m3, K_f = 0.68473.
  const double C = 2.6e-8, S = C * 1.18861 * std::sqrt(287.0 * 293.15) / 0.68473;
  CHECK(valve("  sonic_conductance: 2.6 l/(s bar)\n").area_max_m2 == Approx(S).epsilon(1e-4));
  CHECK(valve("  sonic_conductance: 2.6 l/(s bar)\n").area_per_volt_m2_per_V == Approx(S / 5).epsilon(1e-4));
  // q = C p_1 psi(p_2/p_1) by hand.
  const double p_1 = 701325, r = 601325.0 / p_1, z = (r - 0.35) / 0.65, q = C * p_1 * std::sqrt(1 - z * z);
  CHECK(valve(fmt::format("  nominal_flow: {} l/min\n", q * 6e4)).area_max_m2 == Approx(S).epsilon(1e-4));
}

TEST_CASE("ranges of valve and sensors") {
  const Rig rig = parse_rig(with(with(plain_rig, "command_max_V: 5.0", "signal: 0 to 10 V"), "quantum_Pa: 100.0",
                                 "range: 0 to 10 bar gauge\n    bits: 12"),
                            "rig.yaml");
  CHECK(rig.axis.valve.command_max_V == 5.0);
  CHECK(rig.sensors.port_pressure.quantum_Pa == Approx(1e6 / 4096));
  CHECK_THAT(refusal(with(plain_rig, "command_max_V: 5.0", "signal: 0 V")),
             Contains("rig.yaml:8: valve.signal: found '0 V', expected two ends with their unit (0 to 10 V)"));
}

TEST_CASE("channels of a board by the signals of sensor and valve") {
  const std::string hal = R"(hal:
  comedi: {}
  bench: true
  channels:
    x: {comedi: {channel: 0, signal: 0 to 10 V, measures: 0 mm from end 1 to 300 mm from end 1}}
    p1_port: {comedi: {channel: 1, signal: 4 to 20 mA, shunt: 250 ohm, measures: 0 to 10 bar gauge}}
    p2_port: {comedi: {channel: 2, signal: 0 to 10 V, measures: 0 to 10 bar gauge}}
    u: {comedi: {channel: 0, signal: 0 to 10 V, neutral: 5 V}}
)";
  const Rig rig = parse_rig(plain_rig + hal, "rig.yaml");
  const auto& u = *rig.hal->channels.u.comedi;
  CHECK(u.zero == -5.0);
  CHECK(u.lowest == -5.0);
  CHECK(u.highest == 5.0);
  struct Scaling {
    double scale, zero, lowest;
  };
  PerSignal<Scaling> scaled{};
  rig.hal->channels.for_each_input([&](Signal signal, const auto& channel) {
    if (channel.comedi) scaled[signal] = {channel.comedi->scale, channel.comedi->zero, channel.comedi->lowest};
  });
  CHECK(scaled[Signal::x].scale == Approx(0.03));
  CHECK(scaled[Signal::x].zero == Approx(-0.15));
  // 1 V is 0 bar gauge, 5 V is 10: 2.5 bar a volt.
  CHECK(scaled[Signal::p1_port].scale == Approx(2.5e5));
  CHECK(scaled[Signal::p1_port].zero == Approx(101325 - 2.5e5));
  CHECK(scaled[Signal::p1_port].lowest == Approx(101325 - 1e6 * 0.0125));
  CHECK(scaled[Signal::p2_port].zero == Approx(101325));
}

TEST_CASE("an inclined axis carries its weight") {
  const Rig rig = parse_rig(plain_rig + "effects: {constant_force: {incline: 30 deg}}\n", "rig.yaml");
  CHECK(rig.axis.effects.motion.constant_force.force_N == Approx(2.0 * 9.80665 * 0.5));
}

TEST_CASE("positions of a reference count from an end") {
  const Rig rig =
      parse_rig(with(plain_rig, "{kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}",
                     "{kind: waypoints, times: [0 s, 500 ms], positions: [50 mm from end 1, 50 mm from end 2]}"),
                "rig.yaml");
  CHECK(rig.reference.times_s == std::vector<double>{0.0, 0.5});
  CHECK(rig.reference.positions_m[0] == Approx(-0.1));
  CHECK(rig.reference.positions_m[1] == Approx(0.1));
}

TEST_CASE("a config in units of data sheets is dumped in SI and reads back to the same rig") {
  const Rig rig = parse_rig(
      with(with_cylinder("  bore: 40 mm\n  rod: 16 mm\n"), "pressure_Pa: 700000", "pressure: 6 bar gauge"), "rig.yaml");
  CHECK(rig.axis.supply.pressure_Pa == 701325.0);
  CHECK(same_rig(rig, parse_rig(dump_rig(rig), "dump")));
}

TEST_CASE("gauge counts from the config's own atmosphere") {
  CHECK(parse_rig(with(plain_rig, "pressure_Pa: 700000", "pressure: 6 bar gauge") +
                      "air: {atmosphere: 850 mbar absolute}\n",
                  "rig.yaml")
            .axis.supply.pressure_Pa == 685000.0);
}

TEST_CASE("all errors of a file are told at once, each with its line") {
  std::string wrong = plain_rig;
  wrong = with(wrong, "period_s: 0.001", "period_ms: 1");
  wrong = with(wrong, "pressure_Pa: 700000", "pressure: 6 bar");
  wrong = with(wrong, "critical_pressure_ratio: 0.35", "critical_pressure_ratio: 3.5");
  wrong = with(wrong, "length_m: 10.0", "length: 10");
  wrong = with(wrong, "stroke_m: 0.300", "stroke_mm: 300");
  wrong = with(wrong, "mass_kg: 2.0", "weight: 2");
  wrong = with(wrong, "kind: sine, amplitude_m: 0.080", "kind: sine, amplitude: 80");
  wrong += "tolerances: {slider.mass: 2 %}\n";
  const std::string message = refusal(wrong);
  INFO(message);
  for (const char* part :
       {"rig.yaml:4: period_ms: ", "rig.yaml:6: supply.pressure: ", "rig.yaml:11: valve.critical_pressure_ratio: ",
        "rig.yaml:13: line_1.length: ", "rig.yaml:19: cylinder.stroke_mm: ", "rig.yaml:26: slider.weight: ",
        "slider.mass_kg: found nothing", "rig.yaml:40: reference.amplitude: ", "rig.yaml:42: tolerances.slider.mass: "})
    CHECK_THAT(message, Contains(part));
  CHECK(std::count(message.begin(), message.end(), '\n') == 8);
}

TEST_CASE("contradictions of sections that read are told beside errors of others") {
  const std::string message = refusal(with(
      with(plain_rig, "length_m: 10.0", "length_m: 10.0\n  laminar_reynolds: 5000"), "mass_kg: 2.0", "mass_kg: x"));
  CHECK_THAT(message, Contains("rig.yaml:14: line_1.laminar_reynolds: ") && Contains("rig.yaml:27: slider.mass_kg: "));
}
