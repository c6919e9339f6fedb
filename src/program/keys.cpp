// Verb `keys`: every key of a config with unit, range, default and meaning.
#include <cstdio>
#include <memory>

#include "config/config_manual.hpp"
#include "program/verbs.hpp"

namespace pneuservo {

void add_keys(CommandLine& app, int& status) {
  Verb verb = app.add_verb("keys", "every key of a config with unit, range, default and meaning");
  const auto markdown = std::make_shared<bool>(false);
  verb.add_flag("--markdown", *markdown, "as a markdown page (docs/config-keys.md)");
  verb.callback([markdown, &status] {
    const std::string page = *markdown ? config_manual() : config_manual_text();
    const bool written = std::fwrite(page.data(), 1, page.size(), stdout) == page.size() && std::fflush(stdout) == 0;
    if (!written) std::perror("pneuservo: standard output");
    status = written ? 0 : 1;
  });
}

}  // namespace pneuservo
