// Long tables: a row for each value, with the name of its channel.
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/motion.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

/// Two rows a time: of the position [mm] and of the command [V].
std::string long_rows(const std::function<std::string(int, double, const char*, double, const char*)>& row,
                      const char* position = "Position", const char* command = "Valve") {
  return rows([&](int i, double t, double x, double u) {
    return row(i, t, position, 1e3 * x, "mm") + "\n" + row(i, t, command, u, "V");
  });
}

}  // namespace

TEST_CASE("a long table has a column for each channel") {
  CHECK_THAT(check_motion("time,channel,value,unit\n" +
                          long_rows([](int, double t, const char* name, double v, const char* unit) {
                            return fmt::format("{:.3f},{},{:.4f},{}", t, name, v, unit);
                          })),
             Contains("a long table") && Contains("2 channels by channel") && Contains("units from unit"));
  check_motion("timestamp;tag;value;unit;quality\n" +
               long_rows([](int i, double, const char* name, double v, const char* unit) {
                 return fmt::format("2026-01-03T10:11:{:02}.{:03}Z;", i / 1000, i % 1000) +
                        with_comma(fmt::format("{};{:.4f};{};Good", name, v, unit));
               }));
  // The name first, the position's unit in it.
  check_motion("VarName\tTimeString\tVarValue\n" +
               long_rows(
                   [](int i, double, const char* name, double v, const char*) {
                     return fmt::format("\"{}\"\t\"2026-01-03 10:11:{:02}.{:03}\"\t{:.4f}", name, i / 1000, i % 1000,
                                        v);
                   },
                   "Axis.Position [mm]", "Axis.Valve [V]"));
  // Day and time of the day apart.
  check_motion("Date;Time;Tag;Value;Unit\n" +
               long_rows([](int i, double, const char* name, double v, const char* unit) {
                 return fmt::format("03.01.2026;10:11:{:02}.{:03};{};{:.4f};{}", i / 1000, i % 1000, name, v, unit);
               }));
}

TEST_CASE("long tables of databases, middleware and servers") {
  check_motion("#group,false,false,true,true,false,false,true,true\n"
               "#datatype,string,long,dateTime:RFC3339,dateTime:RFC3339,dateTime:RFC3339,double,string,string\n"
               "#default,_result,,,,,,,\n"
               ",result,table,_start,_stop,_time,_value,_field,_measurement\n" +
               long_rows(
                   [](int i, double, const char* name, double v, const char*) {
                     return fmt::format(",,0,2026-01-03T00:00:00Z,2026-01-04T00:00:00Z,2026-01-03T10:11:{:02}.{:03}Z,"
                                        "{:.4f},{},axis",
                                        i / 1000, i % 1000, v, name);
                   },
                   "position_mm", "valve_V"));
  // mosquitto_sub with a stamp and a topic before the payload
  check_motion(long_rows(
      [](int i, double, const char* name, double v, const char*) {
        return fmt::format("2026-01-03T10:11:{:02}.{:03}+0100 {} {:.4f}", i / 1000, i % 1000, name, v);
      },
      "plant/axis/position_mm", "plant/axis/valve_V"));
  check_motion("NodeId,SourceTimestamp,ServerTimestamp,Value,StatusCode\n" +
               long_rows(
                   [](int i, double, const char* name, double v, const char*) {
                     const std::string stamp = fmt::format("2026-01-03T10:11:{:02}.{:03}Z", i / 1000, i % 1000);
                     return fmt::format("ns=2;s={},{},{},{:.4f},Good", name, stamp, stamp, v);
                   },
                   "Axis.Position_mm", "Axis.Valve"));
}

TEST_CASE("rows of a long table in any order are put in theirs, and stamps that repeat are told") {
  std::vector<std::string> lines;
  for (int i = 0; i < row_count; ++i) {
    lines.push_back(fmt::format("{:.3f},position,{:.7f}", i * interval_s, x_m_at(i)));
    lines.push_back(fmt::format("{:.3f},valve,{:.4f}", i * interval_s, u_V_at(i)));
  }
  const auto text = [&] {
    std::string out = "time,name,value\n";
    for (const std::string& line : lines) out += line + "\n";
    return out;
  };
  std::stable_sort(lines.begin(), lines.end(), [](const std::string& a, const std::string& b) {
    return a.substr(a.find(',')).starts_with(",p") && !b.substr(b.find(',')).starts_with(",p");
  });
  check_motion(text());  // channel behind channel
  const unsigned seed = 20260103;
  CAPTURE(seed);
  std::shuffle(lines.begin(), lines.end(), std::mt19937(seed));
  CHECK_THAT(check_motion(text()), Contains("put in order"));
  lines.push_back(lines.front());
  CHECK_THAT(check_motion(text()), Contains("1 values have the time of another"));
}

TEST_CASE("channels of a long table that were asked one after the other come to one grid") {
  const Understood found = understood("time,channel,value\n" + rows([](int, double t, double, double) {
                                        return fmt::format("{:.6f},valve,{:.6f}\n{:.6f},position,{:.9f}", t, t,
                                                           t + 0.0004, 2 * (t + 0.0004));
                                      }));
  REQUIRE(found.run.rows() == row_count);
  CHECK(found.run.column("u_V")[1000] == Approx(1.0));
  CHECK(found.run.column("x_m")[1000] == Approx(2.0));
}

