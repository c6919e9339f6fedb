// Values that bear their names: in lines of a log, in objects of JSON, with units, in any order.
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "config/input_error.hpp"
#include "record/motion.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

TEST_CASE("a comma in a named value is a decimal sign where another sign parts the pairs") {
  for (const char* form :
       {"t_ms={:.1f}; position_mm={:.4f}; valve_V={:.4f}", "t_ms: {:.1f} position_mm: {:.4f} valve_V: {:.4f}",
        "t_ms={:.1f}\tposition_mm={:.4f}\tvalve_V={:.4f}"})
    CHECK_THAT(check_motion(rows([&](int, double t, double x, double u) {
                 return with_comma(fmt::format(fmt::runtime(form), 1e3 * t, 1e3 * x, u));
               })),
               Contains("decimal comma"));
  check_motion(rows([](int i, double, double x, double u) {
    return fmt::format("t_ms={},position_mm={:.4f},valve_mV={}", i, 1e3 * x, std::lround(1e4 * u) * 0.1);
  }));
}

TEST_CASE("units behind named values are those of their columns") {
  for (const char* form :
       {"Time: {} ms, Position: {:.4f} mm, Valve: {:.1f} mV", "t: {} ms | pos: {:.4f} mm | valve: {:.1f} mV",
        "INFO t={}ms Position={:.4f}mm Valve={:.1f}mV", "Time: {} ms Actual Position: {:.4f} mm Valve: {:.1f} mV",
        "{{\"t\": \"{} ms\", \"position\": \"{:.4f} mm\", \"valve\": \"{:.1f} mV\"}}",
        "{{'t': '{} ms', 'x': {{'value': {:.4f}, 'unit': 'mm'}}, 'u': {{'value': {:.1f}, 'unit': 'mV'}}}}"})
    CHECK_THAT(check_motion(rows([&](int i, double, double x, double u) {
                 return fmt::format(fmt::runtime(form), i, 1e3 * x, 1e3 * u);
               })),
               Contains("units behind the values"));
  check_motion(rows([](int i, double, double x, double u) {
    return fmt::format("axis,host=plc1,unit=mm position={:.4f},valve={:.4f} {}", 1e3 * x, u,
                       1767434671000000000 + i * 1000000L);
  }));
  // Another unit of the same quantity is brought to that of the first row.
  check_motion(rows([](int i, double, double x, double u) {
    return fmt::format("t: {} ms, position: {:.7f} {}, valve: {:.4f} V", i, i > 500 ? x : 1e3 * x, i > 500 ? "m" : "mm",
                       u);
  }));
}

TEST_CASE("named values belong to their names in any order, and those that are missing are none") {
  check_motion(rows([](int i, double t, double x, double u) {
    return i % 2 == 0 ? fmt::format("t={:.3f} position={:.7f} valve={:.4f}", t, x, u)
                      : fmt::format("t={:.3f} valve={:.4f} position={:.7f}", t, u, x);
  }));
  const Understood found = understood(rows([](int i, double t, double x, double u) {
    if (i % 4 == 1) return fmt::format("{{\"t\": {:.3f}, \"position\": {:.7f}, \"valve\": null}}", t, x);
    if (i % 4 == 2) return fmt::format("{{\"position\": {:.7f}, \"t\": {:.3f}}}", x, t);
    return fmt::format("{{\"t\": {:.3f}, \"valve\": {:.4f}, \"position\": {:.7f}{}}}", t, u, x,
                       i == 1000 ? ", \"fault\": 3" : "");
  }));
  REQUIRE(found.run.rows() == row_count);
  for (int i = 0; i < row_count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    REQUIRE(found.run.column("x_m")[at] == Approx(x_m_at(i)).margin(1e-9));
    REQUIRE(std::isnan(found.run.column("u_V")[at]) == (i % 4 == 1 || i % 4 == 2));
    if (i % 4 == 3) REQUIRE(found.run.column("u_V")[at] == Approx(u_V_at(i)).margin(1e-9));
  }
  CHECK_THAT(found.told, Contains("1 line names also fault") && Contains("left out"));
}

TEST_CASE("lines that name different values in turn are no rows of one table") {
  const TemporaryFolder folder;
  const std::string path =
      put_plain(folder.file("f.log"), rows([](int, double t, double x, double u) {
                  return fmt::format("t={0:.3f} position={1:.7f}\nt={0:.3f} valve={2:.4f}", t, x, u);
                }));
  std::string said;
  try {
    recordings_in(read_table(path), import_map(guess_columns(read_table(path))), interval_s);
  } catch (const InputError& error) { said = error.what(); }
  CHECK_THAT(said, Contains("f.log") && Contains("t=0.000 position"));
}

