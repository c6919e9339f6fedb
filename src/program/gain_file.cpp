// The watched file of gains.
#include "program/gain_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iostream>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "config/config_tree.hpp"
#include "config/input_error.hpp"
#include "config/read_rig.hpp"
#include "control/linear_trial.hpp"
#include "record/ordinary_thread.hpp"

namespace pneuservo {
namespace {

constexpr std::array<const char*, 4> gain_keys{"position_gain_V_per_m", "velocity_gain_Vs_per_m",
                                               "acceleration_gain_Vs2_per_m", "integral_gain_V_per_m_s"};
constexpr std::chrono::milliseconds look_every{100};

/// Four lines; a file that is larger by far is another one.
constexpr std::int64_t largest_bytes = 65536;

/// Empty where there is no file yet. A pipe or device would block, or never end.
std::string text_of(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return {};
  struct stat found{};
  const bool regular = fstat(file, &found) == 0 && S_ISREG(found.st_mode);
  std::string text;
  if (regular && found.st_size <= largest_bytes) {
    text.resize(static_cast<std::size_t>(found.st_size));
    const ssize_t got = read(file, text.data(), text.size());
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  }
  close(file);
  if (!regular) throw InputError(path + ": found no regular file, expected one with lines KEY: VALUE");
  if (found.st_size > largest_bytes)
    throw InputError(fmt::format("{}: found {} bytes, expected at most {}", path, found.st_size, largest_bytes));
  return text;
}

/// --set of each key of the file.
std::vector<std::string> sets_of(const std::string& path, const std::string& text) {
  std::vector<std::string> sets;
  const ConfigNode root = parse_config_tree(text, path);
  if (root.type != ConfigNode::Type::map)
    throw InputError(fmt::format("{}: found no keys, expected lines such as {}: 1200", path, gain_keys[0]));
  for (const auto& [key, origin, value] : root.entries) {
    if (std::find(gain_keys.begin(), gain_keys.end(), key) == gain_keys.end())
      refuse(origin, key, "no gain that may change", fmt::format("one of {}", fmt::join(gain_keys, ", ")));
    if (value.type != ConfigNode::Type::scalar) refuse(origin, key, "no number", "one");
    sets.push_back(fmt::format("controller.{}={}", key, value.text));
  }
  return sets;
}

}  // namespace

Ppd2GainSet read_gain_file(const std::string& path, const std::string& config, const std::vector<std::string>& sets) {
  std::vector<std::string> all = sets;
  for (std::string& set : sets_of(path, text_of(path))) all.push_back(std::move(set));
  Rig rig;
  try {
    rig = read_rig(config, all);
  } catch (const InputError& error) { throw InputError(path + ": " + error.what()); }
  if (!linear_loop_settles(rig.controller.of<Ppd2>(), rig.axis, rig.period_s))
    throw InputError(path + ": with these gains the linear model's loop does not come to rest within 4 s, expected "
                            "gains of a stable loop (see pneuservo design)");
  return gain_set(rig.controller.of<Ppd2>());
}

GainFileWatcher::GainFileWatcher(std::string path, std::string config, std::vector<std::string> sets,
                                 GainMailbox& mailbox)
    : path_(std::move(path)), config_(std::move(config)), sets_(std::move(sets)), mailbox_(mailbox) {
  text_of(path_);
  thread_ = std::thread([this] { watch(); });
}

GainFileWatcher::~GainFileWatcher() {
  ends_ = true;
  thread_.join();
}

void GainFileWatcher::watch() {
  become_ordinary_thread("gains");
  while (!ends_) {
    look();
    std::this_thread::sleep_for(look_every);
  }
}

void GainFileWatcher::look() {
  try {
    const std::string text = text_of(path_);
    if (text.empty() || text == seen_) return;
    seen_ = text;
    const Ppd2GainSet gains = read_gain_file(path_, config_, sets_);
    mailbox_.post(gains);
    std::cerr << fmt::format("{}: gains {} V/m, {} V s/m, {} V s2/m, {} V/(m s) given to the loop\n", path_,
                             gains.position_gain_V_per_m, gains.velocity_gain_Vs_per_m,
                             gains.acceleration_gain_Vs2_per_m, gains.integral_gain_V_per_m_s);
    complaint_.clear();
  } catch (const std::exception& error) {
    if (complaint_ == error.what()) return;  // said before
    complaint_ = error.what();
    std::cerr << complaint_ + "; the loop keeps its gains\n";
  }
}

}  // namespace pneuservo
