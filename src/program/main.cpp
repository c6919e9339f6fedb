// The program pneuservo: one table of verbs, exit status 0 done, 1 fault or failed check, 2 unusable input.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/ranges.h>
#include <malloc.h>
#include <poll.h>
#include <unistd.h>

#include "config/config_tree.hpp"
#include "config/input_error.hpp"
#include "config/key_suggestion.hpp"
#include "config/version.hpp"
#include "loop/realtime_stop.hpp"
#include "program/verbs.hpp"

namespace {
/// A first word that is no option must be a verb.
void refuse_unknown_verb(const CLI::App& app, const std::string& word) {
  if (word.starts_with("-")) return;
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands({})) verbs.push_back(verb->get_name());
  if (std::ranges::find(verbs, word) != verbs.end()) return;
  const std::vector<std::string> near = pneuservo::near_names(word, verbs);
  throw pneuservo::InputError(fmt::format("found the verb '{}', expected {}{}", word, near.empty() ? "one of " : "",
                                          fmt::join(near.empty() ? verbs : near, near.empty() ? ", " : " or ")));
}

int run_program(int argc, char** argv) {
  CLI::App app{"pneuservo: real-time control of pneumatic servo axes with connected pipelines", "pneuservo"};
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "help of all verbs");
  app.set_version_flag("--version", "pneuservo " + std::string(pneuservo::version()));
  app.footer("Start here:\n"
             "  nothing but this program   pneuservo run config/cylinder-10m-7.65mm.yaml --report run.html\n"
             "  data sheets of an axis     pneuservo new-rig my-axis.yaml, then serve and command\n"
             "  a logger's recording       pneuservo import log.csv my-axis.yaml, then diagnose\n"
             "  one verb                   pneuservo run --help\n"
             "Exit status: 0 done, 1 a fault or a failed check, 2 unusable input.");
  int status = 0;
  pneuservo::add_verbs(app, status);
  if (argc < 2) {
    std::fputs(app.help().c_str(), stdout);
    return 2;
  }
  refuse_unknown_verb(app, argv[1]);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) { return app.exit(error) == 0 ? 0 : 2; }
  return status;
}

/// A stream that is closed at the start would lend its number to the first file or bus that is opened, and the messages
/// with it. What stands in its place refuses what is asked of it, as a closed one does.
void hold_standard_streams() {
  for (const int stream : {0, 1, 2})
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == 0 ? O_WRONLY : O_RDONLY);
}

/// Who read the pipe has gone, as `head` does: what it did not ask for is not lost.
bool has_reader_left() {
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  return poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0;
}

/// A result that did not arrive is none.
int status_of_output(int status) {
  errno = 0;
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout) return status;
  if (has_reader_left()) return status;
  std::fprintf(stderr,
               "pneuservo: standard output: found no way to write the whole result (%s), expected a place that "
               "takes it\n",
               errno != 0 ? std::strerror(errno) : "a write failed");
  return status == 0 ? 1 : status;
}

/// Memory that one step frees is used again by the next: glibc gives large blocks back page by page, which costs a
/// seventh of the time in which a large recording is read.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
}
}  // namespace

int main(int argc, char** argv) {
  hold_standard_streams();
  keep_freed_memory();
  pneuservo::ignore_broken_pipes();
  std::signal(SIGXFSZ, SIG_IGN);  // the write that meets a limit of size tells it, with the file
  std::optional<pneuservo::StopRequest> from_here_on;
  if (argc > 1 && pneuservo::moves_an_axis(argv[1])) from_here_on.emplace(pneuservo::StopSignals::every);
  try {
    return status_of_output(run_program(argc, argv));
  } catch (const pneuservo::InputError& error) {
    std::istringstream sentences(error.what());
    for (std::string sentence; std::getline(sentences, sentence);)
      std::fprintf(stderr, "pneuservo: %s\n", pneuservo::printable(sentence).c_str());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fputs("pneuservo: found too little memory for this task, expected a shorter or smaller one\n", stderr);
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pneuservo: %s\n", error.what());
    return 1;
  }
}