TEST_CASE("values in objects inside of an object bear the path to them") {
  const Understood found = understood(rows([](int, double t, double x, double u) {
    return fmt::format(
        "{{\"t\": {:.3f}, \"position\": {{\"set\": {:.7f}, \"act\": {:.7f}}}, \"axis\": {{\"valve\": {:.4f}}}, "
        "\"p\": [500000, 600000]}}",
        t, x + 0.01, x, u);
  }));
  REQUIRE(found.columns.size() == 6);
  CHECK(found.columns[2].ours == "x_m");
  CHECK(found.run.column("x_m")[100] == Approx(x_m_at(100)));
  CHECK(found.run.column("x_ref_m")[100] == Approx(x_m_at(100) + 0.01));
  CHECK(found.run.column("u_V")[100] == Approx(u_V_at(100)));
  CHECK(found.run.column("p2_port_Pa")[100] == Approx(600000));
  const Understood set_first = understood(rows([](int, double t, double x, double u) {
    return fmt::format("{{\"t\": {:.3f}, \"setpoint\": {{\"position\": {:.7f}}}, \"actual\": {{\"position\": {:.7f}}}, "
                       "\"valve\": {:.4f}}}",
                       t, x + 0.01, x, u);
  }));
  CHECK(set_first.run.column("x_m")[100] == Approx(x_m_at(100)));
  CHECK(set_first.run.column("x_ref_m")[100] == Approx(x_m_at(100) + 0.01));
  check_motion(rows([](int i, double, double x, double u) {
    const std::string stamp = fmt::format("2026-01-03T10:11:{:02}.{:03}Z", i / 1000, i % 1000);
    return fmt::format("{{\"ts\":\"{0}\",\"data\":{{\"name\":\"position\",\"value\":{1:.7f}}}}}\n"
                       "{{\"ts\":\"{0}\",\"data\":{{\"name\":\"valve\",\"value\":{2:.4f}}}}}",
                       stamp, x, u);
  }));
  const auto object = [](int, double t, double x, double u) {
    return fmt::format("{{\"t\": {:.3f}, \"position\": {:.7f}, \"valve\": {:.4f}, \"reserve\": NaN}},", t, x, u);
  };
  std::string list = "[\n" + rows(object);
  list.resize(list.size() - 2);
  check_motion(list + "\n]\n");
}

TEST_CASE("a stamp stands before or behind named values, as a clock, a number or a value") {
  const auto with = [](const std::function<std::string(int, const std::string&)>& line) {
    return check_motion(rows([&](int i, double, double x, double u) {
      return line(i, fmt::format("position_mm={:.4f} valve={:.4f}", 1e3 * x, u));
    }));
  };
  const auto clock = [](int i) { return fmt::format("10:11:{:02}.{:03}", i / 1000, i % 1000); };
  with([](int i, const std::string& pairs) { return fmt::format("I ({}) axis: {}", 5000 + i, pairs); });
  with([](int i, const std::string& pairs) { return fmt::format("[{:12.6f}] axis: {}", 12.5 + 1e-3 * i, pairs); });
  with([](int i, const std::string& pairs) {
    return fmt::format("[INFO] [{}.{:03}] [axis]: {}", 1767434671 + i / 1000, i % 1000, pairs);
  });
  with([](int i, const std::string& pairs) { return fmt::format("{} ms: {}", i, pairs); });
  with([](int i, const std::string& pairs) {
    return fmt::format("({}.{:03}) can0 181 [4] 80 4A 0{} 00 :: Axis({})", 1767434671 + i / 1000, i % 1000, i % 10,
                       pairs);
  });
  with([&](int i, const std::string& pairs) { return "Jan 03 " + clock(i) + " plc axis[123]: " + pairs; });
  with(
      [&](int i, const std::string& pairs) { return "<134>1 2026-01-03T" + clock(i) + "Z plc axis 123 - - " + pairs; });
  with([&](int i, const std::string& pairs) { return "I0103 " + clock(i) + " 1234 axis.cc:87] " + pairs; });
  with([&](int i, const std::string& pairs) { return "INFO:axis:2026-01-03 " + clock(i) + " " + pairs; });
  with([&](int i, const std::string& pairs) { return "ts=2026-01-03T" + clock(i) + "Z level=info " + pairs; });
  with([&](int i, const std::string& pairs) { return pairs + " @ " + clock(i); });
}

TEST_CASE("signs of a terminal and form feeds are no part of a text") {
  check_motion("\ft_ms,position_mm,valve\n" + rows([](int i, double, double x, double u) {
                 return fmt::format("\x1b[0;32m{},{:.4f},{:.4f}\x1b[0m", i, 1e3 * x, u);
               }));
  check_motion(rows([](int i, double, double x, double u) {
    return fmt::format("\x1b[1mt_ms={}\x1b[0m position_mm={:.4f} \x1b[33mvalve={:.4f}\x1b[0m", i, 1e3 * x, u);
  }));
}
