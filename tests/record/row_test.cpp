// The columns of a row: their names and order are the recording format's, and each one is a value of its own.
#include <catch2/catch.hpp>

#include <cmath>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include <pneuservo/record/row.hpp>

#include "record/row_text.hpp"

using namespace pneuservo;

TEST_CASE("the columns of a row are those of the format, in its order") {
  const std::vector<std::string> format{"t_s",
                                        "x_ref_m",
                                        "v_ref_mps",
                                        "p_ref_Pa",
                                        "x_predicted_m",
                                        "x_m",
                                        "v_mps",
                                        "x_estimated_m",
                                        "x_bound_m",
                                        "switches",
                                        "u_V",
                                        "u1_V",
                                        "u2_V",
                                        "p1_port_Pa",
                                        "p2_port_Pa",
                                        "p1_chamber_Pa",
                                        "p2_chamber_Pa",
                                        "p1_estimated_Pa",
                                        "p2_estimated_Pa",
                                        "p1_bound_Pa",
                                        "p2_bound_Pa",
                                        "mass_flow_1_kgps",
                                        "mass_flow_2_kgps",
                                        "p_supply_Pa",
                                        "supply_flow_kgps",
                                        "dp1_Pa",
                                        "dp2_Pa",
                                        "x_true_m",
                                        "p1_chamber_true_Pa",
                                        "p2_chamber_true_Pa",
                                        "lateness_us",
                                        "work_us"};
  REQUIRE(row_columns().size() >= format.size());
  std::vector<std::string> columns = row_columns();
  columns.resize(format.size());
  CHECK(columns == format);
  CHECK(row_columns().size() == row_column_count);
}

TEST_CASE("every number of a row is missing until it is set, and each column is a value of its own") {
  Row row;
  double next = 1.0;
  Row::visit(
      [&](std::string_view name, auto& value) {
        CAPTURE(name);
        if (std::is_same_v<decltype(value), double&> && name != "t_s") CHECK(std::isnan(static_cast<double>(value)));
        value = static_cast<std::remove_reference_t<decltype(value)>>(next++);
      },
      row);
  std::set<double> values;
  Row::visit([&](std::string_view, const auto& value) { values.insert(static_cast<double>(value)); }, row);
  CHECK(values.size() == row_column_count);
  CHECK(RowColumn(Signal::p2_chamber).of(row) == row.measured[Signal::p2_chamber]);
  CHECK(RowColumn(&Row::p2_bound_Pa).of(row) == row.p2_bound_Pa);
}
