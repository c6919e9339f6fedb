// Bad configs: each mistake is refused in one sentence that names file, line, key, what was found and what is expected.
#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <unistd.h>

#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "config/test_rigs.hpp"

using namespace pneuservo;
using test::accepted;
using test::plain_rig;
using test::refusal;
using test::with;
namespace fs = std::filesystem;

namespace {

std::string file_refusal(const fs::path& file) {
  try {
    read_rig(file);
  } catch (const InputError& error) { return error.what(); }
  return "";
}

struct ScratchFolder {
  fs::path path = fs::temp_directory_path() / ("pneuservo_config_test_" + std::to_string(::getpid()));
  ScratchFolder() { fs::create_directories(path); }
  ~ScratchFolder() { fs::remove_all(path); }
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path / name, std::ios::binary) << text;
    return path / name;
  }
};

}  // namespace

TEST_CASE("the plain config of these tests reads") { REQUIRE(refusal(plain_rig) == accepted); }

TEST_CASE("unknown keys are refused with the nearest known one") {
  CHECK(refusal(with(plain_rig, "  command_max_V", "  comand_max_V")) ==
        "rig.yaml:8: valve.comand_max_V: found an unknown key, expected a known one (did you mean command_max_V?)");
  CHECK(refusal(with(plain_rig, "supply:", "suply:")) ==
        "rig.yaml:5: suply: found an unknown key, expected a known one (did you mean supply?)");
  CHECK(refusal(with(plain_rig, "  mass_kg: 2.0", "  mass_kg: 2.0\n  colour: red")) ==
        "rig.yaml:27: slider.colour: found an unknown key, expected one of mass_kg, payload_kg, "
        "viscous_friction_Ns_per_m");
  CHECK(refusal(with(plain_rig, "frequency_Hz: 1.0", "frequency_Hz: 1.0, ramps_s: 1")) ==
        "rig.yaml:40: reference.ramps_s: found an unknown key, expected a known one (did you mean ramp_s?)");
  CHECK(refusal(with(plain_rig, "kind: sine, amplitude_m: 0.080", "knid: sine, amplitude_m: 0.080")) ==
        "rig.yaml:40: reference.knid: found an unknown key, expected a known one (did you mean kind?)");
}

TEST_CASE("a key with another unit is refused with the right one") {
  CHECK(
      refusal(with(plain_rig, "length_m: 10.0", "length_mm: 10000")) ==
      "rig.yaml:13: line_1.length_mm: found an unknown key, expected the key length_m (in m), or length with its unit");
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length: 10")) ==
        "rig.yaml:13: line_1.length: found '10', expected a number with its unit (mm), or the key length_m");
  CHECK(refusal(with(plain_rig, "pressure_Pa: 700000", "pressure_bar: 7")) ==
        "rig.yaml:6: supply.pressure_bar: found an unknown key, expected the key pressure_Pa (in Pa), or pressure with "
        "its unit");
  CHECK(refusal(with(plain_rig, "area_per_volt_m2_per_V: 2.6e-6", "area_per_volt_mm2_per_V: 2.6")) ==
        "rig.yaml:9: valve.area_per_volt_mm2_per_V: found an unknown key, expected the key area_per_volt_m2_per_V (in "
        "m2/V), or area_per_volt with its unit");
  CHECK(refusal(with(plain_rig, "velocity_gain_Ns_per_m", "velocity_gain_Ns_per_mm")) ==
        "rig.yaml:37: controller.velocity_gain_Ns_per_mm: found an unknown key, expected the key "
        "velocity_gain_Ns_per_m (in N s/m), or velocity_gain with its unit");
  CHECK(refusal(with(plain_rig, "frequency_Hz: 1.0", "frequency_rad_per_s: 6.28")) ==
        "rig.yaml:40: reference.frequency_rad_per_s: found an unknown key, expected the key frequency_Hz (in Hz), or "
        "frequency with its unit");
  CHECK(refusal(with(plain_rig, "period_s: 0.001", "period_ms: 1")) ==
        "rig.yaml:4: period_ms: found an unknown key, expected the key period_s (in s), or period with its unit");
}

