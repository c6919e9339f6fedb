// What a verb of the command line takes. The parser itself (CLI11) stays in command_line.cpp: it
// costs seconds in each file that includes it.
#pragma once
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <string>
#include <utility>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pneuservo {

/// One option of a verb; each call says more of it.
class VerbOption {
 public:
  explicit VerbOption(CLI::Option* option) : option_(option) {}
  VerbOption& required();
  VerbOption& within(int least, int most);
  VerbOption& within(double least, double most);
  VerbOption& above_zero();
  VerbOption& among(std::initializer_list<std::string> words);
  VerbOption& type_name(const std::string& name);
  /// The value that it has now, shown as its default.
  VerbOption& shows_default();
  /// Not listed by --help.
  VerbOption& hidden();
  /// How often it was given.
  std::size_t count() const;

 private:
  CLI::Option* option_;
};

/// A verb; values that are bound to options live as long as the command line.
class Verb {
 public:
  explicit Verb(CLI::App* app) : app_(app) {}
  /// `names` as in "--json" or "CONFIG" (by position). T: int, std::uint16_t, double, string, vector of string,
  /// optional of int or double.
  template <class T>
  VerbOption add_option(const std::string& names, T& value, const std::string& help);
  VerbOption add_flag(const std::string& name, bool& value, const std::string& help);
  /// What is done when the flag is given.
  void add_flag(const std::string& name, std::function<void()> act, const std::string& help);
  /// Text below the options.
  void footer(const std::string& text);
  /// What the verb does.
  void callback(std::function<void()> act);

 private:
  CLI::App* app_;
};

/// Where verbs add themselves, below the heading `group` of the help.
class CommandLine {
 public:
  CommandLine(CLI::App& app, std::string group) : app_(&app), group_(std::move(group)) {}
  Verb add_verb(const std::string& name, const std::string& help);

 private:
  CLI::App* app_;
  std::string group_;
};

}  // namespace pneuservo
