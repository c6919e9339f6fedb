// The queue that commands of a running loop take, between two threads.
#include <catch2/catch.hpp>

#include <cstdint>
#include <thread>

#include <pneuservo/loop/mailbox.hpp>

using namespace pneuservo;

TEST_CASE("the queue between two threads keeps order, loses nothing and says when it is full") {
  WaitFreeQueue<std::uint64_t, 8> queue;
  for (std::uint64_t i = 0; i < 8; ++i) CHECK(queue.push(i));
  CHECK_FALSE(queue.push(8));
  std::uint64_t value = 0;
  for (std::uint64_t i = 0; i < 8; ++i) {
    CHECK(queue.pop(value));
    CHECK(value == i);
  }
  CHECK_FALSE(queue.pop(value));
  constexpr std::uint64_t last = 50000;
  WaitFreeQueue<std::uint64_t, 64> long_queue;
  std::thread pushes([&] {
    for (std::uint64_t i = 1; i <= last;)
      if (long_queue.push(i)) ++i;
      else std::this_thread::yield();
  });
  bool in_order = true;
  for (std::uint64_t wanted = 1; wanted <= last;) {
    if (!long_queue.pop(value)) {
      std::this_thread::yield();
      continue;
    }
    in_order = in_order && value == wanted;
    ++wanted;
  }
  pushes.join();
  CHECK(in_order);
}