TEST_CASE("missing keys are refused at the line of their section") {
  CHECK(refusal(with(plain_rig, "  diameter_m: 0.00765\nline_2", "line_2")) ==
        "rig.yaml:13: line_1.diameter_m: found nothing, expected a number in m, 0.0005 to 0.05");
  CHECK(refusal(with(plain_rig, "name: plain\n", "")) == "rig.yaml:1: name: found nothing, expected this required key");
  CHECK(refusal(with(plain_rig, "format: pneuservo-rig/1\n", "")) ==
        "rig.yaml:1: format: found nothing, expected this required key");
  CHECK(refusal(with(plain_rig, "supply:\n  pressure_Pa: 700000\n", "")) ==
        "rig.yaml:1: supply: found nothing, expected this required section");
  CHECK(refusal(with(plain_rig, "pressure_source: estimated\n  ", "")) ==
        "rig.yaml:34: controller.pressure_source: found nothing, expected one of valve, chamber, estimated, "
        "differential");
  CHECK(refusal(with(plain_rig, "kind: sine, ", "")) ==
        "rig.yaml:40: reference.kind: found nothing, expected one of sine, "
        "multisine, waypoints, sum, cruise, minimum_jerk, file, live");
}

TEST_CASE("wrong types are refused") {
  const std::string length = "a number in m, 0.01 to 100";
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: long")) ==
        "rig.yaml:13: line_1.length_m: found 'long', expected " + length);
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: '10'")) ==
        "rig.yaml:13: line_1.length_m: found the quoted text \"10\", expected " + length);
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: 10 m")) ==
        "rig.yaml:13: line_1.length_m: found '10 m', expected " + length + "; with a unit the key is length");
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: 10,0")) ==
        "rig.yaml:13: line_1.length_m: found '10,0', expected " + length);
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: 0x10")) ==
        "rig.yaml:13: line_1.length_m: found '0x10', expected " + length);
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: [10, 5]")) ==
        "rig.yaml:13: line_1.length_m: found a list, expected " + length);
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m: {value: 10}")) ==
        "rig.yaml:13: line_1.length_m: found a map of keys, expected " + length);
  CHECK(refusal(with(plain_rig, "length_m: 10.0", "length_m:")) ==
        "rig.yaml:13: line_1.length_m: found nothing, expected " + length);
  CHECK(refusal(with(plain_rig, "supply:\n  pressure_Pa: 700000", "supply: [700000]")) ==
        "rig.yaml:5: supply: found a list, expected a map of keys");
  CHECK(refusal(with(plain_rig, "supply:\n  pressure_Pa: 700000", "supply: 700000")) ==
        "rig.yaml:5: supply: found '700000', expected a map of keys");
  CHECK(refusal(with(plain_rig, "kind: pd_force", "kind: pd_force\n  flow_feedforward: 1")) ==
        "rig.yaml:35: controller.flow_feedforward: found '1', expected one of off, formula, pass");
  CHECK(refusal(plain_rig + "seed: -1\n") ==
        "rig.yaml:42: seed: found '-1', expected a whole number from 0 to 18446744073709551615");
  CHECK(refusal(plain_rig + "seed: 1.5\n") ==
        "rig.yaml:42: seed: found '1.5', expected a whole number from 0 to 18446744073709551615");
  CHECK(refusal(with(plain_rig, "name: plain", "name: [a]")) == "rig.yaml:2: name: found a list, expected a text");
  CHECK(refusal(with(plain_rig, "name: plain", "name: ''")) ==
        "rig.yaml:2: name: found an empty text, expected a text");
  CHECK(refusal(with(plain_rig, "{kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}", "sine")) ==
        "rig.yaml:40: reference: found 'sine', expected a map of keys");
}

TEST_CASE("impossible values are refused") {
  const std::string mass = "a number in kg, 0.001 to 10000";
  CHECK(refusal(with(plain_rig, "mass_kg: 2.0", "mass_kg: -2.0")) ==
        "rig.yaml:26: slider.mass_kg: found -2.0, expected " + mass);
  CHECK(refusal(with(plain_rig, "mass_kg: 2.0", "mass_kg: .nan")) ==
        "rig.yaml:26: slider.mass_kg: found .nan, expected " + mass);
  CHECK(refusal(with(plain_rig, "mass_kg: 2.0", "mass_kg: .inf")) ==
        "rig.yaml:26: slider.mass_kg: found .inf, expected " + mass);
  CHECK(refusal(with(plain_rig, "mass_kg: 2.0", "mass_kg: nan")) ==
        "rig.yaml:26: slider.mass_kg: found 'nan', expected " + mass);
  CHECK(refusal(with(plain_rig, "mass_kg: 2.0", "mass_kg: 1e400")) ==
        "rig.yaml:26: slider.mass_kg: found '1e400', expected " + mass);
  CHECK(refusal(with(plain_rig, "period_s: 0.001", "period_s: 1.0")) ==
        "rig.yaml:4: period_s: found 1.0, expected a number in s, 1.0e-05 to 0.1");
  CHECK(refusal(with(plain_rig, "kind: pd_force", "kind: pd_force\n  command_rate_V_per_s: -.inf")) ==
        "rig.yaml:35: controller.command_rate_V_per_s: found -.inf, expected a number in V/s, at least 1.0e-06");
}

