// What the name of a column says of its quantity: its parts, one by one.
#include "record/column_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <vector>

#include <pneuservo/core/signal.hpp>

namespace pneuservo {

namespace {

/// Words that a column's name may begin with, in small letters without signs, and what it then is. The first that fits.
struct Word {
  std::string_view word, ours;
  Quantity quantity;
};
constexpr std::string_view column_of(Signal signal) { return info(signal).column; }
constexpr std::array<Word, 73> quantity_words{{{"timestamp", "t_s", Quantity::time},
                                               {"time", "t_s", Quantity::time},
                                               {"zeit", "t_s", Quantity::time},
                                               {"temps", "t_s", Quantity::time},
                                               {"elapsed", "t_s", Quantity::time},
                                               {"uhrzeit", "t_s", Quantity::time},
                                               {"date", "t_s", Quantity::time},
                                               {"datum", "t_s", Quantity::time},
                                               {"xvalue", "t_s", Quantity::time},
                                               {"stamp", "t_s", Quantity::time},
                                               {"uptime", "t_s", Quantity::time},
                                               {"tiempo", "t_s", Quantity::time},
                                               {"tempo", "t_s", Quantity::time},
                                               {"tijd", "t_s", Quantity::time},
                                               {"millis", "t_s", Quantity::time},
                                               {"micros", "t_s", Quantity::time},
                                               {"msec", "t_s", Quantity::time},
                                               {"usec", "t_s", Quantity::time},
                                               {"ms", "t_s", Quantity::time},
                                               {"us", "t_s", Quantity::time},
                                               {"t", "t_s", Quantity::time},
                                               {"xref", "x_ref_m", Quantity::length},
                                               {"setpoint", "x_ref_m", Quantity::length},
                                               {"sollwert", "x_ref_m", Quantity::length},
                                               {"soll", "x_ref_m", Quantity::length},
                                               {"position", column_of(Signal::x), Quantity::length},
                                               {"pos", column_of(Signal::x), Quantity::length},
                                               {"displacement", column_of(Signal::x), Quantity::length},
                                               {"actualposition", column_of(Signal::x), Quantity::length},
                                               {"istposition", column_of(Signal::x), Quantity::length},
                                               {"weg", column_of(Signal::x), Quantity::length},
                                               {"lage", column_of(Signal::x), Quantity::length},
                                               {"hub", column_of(Signal::x), Quantity::length},
                                               {"stroke", column_of(Signal::x), Quantity::length},
                                               {"course", column_of(Signal::x), Quantity::length},
                                               {"x", column_of(Signal::x), Quantity::length},
                                               {"s", column_of(Signal::x), Quantity::length},
                                               {"command", "u_V", Quantity::voltage},
                                               {"cmd", "u_V", Quantity::voltage},
                                               {"valve", "u_V", Quantity::voltage},
                                               {"ventil", "u_V", Quantity::voltage},
                                               {"stell", "u_V", Quantity::voltage},
                                               {"commande", "u_V", Quantity::voltage},
                                               {"vanne", "u_V", Quantity::voltage},
                                               {"comando", "u_V", Quantity::voltage},
                                               {"mando", "u_V", Quantity::voltage},
                                               {"valvola", "u_V", Quantity::voltage},
                                               {"valvula", "u_V", Quantity::voltage},
                                               {"stuur", "u_V", Quantity::voltage},
                                               {"klep", "u_V", Quantity::voltage},
                                               {"u", "u_V", Quantity::voltage},
                                               {"p1chamber", column_of(Signal::p1_chamber), Quantity::pressure},
                                               {"p2chamber", column_of(Signal::p2_chamber), Quantity::pressure},
                                               {"chamber1", column_of(Signal::p1_chamber), Quantity::pressure},
                                               {"chamber2", column_of(Signal::p2_chamber), Quantity::pressure},
                                               {"kammer1", column_of(Signal::p1_chamber), Quantity::pressure},
                                               {"kammer2", column_of(Signal::p2_chamber), Quantity::pressure},
                                               {"psupply", column_of(Signal::p_supply), Quantity::pressure},
                                               {"supply", column_of(Signal::p_supply), Quantity::pressure},
                                               {"versorgung", column_of(Signal::p_supply), Quantity::pressure},
                                               {"ps", column_of(Signal::p_supply), Quantity::pressure},
                                               {"p0", column_of(Signal::p_supply), Quantity::pressure},
                                               {"p1", column_of(Signal::p1_port), Quantity::pressure},
                                               {"p2", column_of(Signal::p2_port), Quantity::pressure},
                                               {"pressure1", column_of(Signal::p1_port), Quantity::pressure},
                                               {"pressure2", column_of(Signal::p2_port), Quantity::pressure},
                                               {"druck1", column_of(Signal::p1_port), Quantity::pressure},
                                               {"druck2", column_of(Signal::p2_port), Quantity::pressure},
                                               {"pa", column_of(Signal::p1_port), Quantity::pressure},
                                               {"pb", column_of(Signal::p2_port), Quantity::pressure},
                                               {"force", column_of(Signal::F), Quantity::force},
                                               {"kraft", column_of(Signal::F), Quantity::force},
                                               {"f", column_of(Signal::F), Quantity::force}}};
constexpr std::size_t whole_word = 2;  ///< letters: so short a word must be all of the name

/// Parts of a name that make it another quantity than the rest of it says.
constexpr std::array<std::string_view, 49> derived{"error",
                                                   "err",
                                                   "fehler",
                                                   "deviation",
                                                   "abweichung",
                                                   "difference",
                                                   "diff",
                                                   "velocity",
                                                   "vel",
                                                   "speed",
                                                   "geschwindigkeit",
                                                   "dot",
                                                   "acceleration",
                                                   "accel",
                                                   "acc",
                                                   "beschleunigung",
                                                   "jerk",
                                                   "temperature",
                                                   "temperatur",
                                                   "temp",
                                                   "current",
                                                   "strom",
                                                   "power",
                                                   "leistung",
                                                   "state",
                                                   "status",
                                                   "mode",
                                                   "flag",
                                                   "valid",
                                                   "validity",
                                                   "quality",
                                                   "limit",
                                                   "min",
                                                   "max",
                                                   "std",
                                                   "rms",
                                                   "alarm",
                                                   "enable",
                                                   "enabled",
                                                   "timeout",
                                                   "flow",
                                                   "durchfluss",
                                                   "torque",
                                                   "humidity",
                                                   "regelabweichung",
                                                   "lag",
                                                   "count",
                                                   "counter",
                                                   "id"};
constexpr std::array<std::string_view, 13> reference{"setpoint", "set",       "sp",     "soll",   "sollwert",
                                                     "ref",      "reference", "target", "demand", "desired",
                                                     "cmd",      "commanded", "command"};
/// Of a valve: what its spool does, which is not its command.
constexpr std::array<std::string_view, 11> feedback{"feedback", "fb",   "actual",   "act",   "ist",     "monitor",
                                                    "measured", "meas", "readback", "spool", "position"};
/// Of a name: what may stand before or behind the quantity without a change of it.
constexpr std::array<std::string_view, 12> saying_nothing{
    "filtered", "filt", "raw", "measured", "meas", "actual", "act", "sensor", "signal", "value", "input", "analog"};
/// Before "time": how long something takes, not when.
constexpr std::array<std::string_view, 15> lasting{"timeout",  "cycle",  "task",     "exec", "execution",
                                                   "dead",     "delay",  "rise",     "loop", "period",
                                                   "response", "filter", "settling", "run",  "computing"};
constexpr std::array<std::string_view, 8> pressure_words{"pressure", "press",     "druck", "pression",
                                                         "presion",  "pressione", "druk",  "p"};
constexpr std::array<std::string_view, 8> supply_words{"supply",  "versorgung",    "source",       "alimentation",
                                                       "network", "alimentazione", "alimentacion", "voeding"};
constexpr std::array<std::string_view, 6> chamber_words{"chamber", "kammer", "chambre", "camera", "camara", "kamer"};
constexpr std::array<std::string_view, 5> voltage_words{"voltage", "spannung", "tension", "tensione", "spanning"};

template <std::size_t N> bool is_one_of(std::string_view part, const std::array<std::string_view, N>& list) {
  return std::find(list.begin(), list.end(), part) != list.end();
}

template <std::size_t N> const std::string* one_of(const std::vector<std::string>& parts,
                                                   const std::array<std::string_view, N>& list) {
  const auto at =
      std::find_if(parts.begin(), parts.end(), [&](const std::string& part) { return is_one_of(part, list); });
  return at == parts.end() ? nullptr : &*at;
}

/// Latin letters with signs above or below them without these, in small letters: "Presi\u00f3n" is "presion".
std::string without_signs(std::string_view text) {
  constexpr std::string_view plain = "aaaaaaaceeeeiiiidnooooo ouuuuyysaaaaaaaceeeeiiiidnooooo ouuuuyyy";
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_latin = static_cast<unsigned char>(text[i]) == 0xc3 && i + 1 < text.size();
    const char letter = is_latin ? plain[static_cast<unsigned char>(text[i + 1]) & 0x3f] : ' ';
    if (letter == ' ') out += text[i];
    else out += letter, ++i;
  }
  return out;
}

/// "lrActual_Position2" is lr, actual, position, 2; "p1" stays whole. Letters beyond ASCII are letters.
std::vector<std::string> parts_of(std::string_view signed_text) {
  const std::string text = without_signs(signed_text);
  std::vector<std::string> parts(1);
  unsigned char before = ' ';
  for (const char c : text) {
    const auto now = static_cast<unsigned char>(c);
    const bool is_letter = std::isalpha(now) || now >= 0x80, is_digit = std::isdigit(now) != 0;
    const bool begins =
        (std::isupper(now) && std::islower(before)) || (is_digit && std::isalpha(before) && parts.back().size() > 1);
    if (begins || !(is_letter || is_digit)) parts.emplace_back();
    if (is_letter || is_digit) parts.back() += static_cast<char>(std::tolower(now));
    before = now;
  }
  std::erase(parts, std::string());
  return parts;
}

/// Of a path such as /axis/position, Main.x, Scope/Valve:1 the last part that has a letter.
std::string_view last_of_path(std::string_view text) {
  for (std::size_t end = text.size(); end > 0;) {
    const std::size_t sign = text.find_last_of("/.:\\|", end - 1);
    const std::size_t begin = sign == std::string_view::npos ? 0 : sign + 1;
    const std::string_view part = text.substr(begin, end - begin);
    if (std::any_of(part.begin(), part.end(), [](unsigned char c) { return std::isalpha(c) || c >= 0x80; }))
      return part;
    end = begin > 0 ? begin - 1 : 0;
  }
  return text;
}

const Word* word_in(const std::string& letters) {
  for (const Word& word : quantity_words)
    if (letters == word.word || (word.word.size() > whole_word && letters.starts_with(word.word))) return &word;
  return nullptr;
}

/// The word that the name begins with, else one that a later part begins with and that is long enough to be sure.
const Word* word_among(const std::vector<std::string>& parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::string joined;
    for (std::size_t k = i; k < parts.size(); ++k) joined += parts[k];
    const Word* word = word_in(joined);
    if (word != nullptr && (i == 0 || word->word.size() > whole_word)) return word;
  }
  return nullptr;
}

