// A YAML document as a plain tree in which every node knows where it was written: file and line, or a --set.
#include "config/config_tree.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "config/input_error.hpp"
#include "config/input_text.hpp"

namespace pneuservo {

namespace {

constexpr int deepest_nesting = 50;
constexpr int most_nodes = 200000;  // aliases of aliases grow without bound

/// Builds the tree of one document; `line_origin` is false for a --set, whose lines say nothing.
class TreeBuilder {
 public:
  TreeBuilder(std::string source, bool has_lines) : source_(std::move(source)), has_lines_(has_lines) {}

  ConfigNode build(const YAML::Node& yaml, const std::string& path, int depth) {
    ConfigNode node;
    node.origin = origin(yaml.Mark());
    if (depth > deepest_nesting || ++count_ > most_nodes)
      refuse(node.origin, path, "nesting or aliases without end", "a config of plain sections");
    if (yaml.IsScalar()) {
      node.type = ConfigNode::Type::scalar;
      node.text = yaml.Scalar();
      node.quoted = yaml.Tag() == "!";
    } else if (yaml.IsSequence()) {
      node.type = ConfigNode::Type::list;
      for (const YAML::Node& item : yaml)
        node.items.push_back(build(item, join_path(path, std::to_string(node.items.size())), depth + 1));
    } else if (yaml.IsMap()) {
      node.type = ConfigNode::Type::map;
      for (const auto& pair : yaml) add_entry(node, pair.first, pair.second, path, depth);
    }
    return node;
  }

 private:
  void add_entry(ConfigNode& map, const YAML::Node& key, const YAML::Node& value, const std::string& path, int depth) {
    const std::string where = origin(key.Mark());
    if (!key.IsScalar()) refuse(where, path.empty() ? "(top)" : path, "a key that is not plain text", "a name as key");
    const std::string full = join_path(path, printable(key.Scalar()));
    if (full != join_path(path, key.Scalar()))
      refuse(where, full, "a control character in the key", "a name of printable characters");
    if (const ConfigNode::Entry* first = map.find(key.Scalar()))
      refuse(where, full, fmt::format("the key a second time (the first is at {})", first->origin), "every key once");
    map.entries.push_back({key.Scalar(), where, build(value, full, depth + 1)});
    // YAML places an absent value at whatever follows; the reader of the message looks for the key.
    if (value.IsNull()) map.entries.back().value.origin = where;
  }
  std::string origin(const YAML::Mark& mark) const {
    return has_lines_ ? fmt::format("{}:{}", source_, mark.line + 1) : source_;
  }

  std::string source_;
  bool has_lines_;
  int count_ = 0;
};

/// Notes where documents begin, and nothing else.
class DocumentStarts : public YAML::EventHandler {
 public:
  std::vector<YAML::Mark> marks;
  void OnDocumentStart(const YAML::Mark& mark) override { marks.push_back(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// Where the first two documents begin. LoadAll would find documents without end in a text that starts with a comma
/// or a closing bracket: the parser takes such a sign for an empty document and does not go on.
std::vector<YAML::Mark> first_documents(const std::string& yaml_text) {
  std::istringstream stream(yaml_text);
  YAML::Parser parser(stream);
  DocumentStarts starts;
  while (starts.marks.size() < 2 && parser.HandleNextDocument(starts)) {}
  return starts.marks;
}

/// What stands at the front of a line where only a certain number of blanks may.
struct Indentation {
  int line;  ///< counted from 0
  std::string found, expected;
};

/// A tab, or a line that stands farther in than the key before it: what a parser's words do not say.
std::optional<Indentation> wrong_indentation(const std::string& yaml_text, int last_line) {
  std::istringstream lines(yaml_text);
  std::string text;
  std::size_t before = 0;
  bool is_key = false;  // the line before holds a key with its value
  for (int line = 0; line <= last_line && std::getline(lines, text); ++line) {
    const std::size_t blanks = text.find_first_not_of(' '), front = text.find_first_not_of(" \t\r");
    if (front == std::string::npos || text[front] == '#') continue;
    if (text[blanks] == '\t')
      return Indentation{line, "a tab at the front of the line",
                         "blanks instead, two for each step: YAML takes no tabs"};
    if (line == last_line && is_key && blanks > before)
      return Indentation{line, fmt::format("a line that begins with {} blanks, behind one with {}", blanks, before),
                         "the keys of one section behind the same number of blanks"};
    before = blanks;
    const std::size_t colon = text.find(": "),
                      value = text.find_first_not_of(' ', std::min(colon, text.size() - 1) + 1);
    is_key = colon != std::string::npos && value != std::string::npos && text[value] != '#';
  }
  return std::nullopt;
}

ConfigNode load(const std::string& yaml_text, const std::string& source, bool has_lines, const std::string& path,
                const std::string& expected) {
  const auto line = [&](const YAML::Mark& mark) {
    return has_lines ? fmt::format("{}:{}", source, mark.line + 1) : source;
  };
  try {
    const std::vector<YAML::Mark> documents = first_documents(yaml_text);
    if (documents.empty()) refuse(has_lines ? source + ":1" : source, path, "nothing", expected);
    if (documents.size() > 1 && documents[1].pos == documents[0].pos)
      refuse(line(documents[0]), path, "text that is not YAML (a sign where a key should be)", expected);
    if (documents.size() > 1) refuse(line(documents[1]), path, "a second YAML document", "one document");
    return TreeBuilder(source, has_lines).build(YAML::Load(yaml_text), path == "(file)" ? "" : path, 0);
  } catch (const YAML::ParserException& error) {
    if (const auto wrong = wrong_indentation(yaml_text, error.mark.line); wrong && has_lines)
      refuse(fmt::format("{}:{}", source, wrong->line + 1), path, wrong->found, wrong->expected);
    refuse(line(error.mark), path, fmt::format("text that is not YAML ({})", error.msg), expected);
  } catch (const YAML::Exception& error) {
    refuse(source, path, fmt::format("text that is not YAML ({})", error.msg), expected);
  }
}

/// The node that the next part of a path names; a new, empty one where the map does not have it yet.
ConfigNode& step_into(ConfigNode& node, const std::string& key, const std::string& path, const std::string& origin) {
  if (node.type == ConfigNode::Type::list) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), index);
    if (error != std::errc{} || end != key.data() + key.size() || index >= node.items.size())
      refuse(origin, path, fmt::format("no item {} there", key),
             fmt::format("an index from 0 to {}", static_cast<long>(node.items.size()) - 1));
    return node.items[index];
  }
  if (node.type == ConfigNode::Type::scalar)
    refuse(origin, path, fmt::format("{} at the place of a section", describe(node)), "the path of a key");
  node.type = ConfigNode::Type::map;
  if (ConfigNode::Entry* entry = node.find(key)) return entry->value;
  node.entries.push_back({key, origin, {}});
  node.entries.back().value.origin = origin;
  return node.entries.back().value;
}

}  // namespace

const ConfigNode::Entry* ConfigNode::find(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& entry) { return entry.key == key; });
  return found == entries.end() ? nullptr : &*found;
}
ConfigNode::Entry* ConfigNode::find(const std::string& key) {
  return const_cast<Entry*>(static_cast<const ConfigNode*>(this)->find(key));
}