TEST_CASE("other formats, rigs and controllers are refused with the known ones") {
  CHECK(refusal(with(plain_rig, "pneuservo-rig/1", "pneuservo-rig/2")) ==
        "rig.yaml:1: format: found 'pneuservo-rig/2', expected pneuservo-rig/1");
  CHECK(refusal(with(plain_rig, "rig: cylinder", "rig: gantry")) ==
        "rig.yaml:3: rig: found 'gantry', expected one of cylinder, servo_table, driven_axis, vessel, "
        "switched_cylinder, pressure");
  CHECK(refusal(with(plain_rig, "rig: cylinder", "rig: servo_table")) ==
        "rig.yaml:34: controller.kind: found pd_force, expected ppd2, the law of a servo_table");
  CHECK(refusal(with(plain_rig, "kind: pd_force\n", "kind: lqr\n")) ==
        "rig.yaml:34: controller.kind: found 'lqr', expected one of pd_force, ppd2, pressure_pi");
  CHECK(refusal(with(plain_rig, "estimated", "measured")) ==
        "rig.yaml:35: controller.pressure_source: found 'measured', expected one of valve, chamber, estimated, "
        "differential");
  CHECK(refusal(with(plain_rig, "kind: sine", "kind: square")) ==
        "rig.yaml:40: reference.kind: found 'square', expected one of sine, multisine, waypoints, sum, cruise, "
        "minimum_jerk, file, live");
}

TEST_CASE("a key that stands twice is refused with both lines") {
  CHECK(refusal(with(plain_rig, "  mass_kg: 2.0", "  mass_kg: 2.0\n  mass_kg: 2.5")) ==
        "rig.yaml:27: slider.mass_kg: found the key a second time (the first is at rig.yaml:26), expected every key "
        "once");
  CHECK(refusal(plain_rig + "supply: {pressure_Pa: 600000}\n") ==
        "rig.yaml:42: supply: found the key a second time (the first is at rig.yaml:5), expected every key once");
  CHECK(refusal(plain_rig + "effects: {coulomb_friction: {force_N: 1}, coulomb_friction: {force_N: 2}}\n") ==
        "rig.yaml:42: effects.coulomb_friction: found the key a second time (the first is at rig.yaml:42), expected "
        "every key once");
}

TEST_CASE("what is no config at all is refused") {
  for (const char* front : {"\t", "  \t", " \t "})
    CHECK(refusal(with(plain_rig, "  mass_kg: 2.0", front + std::string("mass_kg: 2.0"))) ==
          "rig.yaml:26: (file): found a tab at the front of the line, expected blanks instead, two for each step: YAML "
          "takes no tabs");
  CHECK(refusal(with(plain_rig, "mass_kg: 2.0\n", "mass_kg: 2.0\n   payload_kg: 1.0\n")) ==
        "rig.yaml:27: (file): found a line that begins with 3 blanks, behind one with 2, expected the keys of one "
        "section behind the same number of blanks");
  CHECK_THAT(refusal("a: [1, 2\nb: }"), Catch::StartsWith("rig.yaml:2: (file): found text that is not YAML ("));
  CHECK(refusal("") == "rig.yaml:1: (file): found nothing, expected a config in YAML (docs/config-keys.md)");
  CHECK_THAT(refusal("# only a comment\n"), Catch::Contains("rig.yaml") && Catch::Contains("found nothing"));
  CHECK(refusal("just words") == "rig.yaml:1: (top): found 'just words', expected a map of keys");
  CHECK(refusal("- a\n- b\n") == "rig.yaml:1: (top): found a list, expected a map of keys");
  // The parser itself would find documents without end here.
  CHECK(refusal(", a\n" + plain_rig) ==
        "rig.yaml:1: (file): found text that is not YAML (a sign where a key should be), "
        "expected a config in YAML (docs/config-keys.md)");
  CHECK(refusal(plain_rig + "---\n" + plain_rig) ==
        "rig.yaml:42: (file): found a second YAML document, expected one document");
  CHECK(refusal(plain_rig + "? [a, b]\n: 1\n") ==
        "rig.yaml:42: (top): found a key that is not plain text, expected a name as key");
  std::string bomb = "a0: &a0 [1]\n";
  for (int i = 1; i < 12; ++i) {
    const std::string last = "*a" + std::to_string(i - 1) + ", ";
    std::string ten;
    for (int k = 0; k < 10; ++k) ten += last;
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + ten + "1]\n";
  }
  CHECK_THAT(refusal(bomb), Catch::Contains("found nesting or aliases without end"));
}

