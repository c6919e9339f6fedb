// Gains for the running loop: the mailbox between two threads, no jump, and the same bits in a replay.
#include <catch2/catch.hpp>

#include <atomic>
#include <cmath>
#include <thread>

#include <pneuservo/loop/axis_loop.hpp>
#include <pneuservo/loop/gain_mailbox.hpp>

#include "config/read_rig.hpp"
#include "loop/loop_rigs.hpp"
#include "sim/sim_backend.hpp"

using namespace pneuservo;

TEST_CASE("the mailbox gives the newest gains, whole, and each at most once") {
  GainMailbox mailbox;
  Ppd2GainSet got;
  CHECK_FALSE(mailbox.take(got));
  mailbox.post({1, 1, 1, 1});
  mailbox.post({2, 2, 2, 2});
  CHECK(mailbox.take(got));
  CHECK(got == Ppd2GainSet{2, 2, 2, 2});
  CHECK_FALSE(mailbox.take(got));

  constexpr int last = 200000;
  std::thread poster([&] {
    for (int i = 3; i <= last; ++i) {
      const double v = i;
      mailbox.post({v, v, v, v});
    }
  });
  double newest = 2.0;
  bool torn = false, backwards = false;
  while (newest < last) {
    if (!mailbox.take(got)) continue;
    torn = torn || got.velocity_gain_Vs_per_m != got.position_gain_V_per_m ||
           got.integral_gain_V_per_m_s != got.position_gain_V_per_m;
    backwards = backwards || got.position_gain_V_per_m <= newest;
    newest = got.position_gain_V_per_m;
  }
  poster.join();
  CHECK_FALSE(torn);
  CHECK_FALSE(backwards);
}

TEST_CASE("gains that change in a move come without a jump and act", "[long]") {
  for (const char* integral : {"0", "10000"}) {
    INFO("integral gain " << integral);
    const Rig rig = config_rig("servo-table-0.5m-4mm", {"controller.feedforward=5", "simulation.cells_per_m=16",
                                                        std::string("controller.integral_gain_V_per_m_s=") + integral});
    SimBackend backend(rig), untouched_backend(rig);
    backend.configure();
    untouched_backend.configure();
    AxisLoop loop, untouched;
    loop.configure(rig);
    untouched.configure(rig);
    GainMailbox mailbox;
    loop.set_gain_mailbox(&mailbox);
    Ppd2GainSet gains = gain_set(rig.controller.of<Ppd2>());
    gains.position_gain_V_per_m *= 1.5;
    gains.velocity_gain_Vs_per_m *= 1.3;
    constexpr std::int64_t change = 3000;  // in the middle of the printed move's cruise, with an error of some um
    for (std::int64_t tick = 0; tick <= change; ++tick) {
      if (tick == change) mailbox.post(gains);
      REQUIRE(loop.pass(backend, tick, 0, nullptr, nullptr));
      REQUIRE(untouched.pass(untouched_backend, tick, 0, nullptr, nullptr));
    }
    CHECK(term(rig, loop.row(), "position_gain_V_per_m") == gains.position_gain_V_per_m);
    CHECK(std::fabs(loop.row().u1_V - untouched.row().u1_V) < 1e-9);
    double apart_V = 0.0;
    for (std::int64_t tick = change + 1; tick < change + 500; ++tick) {
      loop.pass(backend, tick, 0, nullptr, nullptr);
      untouched.pass(untouched_backend, tick, 0, nullptr, nullptr);
      apart_V = std::max(apart_V, std::fabs(loop.row().u1_V - untouched.row().u1_V));
    }
    CHECK(apart_V > 1e-6);
    CHECK(loop.faults() == 0);
  }
}