TEST_CASE("values that a server calls bad, or that are none, are left out and told") {
  const Understood found = understood("time,tag,value,quality\n" + rows([](int i, double t, double x, double u) {
                                        const std::string value = i == 11 ? "No Data" : fmt::format("{:.7f}", x);
                                        return fmt::format("{0:.3f},position,{1},{2}\n{0:.3f},valve,{3:.4f},Good", t,
                                                           value, i == 10 ? "Bad" : "Good", u);
                                      }));
  REQUIRE(found.run.rows() == row_count);
  CHECK(std::isnan(found.run.column("x_m")[10]));
  CHECK(std::isnan(found.run.column("x_m")[11]));
  CHECK(found.run.column("x_m")[12] == Approx(x_m_at(12)));
  CHECK_THAT(found.told,
             Contains("1 rows say bad in quality") && Contains("1 values are no number, such as \"No Data\""));
}

TEST_CASE("a table with a column of states beside its values is no long one") {
  CHECK_THAT(check_motion("t,position,valve,mode\n" + rows([](int i, double t, double x, double u) {
                            return fmt::format("{:.3f},{:.7f},{:.4f},{}", t, x, u, i % 2 == 0 ? "auto" : "hand");
                          })),
             !Contains("long table"));
  const Understood found = understood("t_s,x_m,state\n" + rows([](int i, double t, double x, double) {
                                        return fmt::format("{:.3f},{:.7f},{}", t, x, i / 700 % 2 == 0 ? "run" : "rest");
                                      }));
  CHECK(found.run.rows() == row_count);
  CHECK_THAT(found.told, !Contains("long table"));
}

TEST_CASE("messages as objects of JSON a line are a long table") {
  CHECK_THAT(check_motion(long_rows(
                 [](int i, double, const char* name, double v, const char*) {
                   return fmt::format(
                       "{{\"topic\":\"{}\",\"payload\":{:.4f},\"ts\":\"2026-01-03T10:11:{:02}.{:03}Z\"}}", name, v,
                       i / 1000, i % 1000);
                 },
                 "axis/position_mm", "axis/valve")),
             Contains("a long table"));
}

TEST_CASE("rows of several axes with the same values each are columns of each axis") {
  const Understood found =
      understood("time,axis,position,valve\n" + rows([](int, double t, double x, double u) {
                   return fmt::format("{0:.3f},A,{1:.7f},{2:.4f}\n{0:.3f},B,{3:.7f},{4:.4f}", t, x, u, -x, -u);
                 }));
  REQUIRE(found.run.rows() == row_count);
  CHECK(found.columns[1].column == "A/position");
  CHECK(found.run.column("x_m")[100] == Approx(x_m_at(100)));
  CHECK(found.run.column("u_V")[100] == Approx(u_V_at(100)));
  CHECK_THAT(found.told, Contains("position and valve") && Contains("2 channels by axis"));
}

TEST_CASE("times in brackets or behind the value, and millionths of days") {
  check_motion(long_rows(
      [](int i, double, const char* name, double v, const char*) {
        return fmt::format("({}.{:03}) can0 {} {:.4f}", 1767434671 + i / 1000, i % 1000, name, v);
      },
      "position_mm", "valve"));
  check_motion(
      long_rows([](int i, double, const char* name, double v,
                   const char*) { return fmt::format("{}{{axis=\"1\"}} {:.4f} {}", name, v, 1767434671000 + i); },
                "position_mm", "valve"));
  const Understood found =
      understood("VarName;VarValue;Time_ms\n" + long_rows([](int i, double, const char* name, double v, const char*) {
                   return fmt::format("{};{:.4f};{:.6f}", name, v, 46025424436.5 + 1e-3 * i / 0.0864);
                 }));
  CHECK(found.run.period_s == Approx(0.001).epsilon(1e-3));
}

TEST_CASE("a row of a long table counts in its own unit") {
  const auto written = [](const char* other, double factor) {
    return "time,signal,value,unit\n" + rows([&](int i, double t, double x, double u) {
             return fmt::format("{0:.3f},position,{1:.7f},{2}\n{0:.3f},valve,{3:.4f},V", t,
                                i > 700 ? factor * x : 1e3 * x, i > 700 ? other : "mm", u);
           });
  };
  CHECK_THAT(check_motion(written("cm", 100)), Contains("2299 values are in another unit"));
  const Understood found = understood(written("bar", 1));
  CHECK(found.run.column("x_m")[700] == Approx(x_m_at(700)));
  CHECK_THAT(found.told, Contains("2299 values are in a unit of another quantity, such as bar of position"));
}

TEST_CASE("qualities of OPC that are numbers say bad by their bits") {
  const auto with = [](const char* good, const char* bad) {
    const Understood found =
        understood("time,tag,value,quality\n" + rows([&](int i, double t, double x, double u) {
                     return fmt::format("{0:.3f},position,{1:.7f},{2}\n{0:.3f},valve,{3:.4f},{4}", t,
                                        i % 50 == 7 ? 9.0 : x, i % 50 == 7 ? bad : good, u, good);
                   }));
    REQUIRE(found.run.rows() == row_count);
    CHECK(std::isnan(found.run.column("x_m")[57]));
    CHECK(found.run.column("x_m")[58] == Approx(x_m_at(58)));
    CHECK_THAT(found.told, Contains("60 rows say bad in quality"));
  };
  with("192", "0");
  with("216", "24");
  with("0x00000000", "0x80000000");
  with("0", "2156527616");
  with("Good", "Error");
}
