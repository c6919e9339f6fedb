// A commanded loop on the simulated plant, tick by tick, and what every such loop owes: a replay of what was obeyed.
#pragma once
#include <catch2/catch.hpp>

#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <pneuservo/loop/axis_command.hpp>
#include <pneuservo/record/row.hpp>
#include <pneuservo/rig/rig.hpp>

#include "sim/sim_backend.hpp"

namespace pneuservo::test {

template <class Loop> class CommandedLoop {
 public:
  explicit CommandedLoop(const Rig& rig) : backend_(rig) {
    backend_.configure();
    loop_.configure(rig);
    loop_.set_command_link(link_.get());
    backend_.activate();
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      if (makes_passes && loop_.pass_due()) why = loop_.make_pass();
      REQUIRE(loop_.pass(backend_, tick_++, 0, nullptr, nullptr));
      rows_.push_back(loop_.row());
    }
  }
  bool makes_passes = true;
  std::string why;  ///< the last move that waited for a pass has none
  /// Asks, and runs until the answer is there.
  AxisAnswer ask(AxisCommand command) {
    command.number = ++numbers_;
    REQUIRE(link_->commands.push(command));
    for (int i = 0; i < 200; ++i) {
      run(1);
      if (AxisAnswer answer; link_->answers.pop(answer)) {
        CHECK(answer.number == command.number);
        return answer;
      }
    }
    FAIL("no answer");
    return {};
  }
  AxisStatus status() {
    AxisStatus status;
    link_->status.take(status);
    return status;
  }
  void enable() {
    CHECK(ask({CommandKind::enable}).result == CommandResult::taken);
    for (int i = 0; i < 500 && !loop_.supervisor().is_active(); ++i) run(1);
    REQUIRE(loop_.supervisor().is_active());
  }
  Loop& loop() { return loop_; }
  const std::vector<Row>& rows() const { return rows_; }
  const Row& last() const { return rows_.back(); }

 private:
  SimBackend backend_;
  Loop loop_;
  std::unique_ptr<CommandLink> link_ = std::make_unique<CommandLink>();
  std::int64_t tick_ = 0;
  std::uint64_t numbers_ = 0;
  std::vector<Row> rows_;
};

/// The commands that stand in the rows give the same set points and valve commands again. `set_point`, `target` and
/// `rate`: the columns of this kind of loop.
template <class Loop> void require_replay(const Rig& rig, const std::vector<Row>& rows, double Row::* set_point,
                                          double Row::* target, double Row::* rate) {
  CommandedLoop<Loop> again(rig);
  for (const Row& row : rows) {
    again.makes_passes = (row.flags & row_pass_begins) != 0;
    if (row.command_kind == 0) again.run(1);
    else
      REQUIRE(
          again.ask({static_cast<CommandKind>(row.command_kind), row.*target, row.*rate, 0, row.command_s}).result ==
          CommandResult::taken);
  }
  REQUIRE(again.rows().size() == rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    REQUIRE(std::bit_cast<std::uint64_t>(rows[i].*set_point) ==
            std::bit_cast<std::uint64_t>(again.rows()[i].*set_point));
    REQUIRE(rows[i].u_V == again.rows()[i].u_V);
    REQUIRE(rows[i].flags == again.rows()[i].flags);
  }
}

}  // namespace pneuservo::test
