// All recordings of the shared data read: those of our format without a header problem, foreign ones as tables.
#include <catch2/catch.hpp>

#include <cmath>

#include "record/files.hpp"

using namespace pneuservo;

TEST_CASE("all shared recordings read", "[optimised]") {
  const char* given = std::getenv("PNEUSERVO_SHARED");
  const std::filesystem::path shared =
      given != nullptr ? std::filesystem::path(given) : std::filesystem::path(PNEUSERVO_SOURCE_DIR) / "../shared";
  if (!std::filesystem::exists(shared)) {
    WARN("SKIPPED: no shared data folder " << shared);
    return;
  }
  int own = 0, foreign = 0;
  for (const char* part : {"concealed", "recordings", "design/golden"}) {
    if (!std::filesystem::exists(shared / part)) continue;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(shared / part)) {
      const std::string path = entry.path().string();
      if (!path.ends_with(".csv.gz")) continue;
      CAPTURE(path);
      const CsvTable table = read_table(path);
      REQUIRE(table.rows() > 10);
      if (!table.has("t_s")) {
        REQUIRE_THROWS_WITH(read_recording(path), Catch::Matchers::Contains("column t_s is missing"));
        ++foreign;
        continue;
      }
      const Recording recording = read_recording(path);
      for (std::size_t i = 1; i < recording.rows(); ++i)
        if (!(recording.t_s()[i] > recording.t_s()[i - 1])) FAIL("t_s does not increase at row " << i);
      if (recording.header["format"]) {
        REQUIRE(problems_of(recording).empty());
        REQUIRE(recording.rows() == table.rows());
        ++own;
      } else {
        ++foreign;
      }
    }
  }
  WARN(own << " recordings of our format, " << foreign << " foreign tables read");
  REQUIRE(own + foreign > 0);
}
