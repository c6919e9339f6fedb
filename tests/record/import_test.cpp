// Recordings of a foreign format: columns, units, runs, events logged twice.
#include <fstream>

#include <catch2/catch.hpp>

#include "config/input_error.hpp"
#include "record/files.hpp"
#include "record/import.hpp"

using namespace pneuservo;

namespace {

std::string foreign_file(const TemporaryFolder& folder) {
  const std::string path = folder.file("foreign.csv");
  std::ofstream(path) << "# logged on change\nfill,t_s,p_kPa\n1,0.02,10\n1,0.01,4\n0,0.01,90\n1,0.02,14\n0,0.03,70\n";
  return path;
}

}  // namespace

TEST_CASE("a column map makes runs in order of time, scaled, with repeats averaged") {
  const TemporaryFolder folder;
  ImportParameters map;
  map.columns["u_V"] = {"fill", 2.0, -1.0, true};
  map.columns["p1_chamber_Pa"] = {"p_kPa", 1000.0, 101325.0};
  const std::vector<Recording> runs = read_recordings(foreign_file(folder), map, 0.01);
  REQUIRE(runs.size() == 2);  // by the value that tells them
  CHECK(runs[0].column("u_V") == std::vector<double>{-1, -1});
  CHECK(runs[0].column("p1_chamber_Pa") == std::vector<double>{191325, 171325});
  CHECK(runs[1].t_s() == std::vector<double>{0.01, 0.02});
  CHECK(runs[1].column("p1_chamber_Pa") == std::vector<double>{105325, 113325});
}

TEST_CASE("two columns of ours may come from one of the file") {
  const TemporaryFolder folder;
  ImportParameters map;
  map.columns["t_s"] = {"t_s"};
  map.columns["p1_chamber_Pa"] = {"p_kPa", 1000.0, 101325.0};
  map.columns["p1_port_Pa"] = {"p_kPa", 1000.0};
  std::ofstream(folder.file("one.csv")) << "t_s,p_kPa\n0,10\n0.01,11\n0.02,12\n";
  const Recording run = read_recordings(folder.file("one.csv"), map, 0.01).at(0);
  CHECK(run.column("p1_chamber_Pa") == std::vector<double>{111325, 112325, 113325});
  CHECK(run.column("p1_port_Pa") == std::vector<double>{10000, 11000, 12000});
}

TEST_CASE("columns that bear our names are read beside a map, unless it names them") {
  const TemporaryFolder folder;
  std::ofstream(folder.file("own.csv")) << "t_s,x_m,u_V,p1_port_Pa,other\n0,10,1,5e5,3\n0.001,20,2,5e5,3\n";
  ImportParameters map;
  map.columns["x_m"] = {"x_m", 1e-3};
  const Recording run = read_recordings(folder.file("own.csv"), map, 0.001).at(0);
  CHECK(run.column("x_m") == std::vector<double>{0.01, 0.02});
  CHECK(run.column("u_V") == std::vector<double>{1, 2});
  CHECK(run.has("p1_port_Pa"));
  CHECK_FALSE(run.has("other"));
  CHECK(source_of(run, "x_m").factor == 1e-3);
  CHECK(source_of(run, "u_V").column == "u_V");
}

TEST_CASE("what a map names and the file lacks is told, but without times or rows nothing can be read") {
  const TemporaryFolder folder;
  ImportParameters map;
  map.columns["x_m"] = {"position"};
  const std::vector<Recording> runs = read_recordings(foreign_file(folder), map, 0.01);
  CHECK(!runs.front().has("x_m"));
  REQUIRE(runs.front().problems.size() == 2);
  CHECK_THAT(runs.front().problems[0].sentence, Catch::Contains("position is missing"));
  CHECK_THAT(runs.front().problems[1].sentence, Catch::Contains("rows have the time of another"));
  map.from_s = 1.0;
  CHECK_THROWS_AS(read_recordings(foreign_file(folder), map, 0.01), InputError);
  map.columns["t_s"] = {"clock"};
  CHECK_THROWS_AS(read_recordings(foreign_file(folder), map, 0.01), InputError);
}