ConfigNode parse_config_tree(const std::string& yaml_text, const std::string& source_name) {
  return load(yaml_text, source_name, true, "(file)", "a config in YAML (docs/config-keys.md)");
}

void apply_override(ConfigNode& root, const std::string& path_and_value) {
  const std::string origin = "--set " + path_and_value;
  const std::size_t equals = path_and_value.find('=');
  if (equals == std::string::npos || equals == 0)
    refuse(origin, "(path)", fmt::format("'{}'", path_and_value), "PATH=VALUE, as in line_1.length_m=5");
  const std::string path = path_and_value.substr(0, equals);
  ConfigNode value = load(path_and_value.substr(equals + 1), origin, false, path, "a value in YAML after the =");
  if (value.type == ConfigNode::Type::nothing) refuse(origin, path, "nothing", "a value in YAML after the =");

  ConfigNode* node = &root;
  for (std::size_t start = 0; start <= path.size();) {
    // The keys under `tolerances` and `deviations` are paths themselves.
    const std::string section = path.substr(0, start);
    const bool whole_rest = section == "tolerances." || section == "deviations.";
    const std::size_t dot = whole_rest ? std::string::npos : path.find('.', start);
    const std::string key = path.substr(start, dot == std::string::npos ? dot : dot - start);
    if (key.empty()) refuse(origin, path, "an empty name in the path", "names with single dots between");
    node = &step_into(*node, key, path, origin);
    if (dot == std::string::npos) break;
    start = dot + 1;
  }
  *node = std::move(value);
}

std::string printable(std::string_view text) {
  std::string shown(text);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const auto c = static_cast<unsigned char>(shown[i]);
    if (c < 0x20 || c == 0x7f) shown[i] = ' ';
    // UTF-8 of the control characters U+0080 to U+009F, of which terminals obey some.
    const bool second = i > 0 && static_cast<unsigned char>(shown[i - 1]) == 0xc2 && c >= 0x80 && c < 0xa0;
    if (second) shown[i - 1] = shown[i] = ' ';
  }
  return shown;
}

std::string describe(const ConfigNode& node) {
  switch (node.type) {
    case ConfigNode::Type::nothing: return "nothing";
    case ConfigNode::Type::list: return "a list";
    case ConfigNode::Type::map: return "a map of keys";
    case ConfigNode::Type::scalar: break;
  }
  std::string shown = printable(node.text.substr(0, 60));
  if (node.text.size() > 60) shown += "...";
  return node.quoted ? fmt::format("the quoted text \"{}\"", shown) : fmt::format("'{}'", shown);
}

void refuse(const std::string& origin, const std::string& path, const std::string& found, const std::string& expected) {
  throw InputError(fmt::format("{}: {}: found {}, expected {}", origin, path, found, expected));
}

std::string join_path(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

ConfigNode read_config_tree(const std::filesystem::path& file, const std::string& expected) {
  return parse_config_tree(read_input_text(file, expected), file.string());
}

}  // namespace pneuservo
