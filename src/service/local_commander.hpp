// A commander of the axis in this program, on a thread of its own: what it says passes the server as any client's
// words.
#pragma once
#include <cstdint>
#include <string>

#include <pneuservo/loop/axis_command.hpp>

#include "service/descriptor.hpp"

namespace pneuservo {

/// One side is the commander's thread, the other CommandServer's; neither waits for the other.
class LocalCommander {
 public:
  static constexpr std::size_t most_waiting = 64;
  /// `name` stands where another commander is told who has the axis. Throws InputError.
  explicit LocalCommander(std::string name);

  /// False: there is no room yet; say it again later.
  bool say(const CommanderWord& word);
  /// True: what came of a command, or how the axis is by now.
  bool take_answer(AxisAnswer& answer) noexcept { return answers_.pop(answer); }
  bool take_status(AxisStatus& status) noexcept { return status_.take(status); }

 private:
  friend class CommandServer;

  std::string name_;
  WaitFreeQueue<CommanderWord, most_waiting> words_;
  WaitFreeQueue<AxisAnswer, most_waiting> answers_;
  Mailbox<AxisStatus> status_;
  Descriptor wake_;
  std::uint64_t number_ = 0;  // among the server's clients
};

}  // namespace pneuservo
