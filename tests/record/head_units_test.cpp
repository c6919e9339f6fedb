// Units that the head states in words, and commands in per cent.
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "record/files.hpp"
#include "record/foreign/column_guess.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

struct Read {
  std::vector<ColumnGuess> columns;
  std::string told;
};

Read read_with(const std::string& head, const std::string& names = "t,x,u,p1,p2") {
  const TemporaryFolder folder;
  const CsvTable table =
      read_table(put_plain(folder.file("f.csv"),
                           head + "\n" + names + "\n0,10.5,1.5,4.5,5.5\n0.001,11.5,2.5,4.75,5.25\n0.002,12.5,3,5,5\n"));
  Read out{guess_columns(table), ""};
  for (const std::string& line : problem_lines(table)) out.told += line + "\n";
  return out;
}

}  // namespace

TEST_CASE("a line of the head states units in words") {
  for (const char* head :
       {"# t in s, x in mm, u in V, p1 and p2 in bar", "# Units: t in s, x in mm, u in V, p1, p2 in bar",
        "# x: mm\n# u: V\n# p1: bar\n# p2: bar", "# x=mm; u=V; p1=bar; p2=bar", "# x [mm], u [V], p1 [bar], p2 [bar]",
        "# units: s, mm, V, bar, bar", "# Einheiten: Weg in mm, Dr\u00fccke in bar\n# Einheit: s;mm;V;bar;bar",
        "% units: s mm V bar bar", "# all pressures in bar, positions in mm",
        "# positions are in mm, pressures are in bar.", "# x (mm), p1 (bar), p2 (bar)"}) {
    CAPTURE(head);
    const Read found = read_with(head);
    CHECK(found.columns[1].factor == Approx(1e-3));
    CHECK(found.columns[3].factor == Approx(1e5));
    CHECK(found.columns[4].factor == Approx(1e5));
    CHECK(found.columns[3].offset == 0);
    CHECK_THAT(found.told, Contains("units by the head") && Contains("x in mm"));
  }
  for (const char* head : {"# all pressures in bar gauge", "# p1 and p2 in bar, gauge", "# pressures in bar (gauge)",
                           "# p1: barg\n# p2: bar rel"}) {
    CAPTURE(head);
    const Read found = read_with(head);
    for (const std::size_t c : {3u, 4u}) {
      CHECK(found.columns[c].factor == Approx(1e5));
      CHECK(found.columns[c].offset == Approx(101325));
    }
  }
  const Read full =
      read_with("# Position: mm\n# Command: %\n# Pressure A: kPa", "Time,Position,Command,Pressure A,Pressure B");
  CHECK(full.columns[1].factor == Approx(1e-3));
  CHECK(full.columns[2].unit == "%");
  CHECK(full.columns[3].factor == Approx(1e3));
  CHECK_FALSE(full.columns[4].has_unit);
}

TEST_CASE("values, other quantities and units that the names state are not changed by the head") {
  for (const char* head : {"# Position: 10 mm",
                           "# Stroke: 300 mm, supply pressure: 7 bar",
                           "# rig in hall, x in use",
                           "# x in bar",
                           "# sample rate in Hz",
                           "# p1: left, p2: right",
                           "# position noise in um",
                           "# resolution of position: um",
                           "# display: Position in mm",
                           "# stroke in mm",
                           "# timer in ms",
                           "# was: x in mm, now: x in m",
                           "# difference p1 and p2 in bar",
                           "# plot: x in mm, p1 in bar",
                           "# screen shows pressure in bar",
                           "# ambient pressure: mbar",
                           "# air pressure in hPa",
                           "# pressure gauge: A",
                           "# channel p1: A",
                           "# valve opening: percent"}) {
    CAPTURE(head);
    const Read found = read_with(head);
    for (const ColumnGuess& guess : found.columns) CHECK_FALSE(guess.has_unit);
    CHECK_THAT(found.told, !Contains("units by the head"));
  }
  const Read stated = read_with("# x in m, p1 in Pa", "t,x_mm,u,p1_bar,p2_bar");
  CHECK(stated.columns[1].factor == Approx(1e-3));
  CHECK(stated.columns[3].factor == Approx(1e5));
}

TEST_CASE("a command in per cent may say so in its name") {
  for (const char* name : {"u_pct", "u_%", "valve_percent", "Valve_pct", "u [%]", "u [percent]", "Ventil_Prozent",
                           "valvePercent", "Command pct", "u (pct)", "Ventil [Prozent]", "u/%"}) {
    CAPTURE(name);
    const ColumnGuess guess = read_with("", std::string("t,x,") + name + ",p1,p2").columns[2];
    CHECK(guess.ours == "u_V");
    CHECK(guess.unit == "%");
  }
  CHECK(read_with("", "t,pos_pct,u,p1,p2").columns[1].ours.empty());
  CHECK(read_with("", "t,x,u,p1_pct,p2").columns[3].ours.empty());
}
