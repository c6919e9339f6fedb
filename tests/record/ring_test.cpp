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

}  // namespace

TEST_CASE("rows leave the ring in order and unchanged") {
  RecordingRing ring(100);
  for (int i = 0; i < 100; ++i) ring.push(numbered_row(i));
  const auto rows = pop_all(ring);
  REQUIRE(rows.size() == 100);
  for (int i = 0; i < 100; ++i) {
    REQUIRE(rows[static_cast<std::size_t>(i)].t_s == i * 1e-3);
    REQUIRE(rows[static_cast<std::size_t>(i)].u_V == i / 3.0);
    REQUIRE(rows[static_cast<std::size_t>(i)].flags == 0);
  }
  REQUIRE(ring.dropped() == 0);
}

TEST_CASE("rows lost to a late consumer are counted, the next one is flagged, the last ones before a fault are kept") {
  constexpr int size = 50, taken = 20, lost = 200;
  RecordingRing ring(size);
  int number = 0;
  while (number < taken) ring.push(numbered_row(number++));
  REQUIRE(static_cast<int>(pop_all(ring).size()) == taken);
  while (number < taken + lost + size - 1) ring.push(numbered_row(number++));
  Row fault = numbered_row(number++);
  fault.flags = row_fault;
  ring.push(fault);

  const auto rows = pop_all(ring);
  REQUIRE(ring.dropped() == lost);
  REQUIRE(static_cast<int>(rows.size()) == size);
  for (int i = 0; i < size; ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    REQUIRE(number_of(row) == number - size + i);
    REQUIRE(row.flags == ((i == 0 ? row_dropped_before : 0u) | (i == size - 1 ? row_fault : 0u)));
  }

  // The ring goes on as before, and the flag is not set again.
  ring.push(numbered_row(number));
  const auto further = pop_all(ring);
  REQUIRE(further.size() == 1);
  REQUIRE(further[0].flags == 0);
}

TEST_CASE("two threads: every row comes once, in order and untorn, or is counted as dropped") {
  constexpr int total = 200000;
  RecordingRing ring(64);
  std::thread producer([&] {
    for (int i = 0; i < total; ++i) {
      Row row = numbered_row(i);
      row.measured[Signal::p1_port] = row.measured[Signal::p2_port] = row.work_us = i;
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
    bad += row.measured[Signal::p1_port] != number || row.measured[Signal::p2_port] != number ||
           row.work_us != number || row.t_s != number * 1e-3;
    previous = number;
  }
  producer.join();
  REQUIRE(bad == 0);
  REQUIRE(received + ring.dropped() == total);
  REQUIRE(ring.pushed() == total);
}
