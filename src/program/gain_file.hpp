// Gains of a running controller from a file that is watched (run --gains).
#pragma once
#include <atomic>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <pneuservo/loop/gain_mailbox.hpp>
#include <pneuservo/rig/rig.hpp>

namespace pneuservo {

/// Gains of a file `KEY: VALUE` with keys of the config's controller section, those that are missing as in the config:
/// read and checked as --set controller.KEY=VALUE would be, so that what passes is a valid config. Throws InputError:
/// also where the key is no gain, or where the linear model's loop would be unstable with them.
Ppd2GainSet read_gain_file(const std::string& path, const std::string& config, const std::vector<std::string>& sets);

/// Looks at the file ten times a second in a thread of its own; after a change it posts the gains, or says on standard
/// error what is wrong with them and leaves the loop alone. The file need not be there yet; throws InputError where it
/// is there and no regular file, or too large.
class GainFileWatcher {
 public:
  GainFileWatcher(std::string path, std::string config, std::vector<std::string> sets, GainMailbox& mailbox);
  ~GainFileWatcher();
  GainFileWatcher(const GainFileWatcher&) = delete;
  GainFileWatcher& operator=(const GainFileWatcher&) = delete;

 private:
  void watch();
  void look();

  std::string path_, config_;
  std::vector<std::string> sets_;
  GainMailbox& mailbox_;
  std::string complaint_;  // what was said last
  std::string seen_;  // the file's text when it was last looked at
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace pneuservo
