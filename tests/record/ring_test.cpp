// The ring: order, overflow, what is kept of the last cycles, and two threads at full speed.
#include <catch2/catch.hpp>

#include <cmath>
#include <thread>

#include <pneuservo/record/ring.hpp>

#include "record/files.hpp"

using namespace pneuservo;

namespace {

std::vector<Row> pop_all(RecordingRing& ring) {
  std::vector<Row> rows;
  for (Row row; ring.pop(row);) rows.push_back(row);
  return rows;
}

int number_of(const Row& row) { return static_cast<int>(std::lround(row.t_s * 1e3)); }

/// Pushes rows until the queue refuses one; returns the number after that row.
int push_until_refused(RecordingRing& ring, int number) {
  while (ring.push(numbered_row(number++))) {}
  return number;
}

}  // namespace

TEST_CASE("rows leave the ring in order and unchanged") {
  RecordingRing ring(100, 10);
  for (int i = 0; i < 100; ++i) REQUIRE(ring.push(numbered_row(i)));
  const auto rows = pop_all(ring);
  REQUIRE(rows.size() == 100);
  for (int i = 0; i < 100; ++i) {
    REQUIRE(rows[static_cast<std::size_t>(i)].t_s == i * 1e-3);
    REQUIRE(rows[static_cast<std::size_t>(i)].u_V == i / 3.0);
    REQUIRE(rows[static_cast<std::size_t>(i)].flags == 0);
  }
  REQUIRE(ring.dropped() == 0);
  REQUIRE(ring.refused() == 0);
}

TEST_CASE("refused rows that are still among the last ones come out in their place, unflagged") {
  RecordingRing ring(100, 50);
  int number = push_until_refused(ring, 0);  // the last one was refused
  for (int i = 0; i < 20; ++i) REQUIRE_FALSE(ring.push(numbered_row(number++)));
  Row row;
  for (int i = 0; i < 10; ++i) REQUIRE(ring.pop(row));       // room for what follows, behind the refused rows
  for (int i = 0; i < 10; ++i) ring.push(numbered_row(number++));
  const auto rows = pop_all(ring);
  REQUIRE(static_cast<int>(rows.size()) == number - 10);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    REQUIRE(number_of(rows[i]) == static_cast<int>(i) + 10);
    REQUIRE(rows[i].flags == 0);
  }
  REQUIRE(ring.refused() == 21);
  REQUIRE(ring.dropped() == 0);
}

TEST_CASE("rows lost in an overflow are counted, the next one is flagged, the last ones before a fault are kept") {
  constexpr int last = 50;
  RecordingRing ring(100, last);
  const int first_refused = push_until_refused(ring, 0) - 1;
  const int lost = 200;
  int number = first_refused + 1;
  while (number < first_refused + lost + last) ring.push(numbered_row(number++));
  Row fault = numbered_row(number++);  // one more row: the oldest of the last 50 goes
  fault.flags = row_fault;
  REQUIRE_FALSE(ring.push(fault));

  const auto rows = pop_all(ring);
  REQUIRE(ring.dropped() == lost + 1);
  REQUIRE(static_cast<int>(rows.size()) == first_refused + last);
  for (int i = 0; i < first_refused; ++i) REQUIRE(number_of(rows[static_cast<std::size_t>(i)]) == i);
  for (int i = 0; i < last; ++i) {
    const Row& row = rows[static_cast<std::size_t>(first_refused + i)];
    REQUIRE(number_of(row) == number - last + i);
    REQUIRE(row.flags == ((i == 0 ? row_dropped_before : 0u) | (i == last - 1 ? row_fault : 0u)));
  }

  // The ring goes on as before, and the flag is not set again.
  REQUIRE(ring.push(numbered_row(number)));
  const auto further = pop_all(ring);
  REQUIRE(further.size() == 1);
  REQUIRE(further[0].flags == 0);
}

TEST_CASE("two threads: every row comes once, in order and untorn, or is counted as dropped") {
  constexpr int total = 200000;
  RecordingRing ring(64, 16);
  std::thread producer([&] {
    for (int i = 0; i < total; ++i) {
      Row row = numbered_row(i);
      row.p1_port_Pa = row.p2_port_Pa = row.work_us = i;
      row.fault = static_cast<std::uint32_t>(i);
      ring.push(row);
      if (i % 1000 == 0) std::this_thread::yield();
    }
  });
  std::int64_t received = 0;
  int previous = -1, bad = 0;
  while (previous < total - 1) {
    Row row;
    if (!ring.pop(row)) {
      std::this_thread::yield();
      continue;
    }
    ++received;
    const int number = static_cast<int>(row.fault);
    const bool consecutive = number == previous + 1;
    bad += number <= previous;
    bad += consecutive != ((row.flags & row_dropped_before) == 0);
    bad += row.p1_port_Pa != number || row.p2_port_Pa != number || row.work_us != number || row.t_s != number * 1e-3;
    previous = number;
  }
  producer.join();
  REQUIRE(bad == 0);
  REQUIRE(received + ring.dropped() == total);
  REQUIRE(ring.pushed() == total);
}