/// "Pressure A", "Kammer 2 Druck", "supply pressure"; none where no pressure is named, or not whose.
std::optional<ColumnWord> pressure_among(const std::vector<std::string>& parts) {
  const std::string* noun = one_of(parts, pressure_words);
  if (noun == nullptr) return std::nullopt;
  const bool is_first = one_of(parts, std::array<std::string_view, 2>{"1", "a"}) != nullptr;
  const bool is_second = one_of(parts, std::array<std::string_view, 2>{"2", "b"}) != nullptr;
  const bool is_supply = one_of(parts, supply_words) != nullptr;
  if (!is_supply && is_first == is_second) return std::nullopt;
  const std::string place = one_of(parts, chamber_words) != nullptr ? "chamber" : "pressure";
  const Word* whose = word_in(is_supply ? "supply" : place + (is_first ? "1" : "2"));
  return ColumnWord{*noun, whose->ours, whose->quantity};
}

/// What stands beside the quantity and makes it another; nullptr: nothing.
const std::string* what_else(const Word& word, const std::vector<std::string>& parts) {
  if (word.quantity == Quantity::time) return one_of(parts, lasting);
  if (const std::string* other = one_of(parts, derived)) return other;
  if (word.ours == "u_V") return one_of(parts, feedback);
  if (word.quantity == Quantity::length) return one_of(parts, voltage_words);
  if (const std::string* other = one_of(parts, reference)) return other;
  return word.quantity == Quantity::pressure ? one_of(parts, voltage_words) : nullptr;
}

