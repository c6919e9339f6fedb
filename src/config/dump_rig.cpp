// Writes a rig as a complete, commented config that reads back to the same rig.
#include "config/dump_rig.hpp"

#include <fmt/format.h>

#include "config/field_text.hpp"
#include "config/reference_fields.hpp"
#include "config/rig_parameters.hpp"
#include "config/same_rig.hpp"

namespace pneuservo {

namespace {

constexpr std::size_t comment_column = 46;

std::string comment_text(const Field& field, const std::string& range) {
  std::string text;
  const auto add = [&](std::string_view part, std::string_view separator) {
    if (!part.empty()) text += fmt::format("{}{}", text.empty() ? "" : separator, part);
  };
  add(field.unit == "-" ? "" : field.unit, "");
  add(range, ", ");
  add(field.help, "; ");
  return text;
}

/// Writes the keys of one section, indented, each with its comment.
class SectionWriter {
 public:
  SectionWriter(std::string& out, int indent) : out_(out), indent_(indent) {}

  template <class T> void operator()(const Field& field, const T& value) const {
    if constexpr (ParameterSection<T>) section(field, value);
    else if (is_unstated(field, value)) unstated(field);
    else line(field, value_text(field, value), accepted_text(field, value));
  }
  template <class T> void operator()(const Field& field, const std::optional<T>& value) const {
    if (value) (*this)(field, *value);
    else unstated(field);
  }
  void operator()(const Field& field, const std::vector<double>& values) const { line(field, list_text(values)); }
  void operator()(const Field& field, const std::vector<std::array<double, 3>>& components) const {
    line(field, "");
    for (const auto& component : components) item(list_text(component));
  }
  void operator()(const Field& field, const std::vector<ReferenceSpec>& parts) const {
    line(field, "");
    for (const ReferenceSpec& part : parts) item(dump_reference(part));
  }
  void operator()(const Field& field, const std::map<std::string, double>& values) const {
    line(field, values.empty() ? "{}" : "");
    for (const auto& [key, value] : values) write(fmt::format("  {}: {}", key, number_text(value)), "");
  }
  template <ParameterSection T> void operator()(const Field& field, const std::map<std::string, T>& sections) const {
    line(field, sections.empty() ? "{}" : "");
    for (const auto& [name, section] : sections) {
      write(fmt::format("  {}:", yaml_text(name)), "");
      T::visit(SectionWriter{out_, indent_ + 4}, section);
    }
  }
  void operator()(const Field& field, const ReferenceSpec& reference) const {
    line(field, "");
    visit_reference(reference.kind, SectionWriter{out_, indent_ + 2}, reference);
  }

  template <ParameterSection T> void section(const Field& field, const T& value) const {
    line(field, "");
    T::visit(SectionWriter{out_, indent_ + 2}, value);
  }
  void line(const Field& field, const std::string& value) const { line(field, value, range_text(field)); }
  void line(const Field& field, const std::string& value, const std::string& accepted) const {
    write(fmt::format("{}:{}{}", field.key, value.empty() ? "" : " ", value), comment_text(field, accepted));
  }

 private:
  void unstated(const Field& field) const {
    write(fmt::format("# {}: not stated", field.key), comment_text(field, range_text(field)));
  }
  void item(const std::string& text) const { write("  - " + text, ""); }
  void write(const std::string& text, const std::string& comment) const {
    const std::string indented = std::string(static_cast<std::size_t>(indent_), ' ') + text;
    if (comment.empty()) out_ += indented + "\n";
    else out_ += fmt::format("{:<{}}  # {}\n", indented, comment_column, comment);
  }

  std::string& out_;
  int indent_;
};

/// Writes those effects of a visit that are not neutral, or that have a value among `stated`.
struct EffectWriter {
  std::string& out;
  const std::map<std::string, double>& stated;
  std::string_view channel{};  ///< of a sensor's effect
  template <class Effect> void operator()(const Field& field, const Effect& effect) const {
    const std::string name = channel.empty() ? std::string(field.key) : fmt::format("{}:{}", field.key, channel);
    const std::string path = fmt::format("effects.{}.", name);
    const auto next = stated.lower_bound(path);
    const bool is_stated = next != stated.end() && next->first.starts_with(path);
    if (!is_stated && same_section(effect, Effect{})) return;
    Field named = field;
    named.key = name;
    SectionWriter(out, 2).section(named, effect);
  }
};

void write_effects(const Field& field, const Rig& rig, const std::map<std::string, double>& stated, std::string& out) {
  std::string effects;
  visit_effects(rig, EffectWriter{effects, stated});
  for (const Signal signal : all_signals)
    SensorEffects<double>::visit(EffectWriter{effects, stated, info(signal).name}, rig.sensor_effects[signal]);
  SectionWriter(out, 0).line(field, effects.empty() ? "{}" : "");
  out += effects;
}

void write_concealed(const Field& field, const Rig& rig, std::string& out) {
  Rig machine = rig;
  without_effects(machine);
  machine.deviations.clear();
  write_effects(field, simulated_rig(machine), rig.concealed, out);
}

/// One line of a reference.
struct FlowWriter {
  std::string& out;
  template <class T> void operator()(const Field& field, const T& value) const {
    if (!is_unstated(field, value)) write(field, value_text(field, value));
  }
  void operator()(const Field& field, const std::vector<double>& values) const { write(field, list_text(values)); }
  void operator()(const Field& field, const std::vector<std::array<double, 3>>& components) const {
    std::vector<std::string> texts;
    for (const auto& component : components) texts.push_back(list_text(component));
    write(field, fmt::format("[{}]", fmt::join(texts, ", ")));
  }
  void operator()(const Field& field, const std::vector<ReferenceSpec>& parts) const {
    std::vector<std::string> texts;
    for (const ReferenceSpec& part : parts) texts.push_back(dump_reference(part));
    write(field, fmt::format("[{}]", fmt::join(texts, ", ")));
  }
  void write(const Field& field, const std::string& value) const {
    out += fmt::format("{}{}: {}", out.empty() ? "" : ", ", field.key, value);
  }
};

}  // namespace

std::string dump_rig(const Rig& rig) {
  std::string out = fmt::format("# Rig {}{}\n", yaml_text(rig.name), dumped_rig_mark);
  Rig::visit(
      [&](const Field& field, const auto& value) {
        if (field.key == "effects") write_effects(field, rig, {}, out);
        else if (field.key == "concealed") write_concealed(field, rig, out);
        else SectionWriter(out, 0)(field, value);
      },
      rig);
  return out;
}

std::string dump_reference(const ReferenceSpec& reference) {
  std::string out;
  visit_reference(reference.kind, FlowWriter{out}, reference);
  return fmt::format("{{{}}}", out);
}

}  // namespace pneuservo
