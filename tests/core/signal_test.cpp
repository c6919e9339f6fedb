// The table of signals: its rows are the values of Signal, by name, column and side.
#include <catch2/catch.hpp>

#include <set>
#include <string>

#include <pneuservo/core/signal.hpp>

using namespace pneuservo;

TEST_CASE("each row of the table stands at its own signal") {
  CHECK(info(Signal::x).column == "x_m");
  CHECK(info(Signal::p1_port).column == "p1_port_Pa");
  CHECK(info(Signal::p2_port).column == "p2_port_Pa");
  CHECK(info(Signal::p1_chamber).column == "p1_chamber_Pa");
  CHECK(info(Signal::p2_chamber).column == "p2_chamber_Pa");
  CHECK(info(Signal::p_supply).column == "p_supply_Pa");
  CHECK(info(Signal::supply_flow).column == "supply_flow_kgps");
  CHECK(info(Signal::F).column == "F_N");
  CHECK(info(Signal::dp1).column == "dp1_Pa");
  CHECK(info(Signal::dp2).column == "dp2_Pa");
  CHECK(signal_count == 10);
}

TEST_CASE("a signal is found by its name and by its column alone") {
  std::set<std::string_view> names;
  for (const Signal signal : all_signals) {
    CHECK(names.insert(info(signal).name).second);
    CHECK(signal_named(info(signal).name) == signal);
    CHECK(signal_of_column(info(signal).column) == signal);
    CHECK_FALSE(signal_named(info(signal).column));
    CHECK_FALSE(signal_of_column(info(signal).name));
  }
  CHECK_FALSE(signal_named("p3"));
}

TEST_CASE("pairs of signals follow the sides of the cylinder") {
  REQUIRE((port_signals.size() == 2 && chamber_signals.size() == 2 && difference_signals.size() == 2));
  for (std::size_t side = 0; side < 2; ++side) {
    CHECK(side_of(port_signals[side]) == side);
    CHECK(side_of(chamber_signals[side]) == side);
    CHECK(side_of(difference_signals[side]) == side);
    CHECK(info(port_signals[side]).name == "p" + std::to_string(side + 1) + "_port");
  }
  CHECK(channel_signals.size() == gas_signals.size() + 1);
  CHECK(gas_signals.size() == pascal_signals.size() + 1);
  CHECK(pascal_signals.size() == pressure_signals.size() + difference_signals.size());
}