std::optional<ColumnWord> word_of(const std::vector<std::string>& parts) {
  std::vector<std::string> telling = parts;
  std::erase_if(telling, [](const std::string& part) { return is_one_of(part, saying_nothing); });
  const Word* whole = word_among(parts);
  const Word* word = whole != nullptr ? whole : word_among(telling);
  const std::optional<ColumnWord> pressure = pressure_among(parts);
  const bool is_pressure = pressure && (word == nullptr || word->quantity != Quantity::time);
  if (!is_pressure && word == nullptr) return std::nullopt;
  const Word found = is_pressure ? Word{pressure->word, pressure->ours, pressure->quantity} : *word;
  if (const std::string* other = what_else(found, parts)) return ColumnWord{*other, "", Quantity::other};
  const bool is_reference = found.ours == column_of(Signal::x) && one_of(parts, reference) != nullptr;
  return ColumnWord{std::string(found.word), is_reference ? "x_ref_m" : found.ours, found.quantity};
}

}  // namespace

std::optional<ColumnWord> column_word(std::string_view text) {
  // "Position.Cmd" is no command of a valve: a last part that may belong to anything is judged with what is before it.
  const std::vector<std::string> last = parts_of(last_of_path(text));
  if (const std::optional<ColumnWord> found = word_of(last); found && !is_one_of(found->word, reference)) return found;
  return word_of(parts_of(text));
}

}  // namespace pneuservo
