// Commands of an on/off valve along a recording.
#include "diagnosis/residuals/command_program.hpp"

#include <algorithm>

namespace pneuservo {

double CommandProgram::at(double time_s) const {
  const auto after = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  return after == times_s.begin() ? commands.front() : commands[static_cast<std::size_t>(after - times_s.begin()) - 1];
}

double CommandProgram::next_change_s(double time_s, double most_s) const {
  const auto next = std::upper_bound(times_s.begin(), times_s.end(), time_s);
  return next == times_s.end() ? most_s : std::min(most_s, *next);
}

CommandProgram command_program(const Rig& rig, const Recording& recording) {
  const std::vector<double>& t = recording.t_s();
  CommandProgram program;
  if (!recording.has("u_V")) {
    for (const double time_s : rig.program.times_s) program.times_s.push_back(t.front() + time_s);
    program.commands = rig.program.commands;
    return program;
  }
  const std::vector<double>& u = recording.column("u_V");
  program.times_s = {std::min(t.front(), 0.0)};
  program.commands = {u.front()};
  for (std::size_t k = 1; k < t.size(); ++k)
    if (u[k] != u[k - 1]) program.times_s.push_back(t[k]), program.commands.push_back(u[k]);
  return program;
}

CommandProgram carried_out(CommandProgram program, std::size_t first, double delay_s, double drop_out_s) {
  for (std::size_t i = first; i < program.times_s.size(); ++i)
    program.times_s[i] += delay_s + (program.commands[i] < 0 ? drop_out_s : 0.0);
  return program;
}

}  // namespace pneuservo
