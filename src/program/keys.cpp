// Verb `keys`: every key of a config with unit, range, default and meaning.
#include <cstdio>
#include <memory>

#include "config/config_manual.hpp"
#include "program/verbs.hpp"

namespace pneuservo {

void add_keys(CommandLine& app, int&) {
  Verb verb = app.add_verb("keys", "every key of a config with unit, range, default and meaning");
  const auto markdown = std::make_shared<bool>(false);
  verb.add_flag("--markdown", *markdown, "as a markdown page (docs/config-keys.md)");
  verb.callback([markdown] { std::fputs((*markdown ? config_manual() : config_manual_text()).c_str(), stdout); });
}

}  // namespace pneuservo