TEST_CASE("files that cannot be read are refused by their name") {
  const ScratchFolder folder;
  const std::string expected = ", expected a config file (docs/config-keys.md)";
  const fs::path missing = folder.path / "missing.yaml";
  CHECK(file_refusal(missing) == missing.string() + ": (file): found no such file" + expected);
  CHECK(file_refusal(folder.path) == folder.path.string() + ": (file): found a folder" + expected);
  const fs::path empty = folder.write("empty.yaml", "");
  CHECK(file_refusal(empty) ==
        empty.string() + ":1: (file): found nothing, expected a config in YAML (docs/config-keys.md)");
  const fs::path packed = folder.write("packed.yaml", "\x1f\x8b\x08");
  CHECK(file_refusal(packed) == packed.string() + ":1: (file): found compressed data" + expected);
  const fs::path wrong = folder.write("wrong.yaml", with(plain_rig, "mass_kg: 2.0", "mass_kg: 0"));
  CHECK(file_refusal(wrong) ==
        wrong.string() + ":26: slider.mass_kg: found 0, expected a number in kg, 0.001 to 10000");
  const fs::path locked = folder.write("locked.yaml", plain_rig);
  fs::permissions(locked, fs::perms::none);
  if (::access(locked.c_str(), R_OK) == 0) WARN("SKIPPED the unreadable file: this user may read everything");
  else
    CHECK(file_refusal(locked) ==
          locked.string() + ": (file): found an unreadable file (Permission denied)" + expected);
}

TEST_CASE("unknown effects and their parameters are refused with near names") {
  CHECK(refusal(plain_rig + "effects: {coulomb_fricton: {force_N: 3}}\n") ==
        "rig.yaml:42: effects.coulomb_fricton: found an unknown effect, expected a known one (did you mean "
        "coulomb_friction?)");
  CHECK(refusal(plain_rig + "effects: {chamber_leak: {area_m2: 1e-8}}\n") ==
        "rig.yaml:42: effects.chamber_leak: found an unknown effect, expected a known one (did you mean "
        "chamber_leak_1, chamber_leak_2?)");
  CHECK_THAT(refusal(plain_rig + "effects: {sensor_offset:p3_port: {offset: 100}}\n"),
             Catch::Contains("effects.sensor_offset:p3_port: found an unknown effect") &&
                 Catch::Contains("sensor_offset:p1_port"));
  CHECK_THAT(refusal(plain_rig + "effects: {magnetism: {}}\n"), Catch::Contains("expected one of coulomb_friction, ") &&
                                                                    Catch::Contains("piston_leak, ") &&
                                                                    Catch::Contains("sensor_lag:x"));
  CHECK(refusal(plain_rig + "effects:\n  piston_leak: {area_mm2: 1}\n") ==
        "rig.yaml:43: effects.piston_leak.area_mm2: found an unknown key, expected the key area_m2 (in m2), or area "
        "with its unit");
  CHECK(refusal(plain_rig + "effects:\n  line_leak_1: {area_m2: 1e-8}\n") ==
        "rig.yaml:43: effects.line_leak_1.position: found nothing, expected a number, 0 to 1");
  CHECK(refusal(plain_rig + "effects:\n  valve_asymmetry: 2\n") ==
        "rig.yaml:43: effects.valve_asymmetry: found '2', expected a map of keys");
  CHECK(refusal(plain_rig + "effects:\n  sensor_gain:x: {gain: 200}\n") ==
        "rig.yaml:43: effects.sensor_gain:x.gain: found 200, expected a number, -100 to 100");
}

