// Verbs and options on CLI11.
#include "program/command_line.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace pneuservo {

namespace {
const CLI::Validator& is_above_zero() {
  static const CLI::Validator validator(
      [](const std::string& text) {
        double value = 0.0;
        const bool is_above = CLI::detail::lexical_cast(text, value) && value > 0.0 && std::isfinite(value);
        return is_above ? std::string() : fmt::format("found {}, expected a number above 0", text);
      },
      "above 0");
  return validator;
}
}  // namespace

VerbOption& VerbOption::required() { return option_->required(), *this; }
VerbOption& VerbOption::within(int least, int most) { return option_->check(CLI::Range(least, most)), *this; }
VerbOption& VerbOption::within(double least, double most) { return option_->check(CLI::Range(least, most)), *this; }
VerbOption& VerbOption::above_zero() { return option_->check(is_above_zero()), *this; }
VerbOption& VerbOption::among(std::initializer_list<std::string> words) {
  return option_->check(CLI::IsMember(std::vector<std::string>(words))), *this;
}
VerbOption& VerbOption::type_name(const std::string& name) { return option_->type_name(name), *this; }
VerbOption& VerbOption::shows_default() { return option_->capture_default_str(), *this; }
VerbOption& VerbOption::hidden() { return option_->group(""), *this; }
std::size_t VerbOption::count() const { return option_->count(); }

template <class T>
VerbOption Verb::add_option(const std::string& names, T& value, const std::string& help) {
  return VerbOption(app_->add_option(names, value, help));
}
template VerbOption Verb::add_option(const std::string&, int&, const std::string&);
template VerbOption Verb::add_option(const std::string&, std::uint16_t&, const std::string&);
template VerbOption Verb::add_option(const std::string&, std::size_t&, const std::string&);
template VerbOption Verb::add_option(const std::string&, double&, const std::string&);
template VerbOption Verb::add_option(const std::string&, std::string&, const std::string&);
template VerbOption Verb::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template VerbOption Verb::add_option(const std::string&, std::optional<int>&, const std::string&);
template VerbOption Verb::add_option(const std::string&, std::optional<double>&, const std::string&);

VerbOption Verb::add_flag(const std::string& name, bool& value, const std::string& help) {
  return VerbOption(app_->add_flag(name, value, help));
}
void Verb::add_flag(const std::string& name, std::function<void()> act, const std::string& help) {
  app_->add_flag_callback(name, std::move(act), help);
}
void Verb::footer(const std::string& text) { app_->footer(text); }
void Verb::callback(std::function<void()> act) { app_->callback(std::move(act)); }

Verb CommandLine::add_verb(const std::string& name, const std::string& help) {
  return Verb(app_->add_subcommand(name, help)->group(group_));
}

}  // namespace pneuservo
