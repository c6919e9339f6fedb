// Dates with names of months and weekdays, and days of the year: one moment in many spellings, and words that are none.
#include <catch2/catch.hpp>

#include <string>
#include <vector>

#include "record/foreign/clock_text.hpp"
#include "record/foreign/dialect.hpp"

using pneuservo::clock_in;

TEST_CASE("one moment is read from all its spellings") {
  constexpr double moment_s = 1796039997.25;  // 2026-11-30 11:59:57.25 by universal time
  for (const std::string text :
       {"2026-11-30T11:59:57.25Z", "30-Nov-2026 11:59:57.250", "Nov 30 2026 11:59:57.25", "Nov 30, 2026 11:59:57.25",
        "Mon Nov 30 11:59:57.250 2026", "Mon Nov 30 11:59:57.25 UTC 2026", "Mon, 30 Nov 2026 11:59:57.25 +0000",
        "Monday, November 30, 2026 11:59:57.25", "Mo. 30.11.2026 11:59:57,25", "Montag, 30. November 2026 11:59:57.25",
        "2026-334T11:59:57.25", "Mon, 30 Nov 2026 12:59:57.25 +0100", "Nov-30-2026 11:59:57.25"}) {
    INFO(text);
    const auto seconds = clock_in(text);
    REQUIRE(seconds);
    CHECK(*seconds == Approx(moment_s).margin(1e-6));
  }
}

TEST_CASE("a system's log has no year: times of it follow one another") {
  const auto before = clock_in("Feb 28 23:59:59.5"), leap_day = clock_in("Feb 29 00:00:00.5");
  REQUIRE(before);
  REQUIRE(leap_day);
  CHECK(*leap_day - *before == Approx(1.0));
}

TEST_CASE("words, dates that do not exist and months without a time are no times") {
  for (const std::string text :
       {"Mar", "march", "Nov 30", "Mon", "monitor 1 2:00", "Nov 31 2026 10:00:00", "2026-366T10:00:00",
        "2026-000T10:00:00", "May 5 2026", "error", "sat 10", "so", "Nov 30 2026 25:00:00"})
    CHECK_FALSE(clock_in(text));
}

TEST_CASE("dates of several words between tabs are one field each") {
  std::vector<std::string> lines{"time\tx_m\tu_V"};
  for (int i = 0; i < 20; ++i)
    lines.push_back("Mon, 30 Nov 2026 11:59:" + std::to_string(10 + i) + ".5 +0000\t0.25\t-1.5");
  const pneuservo::Dialect dialect = pneuservo::find_dialect(lines);
  CHECK(dialect.style.separator == '\t');
  CHECK(dialect.names == std::vector<std::string>{"time", "x_m", "u_V"});
}