TEST_CASE("deviations of anything but numbers of the plant are refused") {
  CHECK_THAT(refusal(plain_rig + "deviations:\n  slider.mas_kg: 0.02\n"),
             Catch::Contains("deviations.slider.mas_kg: found a path that names no number of this rig"));
  CHECK_THAT(refusal(plain_rig + "deviations:\n  period_s: 0.02\n"),
             Catch::Contains("deviations.period_s: found a number of no part of the plant"));
  CHECK_THAT(refusal(plain_rig, {"deviations.effects.coulomb_friction.force_N=0.1"}),
             Catch::Contains("deviations.effects.coulomb_friction.force_N: found a number that is 0"));
}

TEST_CASE("tolerances of unknown paths are refused") {
  CHECK(refusal(plain_rig + "tolerances:\n  slider.mas_kg: 0.02\n") ==
        "rig.yaml:43: tolerances.slider.mas_kg: found a path that names no number of this rig, "
        "expected a known path (did you mean slider.mass_kg?)");
  CHECK(refusal(plain_rig + "tolerances:\n  effects.coulomb_friction.force: 0.02\n") ==
        "rig.yaml:43: tolerances.effects.coulomb_friction.force: found a path that names no number of this rig, "
        "expected a known path (did you mean effects.coulomb_friction.force_N, effects.elastic_friction.force_N?)");
  CHECK(refusal(plain_rig + "tolerances:\n  slider.mass_kg: -0.02\n") ==
        "rig.yaml:43: tolerances.slider.mass_kg: found -0.02, expected a number, 0 to 10");
  CHECK_THAT(refusal(plain_rig + "tolerances:\n  name: 0.02\n"),
             Catch::Contains("tolerances.name: found a path that names no number"));
}

TEST_CASE("mistakes of --set name the --set") {
  CHECK(refusal(plain_rig, {"line_1.length_m=abc"}) ==
        "--set line_1.length_m=abc: line_1.length_m: found 'abc', expected a number in m, 0.01 to 100");
  CHECK(
      refusal(plain_rig, {"line_1.lenght_m=5"}) ==
      "--set line_1.lenght_m=5: line_1.lenght_m: found an unknown key, expected a known one (did you mean length_m?)");
  CHECK(refusal(plain_rig, {"lin_1.length_m=5"}) ==
        "--set lin_1.length_m=5: lin_1: found an unknown key, expected a known one (did you mean line_1, line_2?)");
  CHECK(refusal(plain_rig, {"line_1.length_mm=5000"}) ==
        "--set line_1.length_mm=5000: line_1.length_mm: found an unknown "
        "key, expected the key length_m (in m), or length with its unit");
  CHECK(refusal(plain_rig, {"effects.coulomb_friction.force_N=-3"}) ==
        "--set effects.coulomb_friction.force_N=-3: effects.coulomb_friction.force_N: found -3, expected a number in "
        "N, 0 to 100000");
  CHECK(refusal(plain_rig, {"period_s"}) ==
        "--set period_s: (path): found 'period_s', expected PATH=VALUE, as in line_1.length_m=5");
  CHECK(refusal(plain_rig, {"=5"}) == "--set =5: (path): found '=5', expected PATH=VALUE, as in line_1.length_m=5");
  CHECK(refusal(plain_rig, {"period_s="}) ==
        "--set period_s=: period_s: found nothing, expected a value in YAML after the =");
  CHECK(refusal(plain_rig, {"line_1..length_m=5"}) ==
        "--set line_1..length_m=5: line_1..length_m: found an empty name in "
        "the path, expected names with single dots between");
  CHECK(refusal(plain_rig, {"period_s.value=5"}) ==
        "--set period_s.value=5: period_s.value: found '0.001' at the place of a section, expected the path of a key");
  CHECK_THAT(refusal(plain_rig, {"reference={kind: sine"}),
             Catch::StartsWith("--set reference={kind: sine: reference: found text that is not YAML ("));
  CHECK(refusal(plain_rig, {"tolerances.slider.mas_kg=0.1"}) ==
        "--set tolerances.slider.mas_kg=0.1: tolerances.slider.mas_kg: found a path that names no number of this rig, "
        "expected a known path (did you mean slider.mass_kg?)");
  const std::string points = with(plain_rig, "{kind: sine, amplitude_m: 0.080, frequency_Hz: 1.0}",
                                  "{kind: waypoints, times_s: [0, 1], positions_m: [0, 0.1]}");
  CHECK(refusal(points, {"reference.times_s.2=2"}) ==
        "--set reference.times_s.2=2: reference.times_s.2: found no item 2 there, expected an index from 0 to 1");
}
