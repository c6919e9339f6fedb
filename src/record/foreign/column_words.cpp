// What the name of a column says of its quantity: roots of words in its parts, and the role of each.
#include "record/foreign/column_words.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <pneuservo/core/signal.hpp>

#include "record/foreign/field_text.hpp"

namespace pneuservo {

namespace {

/// What a root says. `supply` to `side_2` say whose pressure, `actual` to `lasting` what kind of value; `apart` is
/// another quantity beside the one that is named, also where it stands before it in a path, `state` is so in the name
/// alone, `elsewhere` is the quantity of another part or moment, `computed` the one of a model; `filler` changes
/// nothing.
enum class Role : std::uint8_t {
  time,
  position,
  pressure,
  force,
  flow,
  valve,
  command,
  actuation,
  output,
  voltage,
  supply,
  chamber,
  cylinder,
  port,
  rod,
  cap,
  piston,
  end,
  side_1,
  side_2,
  actual,
  reference,
  apart,
  state,
  elsewhere,
  computed,
  gauge,
  lasting,
  filler
};  // clang-format off

struct Roots {
  Role role;
  std::string_view words;  ///< small letters without signs
};
/// English, German, French, Spanish, Italian, Portuguese, Dutch, Swedish, Polish, Czech, Finnish, Japanese, Chinese, Russian, Korean.
constexpr std::array roots_of_roles{
    Roots{Role::time, "t time timestamp stamp tick ticks tv sec secs seconds sekunden nsec nsecs nanosec elapsed uptime date clock millis micros msec usec ms us xvalue zeit "
          "zeitstempel uhrzeit datum temps heure horodatage tiempo fecha hora tempo ora tijd tijdstip tid czas cas aika"},
    Roots{Role::position, "x s pos position displacement stroke travel way place course weg hub lage stellung auslenkung "
          "verschiebung deplacement posicion desplazamiento carrera recorrido posizione spostamento corsa posicao "
          "deslocamento curso positie verplaatsing slag lage pozycja polozenie wychylenie przemieszczenie skok poloha zdvih asema iskunpituus "
          "actualposition"},
    Roots{Role::pressure, "p press pres pressure pressures druck pression presion pressione pressao druk tryck trykk "
          "cisnienie tlak paine"},
    Roots{Role::force, "f force kraft fuerza forza forca kracht sila voima loadcell kraftmessdose kraftaufnehmer lastzelle"},
    Roots{Role::flow, "flow durchfluss volumenstrom massenstrom debit caudal portata consumption luftverbrauch verbrauch"},
    Roots{Role::valve, "valve ventil vanne distributeur valvola valvula klep ventiel zawor venttiili servovalve"},
    Roots{Role::command, "cmd command commanded commande comando mando kommando befehl comanda"},
    Roots{Role::actuation, "u control stell stellgrosse stellgrose stellgroesse stellgrad steuer steuerung ansteuerung stuur styr "
          "styrning sterowanie sterujace ovladani ohjaus controllo"},
    Roots{Role::output, "output out ausgang sortie salida uscita saida uitgang utgang wyjscie vystup"},
    Roots{Role::voltage, "voltage volt volts spannung tension tensione tensao spanning spanning napiecie napeti jannite"},
    Roots{Role::supply, "supply sup psup inlet betriebs betrieb source network mains compressor versorgung vers vordruck netz system quelle "
          "speisung alimentation reseau alimentacion suministro alimentazione rete alimentacao voeding matning zasilanie "
          "napajeni syotto kompressor"},
    Roots{Role::chamber, "chamber kammer chambre camera camara kamer kammare komora kammio"},
    Roots{Role::port, "port anschluss anschlus connection connector raccord orifice puerto conexion attacco bocca poort "
          "aansluiting anslutning przylacze"},
    Roots{Role::rod, "rod rodside stange stangen kolbenstange kolbenstangen stangenseite kolbenstangenseite ring ringraum "
          "ringseite annulus tige vastago stelo stang haste"},
    Roots{Role::cap, "cap capside blind bore bodenseite boden kolbenseite kolbenraum kolbenkammer fond fondo fondello"},
    Roots{Role::piston, "piston kolben pistone embolo zuiger kolv tlok pist mannan"},
    Roots{Role::cylinder, "cylinder cyl zylinder zyl verin cilindro cilinder cylindre cilindru silownik sylinteri"},
    Roots{Role::end, "side seite cote lado lato zijde sida end ende"},
    Roots{Role::side_1, "1 a extend"},
    Roots{Role::side_2, "2 b retract"},
    Roots{Role::actual, "act actual ist istwert feedback fb measured meas monitor readback gemessen messwert ruckmeldung "
          "rueckmeldung mesure mesuree reel reelle retour recopie medido medida real misurato misurata attuale gemeten "
          "werkelijke"},
    Roots{Role::reference, "set setpoint sp ref reference target demand desired wanted soll sollwert fuhrungsgrosse fuhrungsgrose "
          "fuehrungsgroesse vorgabe ziel referenz consigne cible consigna referencia objetivo riferimento obiettivo "
          "gewenst streefwaarde borvarde zadana zadane zadany zadana"},
    Roots{Role::apart, "err error fehler erreur errore deviation abweichung ecart difference diff differenz differential "
          "differenziale diferencial delta vel velocity speed geschwindigkeit vitesse velocidad velocita snelheid dot "
          "acceleration accel acc beschleunigung jerk ruck rate temperature temperatur temperatura twist imu "
          "orientation observer beobachter estimator kalman "
          "limit grenze endlage endschalter lager bearing min max mean average mittelwert std rms alarm timeout "
          "torque moment drehmoment humidity feuchte regelabweichung lag schleppfehler "
          "spool estimated estimate est geschatzt geschaetzt estime friction reibung reib frottement "
          "friccion rozamiento attrito wrijving volume volumen area flache flaeche"},
    Roots{Role::state, "state status mode flag valid validity quality enable enabled count counter zahler zaehler id temp current "
          "strom courant corriente corrente stroom power leistung puissance"},
    Roots{Role::elsewhere, "pilot vorsteuer pilotage pilotaggio exhaust abluft entluftung entlueftung echappement scarico escape start init "
          "initial home homing previous prev old vorher shutoff absperr brake bremse frein "
          "freno freio total gesamt lockout relief safety sicherheit"},
    Roots{Role::computed, "calculated calc berechnet calcule simulated simuliert sim model modell theoretical true"},
    Roots{Role::gauge, "gauge gage relative relativ rel uber ueber"},
    Roots{Role::lasting, "timeout cycle zyklus takt task exec execution dead tot delay verzug verzogerung rise loop period "
          "response filter settling step interval run lauf computing abtast sampling duration dauer duree"},
    Roots{Role::filler, "sensor sensors fuhler fuehler aufnehmer geber transducer transmitter capteur "
          "trasduttore sensore transductor signal segnale senal sinal signaal value val wert valeur valor valore waarde input "
          "eingang entree entrada ingresso ingang analog analogue ai ao channel kanal canal canale ch raw roh brut "
          "fast slow schnell langsam filtered filt gefiltert filtree filtrado filtrato gefilterd "
          "air luft aria aire lucht axis achse axe eje asse drive antrieb actuator slider schlitten "
          "carriage load last servo proportional prop regler controller regel absolute absolut abs "
          "working arbeits of the der die das des dem den de du la le les l d del della dell dello di da do el los van het "
          "en in im at am an bei on to main stempel lr no nr number"},
    // Japanese and Chinese
    Roots{Role::time, "時間 時刻 时间 时刻"},
    Roots{Role::position, "位置 変位 ストローク 位移 行程"},
    Roots{Role::pressure, "圧力 圧 压力 气压 压"},
    Roots{Role::force, "力 推力 荷重"},
    Roots{Role::flow, "流量"},
    Roots{Role::valve, "バルブ 弁 サーボ弁 阀 阀门 比例阀 伺服阀"},
    Roots{Role::command, "指令 命令"},
    Roots{Role::actuation, "制御 操作量 控制"},
    Roots{Role::output, "出力 输出"},
    Roots{Role::voltage, "電圧 电压"},
    Roots{Role::supply, "供給 元圧 供气 气源 供给"},
    Roots{Role::chamber, "室 腔 气腔"},
    Roots{Role::port, "ポート 端口 口"},
    Roots{Role::rod, "ロッド 有杆"},
    Roots{Role::cap, "ヘッド ボトム 无杆"},
    Roots{Role::cylinder, "シリンダ シリンダー 气缸 缸"},
    Roots{Role::end, "側 侧"},
    Roots{Role::actual, "実際 現在 実 検出 フィードバック 实际 反馈 测量"},
    Roots{Role::reference, "目標 設定 目标 设定 给定 期望"},
    Roots{Role::apart, "偏差 誤差 速度 加速度 温度 電流 误差 电流"},
    Roots{Role::filler, "センサ センサー 値 の 信号 入力 軸 传感器 值 输入"},
    // Russian and Korean
    Roots{Role::time, "время времени отсчет дата секунды мс 시간 시각"},
    Roots{Role::position, "положение положения позиция позиции перемещение перемещения координата ход хода 위치 변위 행정 스트로크"},
    Roots{Role::pressure, "давление давления 압력 압"},
    Roots{Role::force, "сила силы усилие усилия нагрузка 힘 하중 추력"},
    Roots{Role::flow, "расход расхода 유량"},
    Roots{Role::valve, "клапан клапана распределитель распределителя золотник 밸브"},
    Roots{Role::command, "команда команды 명령 지령"},
    Roots{Role::actuation, "управление управления управляющее управляющий 제어 조작량"},
    Roots{Role::output, "выход выхода 출력"},
    Roots{Role::voltage, "напряжение напряжения 전압"},
    Roots{Role::supply, "питание питания магистраль магистрали источник источника компрессор сети 공급 공급원"},
    Roots{Role::chamber, "камера камеры камере полость полости 챔버 실"},
    Roots{Role::port, "порт порта 포트"},
    Roots{Role::rod, "шток штока штоковая штоковой 로드"},
    Roots{Role::cap, "поршневая поршневой бесштоковая бесштоковой 헤드"},
    Roots{Role::piston, "поршень поршня 피스톤"},
    Roots{Role::cylinder, "цилиндр цилиндра пневмоцилиндр пневмоцилиндра 실린더"},
    Roots{Role::end, "сторона стороны 측 쪽"},
    Roots{Role::side_1, "а"},
    Roots{Role::side_2, "б"},
    Roots{Role::actual, "факт фактическое фактическая измеренное измеренная текущее текущая обратная 실제 현재 측정 피드백"},
    Roots{Role::reference, "задание задания заданное заданная уставка уставки цель 목표 설정 기준"},
    Roots{Role::apart, "ошибка ошибки скорость скорости ускорение температура температуры ток тока перепад разность "
          "오차 속도 가속도 온도 전류 차압"},
    Roots{Role::filler, "датчик датчика сигнал сигнала значение воздух воздуха на в 센서 값 신호 입력 축 의"}};
// clang-format on
constexpr std::string_view path_signs = "/.:\\|";
constexpr std::size_t least_of_compound = 3, least_of_prefix = 4;  ///< letters

const std::map<std::string_view, Role>& role_of_root() {
  static const std::map<std::string_view, Role> roles = [] {
    std::map<std::string_view, Role> out;
    for (auto [role, words] : roots_of_roles)
      while (!words.empty()) {
        const std::size_t end = std::min(words.find(' '), words.size());
        out.emplace(words.substr(0, end), role);
        words.remove_prefix(std::min(end + 1, words.size()));
      }
    return out;
  }();
  return roles;
}

using Found = std::pair<std::string_view, Role>;  ///< a root and its role

const Found* found_root(std::string_view word) {
  static const std::vector<Found> all(role_of_root().begin(), role_of_root().end());
  const auto at = std::lower_bound(all.begin(), all.end(), Found{word, Role::time});
  return at != all.end() && at->first == word ? &*at : nullptr;
}

/// A name as roots in their order.
struct RootsOfName {
  std::vector<Found> roots;
  bool is_whole = true;  ///< nothing else stands in it

  const Found* first_of(Role role) const {
    const auto at = std::find_if(roots.begin(), roots.end(), [&](const Found& root) { return root.second == role; });
    return at == roots.end() ? nullptr : &*at;
  }
  bool has(Role role) const { return first_of(role) != nullptr; }
};

/// A Cyrillic letter of two bytes as a small one; yo as ye.
std::string small_cyrillic(std::string_view letter) {
  constexpr unsigned capital_a = 0x410, small_a = 0x430, last_capital = 0x42f, capital_yo = 0x401, small_yo = 0x451;
  unsigned code =
      (static_cast<unsigned char>(letter[0]) & 0x1fu) << 6 | (static_cast<unsigned char>(letter[1]) & 0x3fu);
  if (code >= capital_a && code <= last_capital) code += small_a - capital_a;
  if (code == capital_yo || code == small_yo) code = small_a + 5;
  return {static_cast<char>(0xc0 | (code >> 6)), static_cast<char>(0x80 | (code & 0x3f))};
}

/// Latin letters with signs above or below them without these, in small letters: "Presi\u00f3n" is "presion".
std::string without_signs(std::string_view text) {
  constexpr std::string_view plain = "aaaaaaaceeeeiiiidnooooo ouuuuyysaaaaaaaceeeeiiiidnooooo ouuuuyyy"
                                     "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiiiiijjkkklllllll"
                                     "lllnnnnnnnnnoooooooorrrrrrssssssssttttttuuuuuuuuuuuuwwyyyzzzzzzs";
  constexpr unsigned char first_lead = 0xc3, last_lead = 0xc5;
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto lead = static_cast<unsigned char>(text[i]);
    if ((lead == 0xd0 || lead == 0xd1) && i + 1 < text.size()) {
      out += small_cyrillic(text.substr(i++, 2));
      continue;
    }
    const bool is_latin = lead >= first_lead && lead <= last_lead && i + 1 < text.size();
    const std::size_t at = is_latin ? (lead - first_lead) * 64U + (static_cast<unsigned char>(text[i + 1]) & 0x3fU) : 0;
    const char letter = is_latin ? plain[at] : ' ';
    if (letter == ' ') out += text[i];
    else out += letter, ++i;
  }
  return out;
}

/// "lrActual_Position2" is lr, actual, position, 2. Letters beyond ASCII are letters, and parts of their own.
std::vector<std::string> parts_of(std::string_view signed_text) {
  const std::string text = without_signs(signed_text);
  std::vector<std::string> parts(1);
  unsigned char before = ' ';
  for (const char c : text) {
    const auto now = static_cast<unsigned char>(c);
    const bool has_letter = is_letter(c), is_digit = std::isdigit(now) != 0;
    const bool begins = (std::isupper(now) && std::islower(before)) || is_digit != (std::isdigit(before) != 0) ||
                        (now >= 0x80) != (before >= 0x80);
    if (begins || !(has_letter || is_digit)) parts.emplace_back();
    if (has_letter || is_digit) parts.back() += static_cast<char>(std::tolower(now));
    before = now;
  }
  std::erase(parts, std::string());
  return parts;
}

/// Of a path such as /axis/position, Main.x, Scope/Valve:1 the last part that has a letter, and what is before it.
std::pair<std::string_view, std::string_view> last_of_path(std::string_view text) {
  for (std::size_t end = text.size(); end > 0;) {
    const std::size_t sign = text.find_last_of(path_signs, end - 1);
    const std::size_t begin = sign == std::string_view::npos ? 0 : sign + 1;
    const std::string_view part = text.substr(begin, end - begin);
    if (std::any_of(part.begin(), part.end(), is_letter)) return {part, text.substr(0, begin > 0 ? begin - 1 : 0)};
    end = begin > 0 ? begin - 1 : 0;
  }
  return {text, ""};
}

/// Whether the word is made of roots alone, joined as "Versorgung-s-druck"; they are added behind `roots`.
bool is_compound(std::string_view word, std::vector<Found>& roots) {
  if (word.empty()) return true;
  if (word.size() == 1 && !roots.empty()) {  // "DruckA"
    if (const Found* side = found_root(word); side && side->second >= Role::side_1 && side->second <= Role::side_2)
      return roots.push_back(*side), true;
    return false;
  }
  for (std::size_t size = word.size(); size >= least_of_compound; --size) {
    const Found* root = found_root(word.substr(0, size));
    if (root == nullptr) continue;
    const std::size_t before = roots.size();
    for (const std::string_view joint : {"", "s", "es", "n", "en", "e"}) {
      if (!word.substr(size).starts_with(joint)) continue;
      roots.push_back(*root);
      if (is_compound(word.substr(size + joint.size()), roots)) return true;
      roots.resize(before);
    }
  }
  return false;
}

/// "pa", "pb", "ps", "psupply": a pressure's sign with whose it is.
bool is_signed_pressure(std::string_view word, std::vector<Found>& roots) {
  if (word.size() < 2 || word.front() != 'p') return false;
  const Found* whose = word == "ps" ? found_root("supply") : found_root(word.substr(1));
  if (whose == nullptr || whose->second < Role::supply || whose->second > Role::side_2) return false;
  roots.push_back(*found_root("p"));
  roots.push_back(*whose);
  return true;
}

/// "positions", "temperatures": the root of four letters or more that the word begins with, the longest.
const Found* root_in_front(std::string_view word) {
  if (static_cast<unsigned char>(word.front()) >= 0x80) return nullptr;  // what follows a sign may change its sense
  for (std::size_t size = word.size(); size-- > least_of_prefix;)
    if (const Found* root = found_root(word.substr(0, size)); root && root->second != Role::filler) return root;
  return nullptr;
}

/// Before a name of IEC 61131 that says what it is of itself: "fActPos" is a float. "F piston" is a force.
std::vector<std::string> without_type(std::vector<std::string> parts) {
  constexpr std::array types{"f", "r", "n", "di", "ui", "udi", "dw"};
  if (parts.size() < 2 || std::find(types.begin(), types.end(), parts.front()) == types.end()) return parts;
  const bool says_what = std::any_of(parts.begin() + 1, parts.end(), [](const std::string& part) {
    const Found* root = part.size() > 1 ? found_root(part) : nullptr;
    return root != nullptr && root->second < Role::supply;
  });
  if (says_what) parts.erase(parts.begin());
  return parts;
}

RootsOfName roots_of(const std::vector<std::string>& name_parts) {
  const std::vector<std::string> parts = without_type(name_parts);
  RootsOfName out;
  std::string joined;
  for (const std::string& part : parts) joined += part;
  if (const Found* all = found_root(joined); all != nullptr && parts.size() > 1) return {{*all}, true};
  for (const std::string& part : parts) {
    if (const Found* root = found_root(part)) out.roots.push_back(*root);
    else if (is_compound(part, out.roots) || is_signed_pressure(part, out.roots)) continue;
    else if (const Found* front = root_in_front(part)) out.roots.push_back(*front);
    else out.is_whole = out.is_whole && part == "0";
  }
  // A sign of one or two letters is sure where the rest of the name is known.
  if (!out.is_whole)
    std::erase_if(out.roots, [](const Found& root) { return root.first.size() < 3 && root.second < Role::supply; });
  return out;
}

constexpr std::string_view column_of(Signal signal) { return info(signal).column; }
const ColumnWord other_than(const Found& root) { return {std::string(root.first), "", Quantity::other}; }

/// Side 1 or 2 of a pressure by its number or letter, else by the end of the cylinder; 0: none, or both.
int side_in(const RootsOfName& name) {
  const bool is_1 = name.has(Role::side_1), is_2 = name.has(Role::side_2);
  if (is_1 || is_2) return is_1 == is_2 ? 0 : is_1 ? 1 : 2;
  const bool is_rod = name.has(Role::rod);
  const bool is_cap =
      name.has(Role::cap) || (!is_rod && name.has(Role::piston) && (name.has(Role::chamber) || name.has(Role::end)));
  return is_rod == is_cap ? 0 : is_cap ? 1 : 2;
}

/// Of a name with a pressure, a chamber or a port, and of no other quantity.
std::optional<ColumnWord> pressure_in(const RootsOfName& name, const std::vector<std::string>& parts) {
  const Found* noun = nullptr;
  for (const Role role : {Role::pressure, Role::supply, Role::chamber, Role::port})
    if (noun == nullptr) noun = name.first_of(role);
  const bool is_sure = noun->second == Role::pressure;
  if (!is_sure && !name.is_whole) return std::nullopt;
  for (const Role role : {Role::reference, Role::command, Role::actuation, Role::voltage})
    if (const Found* another = name.first_of(role)) return other_than(*another);
  const bool is_p0 = noun->first == "p" && std::find(parts.begin(), parts.end(), "0") != parts.end();
  const auto found = [&](Signal signal) {
    return ColumnWord{std::string(noun->first), column_of(signal), Quantity::pressure, is_sure};
  };
  if (name.has(Role::supply) || is_p0) return found(Signal::p_supply);
  const int side = side_in(name);
  if (side == 0) return std::nullopt;
  const bool is_inside = name.has(Role::chamber) || (name.has(Role::cylinder) && !name.has(Role::port));
  const auto& signals = is_inside ? chamber_signals : port_signals;
  return found(signals[static_cast<std::size_t>(side - 1)]);
}

std::optional<ColumnWord> position_in(const RootsOfName& name) {
  for (const Role role : {Role::valve, Role::voltage, Role::actuation, Role::output})
    if (const Found* another = name.first_of(role)) return other_than(*another);
  const bool is_reference = name.has(Role::reference) || name.has(Role::command);
  return ColumnWord{std::string(name.first_of(Role::position)->first), is_reference ? "x_ref_m" : column_of(Signal::x),
                    Quantity::length};
}

std::optional<ColumnWord> force_in(const RootsOfName& name) {
  for (const Role role :
       {Role::pressure, Role::chamber, Role::reference, Role::command, Role::actuation, Role::voltage, Role::position})
    if (const Found* another = name.first_of(role)) return other_than(*another);
  return ColumnWord{std::string(name.first_of(Role::force)->first), column_of(Signal::F), Quantity::force};
}

/// Of the supply: a meter in a line or at a valve shows another flow.
std::optional<ColumnWord> flow_in(const RootsOfName& name) {
  for (const Role role : {Role::valve, Role::chamber, Role::port, Role::cylinder, Role::reference, Role::command})
    if (const Found* another = name.first_of(role)) return other_than(*another);
  const Found& noun = *name.first_of(Role::flow);
  if (side_in(name) != 0 || !(name.is_whole || name.has(Role::supply))) return other_than(noun);
  return ColumnWord{std::string(noun.first), column_of(Signal::supply_flow), Quantity::mass_flow, false};
}

/// Of a valve, or of what controls it.
std::optional<ColumnWord> command_in(const RootsOfName& name) {
  const Found* noun = nullptr;
  for (const Role role : {Role::valve, Role::actuation, Role::command})
    if (noun == nullptr) noun = name.first_of(role);
  if (noun == nullptr && name.is_whole && name.has(Role::output)) noun = name.first_of(Role::output);
  if (noun == nullptr) return std::nullopt;
  if (const Found* measured = name.first_of(Role::actual)) return other_than(*measured);
  if (const Found* supply = name.first_of(Role::supply)) return other_than(*supply);
  return ColumnWord{std::string(noun->first), "u_V", Quantity::voltage};
}

std::optional<ColumnWord> word_of(const std::vector<std::string>& parts) {
  const RootsOfName name = roots_of(parts);
  const auto quantity =
      std::find_if(name.roots.begin(), name.roots.end(), [](const Found& root) { return root.second < Role::actual; });
  for (const Role role : {Role::apart, Role::state, Role::computed})
    if (const Found* another = name.first_of(role); another != nullptr && quantity != name.roots.end())
      return other_than(*another);
  if (quantity != name.roots.end() && quantity->second == Role::time) {
    const Found* lasting = name.first_of(Role::lasting);
    return lasting ? other_than(*lasting) : ColumnWord{std::string(quantity->first), "t_s", Quantity::time};
  }
  if (name.has(Role::lasting) && name.has(Role::time)) return other_than(*name.first_of(Role::lasting));
  // The time since a start, or in total, is a time.
  if (const Found* elsewhere = name.first_of(Role::elsewhere); elsewhere != nullptr && quantity != name.roots.end())
    return other_than(*elsewhere);
  if (name.has(Role::force)) return force_in(name);
  if (name.has(Role::flow)) return flow_in(name);
  if (name.has(Role::pressure)) return pressure_in(name, parts);
  if (name.has(Role::position)) return position_in(name);
  if (const std::optional<ColumnWord> command = command_in(name)) return command;
  if (const Found* volts = name.first_of(Role::voltage)) return other_than(*volts);
  if (name.has(Role::supply) || name.has(Role::chamber) || name.has(Role::port)) return pressure_in(name, parts);
  for (const Role role : {Role::apart, Role::state, Role::computed, Role::elsewhere})
    if (name.has(role)) return std::nullopt;
  if (!name.is_whole) return std::nullopt;
  if (const Found* reference = name.first_of(Role::reference))
    return ColumnWord{std::string(reference->first), "x_ref_m", Quantity::length};
  if (const Found* actual = name.first_of(Role::actual))  // "Istwert [mm]"
    return ColumnWord{std::string(actual->first), column_of(Signal::x), Quantity::length, false};
  return std::nullopt;
}

/// What the parts of a path before its last one make of it, the nearest first: "setpoint.x" is a set point, "error/x"
/// no position, "actual.x" one. A last part that says so itself is what it says.
ColumnWord under(ColumnWord word, std::string_view part, std::string_view path) {
  const RootsOfName last = roots_of(parts_of(part));
  if (word.ours.empty() || last.has(Role::reference) || last.has(Role::actual)) return word;
  while (!path.empty()) {
    const std::size_t sign = path.find_last_of(path_signs);
    const RootsOfName name = roots_of(parts_of(path.substr(sign == std::string_view::npos ? 0 : sign + 1)));
    path = path.substr(0, sign == std::string_view::npos ? 0 : sign);
    if (name.has(Role::actual)) return word;
    const auto is_told = [&](const Found* root) { return root && (name.is_whole || root->first.size() > 3); };
    for (const Role role : {Role::apart, Role::elsewhere})
      if (const Found* another = name.first_of(role); is_told(another) && word.quantity != Quantity::time)
        return other_than(*another);
    const Found* reference = name.first_of(Role::reference);
    if (reference == nullptr && name.is_whole) reference = name.first_of(Role::command);
    if (is_told(reference) && word.quantity == Quantity::length) word.ours = "x_ref_m";
    else if (is_told(reference) && word.quantity != Quantity::voltage && word.quantity != Quantity::time)
      return other_than(*reference);
    // "wrench.force.x" is a force's part along x.
    if (const Found* of = name.first_of(Role::force); of && word.quantity == Quantity::length) return other_than(*of);
    if (is_told(reference)) return word;
  }
  return word;
}

/// Whether two names belong to one quantity and differ in what they say of it: "x" and "x_ref", "p1" and "p2".
bool are_compared(std::string_view one, std::string_view other) {
  const std::vector<std::string> parts = parts_of(one), others = parts_of(other);
  const std::optional<ColumnWord> word = word_of(parts), second = word_of(others);
  const auto has_quantity = [](const RootsOfName& name) {
    return name.has(Role::position) || name.has(Role::pressure);
  };
  return word && second && word->quantity == second->quantity && word->ours != second->ours &&
         has_quantity(roots_of(parts)) && has_quantity(roots_of(others));
}

/// What is computed of a quantity is none: "x^2", "|x|", "x'", "x/L", "x-x_ref", "p1/p2".
bool is_formula(std::string_view signed_text) {
  constexpr std::size_t longest_sign = 3;
  const std::string_view text = trimmed(signed_text);
  if (text.size() < 2) return false;
  if (text.find('^') != std::string_view::npos || text.find('\'') == text.size() - 1 ||
      (text.front() == '|' && text.back() == '|'))
    return true;
  if (const std::size_t minus = text.find('-'); minus != std::string_view::npos)
    if (are_compared(text.substr(0, minus), text.substr(minus + 1))) return true;
  const std::size_t over = text.find('/');
  if (over == std::string_view::npos || over == 0 || over > longest_sign || text.size() - over - 1 > longest_sign)
    return false;
  const std::vector<std::string> under_it = parts_of(text.substr(over + 1));
  const Found* root = under_it.size() == 1 && under_it[0].size() == 1 ? found_root(under_it[0]) : nullptr;
  const bool is_length = under_it.size() == 1 && under_it[0].size() == 1 && (!root || root->second == Role::filler);
  return (is_length && word_of(parts_of(text.substr(0, over)))) ||
         are_compared(text.substr(0, over), text.substr(over + 1));
}

}  // namespace

bool holds_known_word(std::string_view text) {
  constexpr std::size_t least_size = 4;
  const std::vector<std::string> parts = parts_of(text);
  return std::any_of(parts.begin(), parts.end(), [](const std::string& part) {
    std::vector<Found> roots;
    const bool may_be = static_cast<unsigned char>(part.front()) >= 0x80 || part.size() >= least_size;
    return may_be && (found_root(part) != nullptr || is_compound(part, roots));
  });
}

bool is_made_of_words(std::string_view text) {
  const std::vector<std::string> parts = parts_of(text);
  const RootsOfName name = roots_of(parts);
  return name.is_whole && std::any_of(name.roots.begin(), name.roots.end(),
                                      [](const Found& root) { return root.first.size() >= least_of_compound; });
}

bool may_name_axis(std::string_view word) {
  if (are_digits(word) || (word.size() == 1 && is_letter(word.front()))) return true;
  const std::vector<std::string> parts = parts_of(word);
  const RootsOfName name = roots_of(parts);
  const auto says_what = [&](const Found& root) {
    const bool is_sign = root.first.size() < least_of_compound && root.second != Role::pressure;
    return !is_sign && root.second != Role::cylinder && root.second != Role::filler;
  };
  const auto is_mark = [](const std::string& part) {
    return part.size() == 1 || std::isdigit(static_cast<unsigned char>(part.front())) != 0;
  };
  return std::ranges::none_of(name.roots, says_what) && (!name.is_whole || std::ranges::any_of(parts, is_mark));
}

bool says_pressure(std::string_view text) { return roots_of(parts_of(text)).has(Role::pressure); }

bool is_cylinder_word(std::string_view word) {
  const RootsOfName name = roots_of(parts_of(word));
  return name.is_whole && name.roots.size() == 1 && name.roots.front().second == Role::cylinder;
}

std::optional<int> port_number(std::string_view text) {
  std::vector<std::string> parts = parts_of(text);
  std::optional<int> number;
  for (const std::string& part : parts)
    if (part.size() == 1 && part[0] >= '1' && part[0] <= '5') {
      if (number) return std::nullopt;
      number = part[0] - '0';
    }
  std::erase_if(parts, [](const std::string& part) { return part.size() == 1 && part[0] >= '1' && part[0] <= '5'; });
  const RootsOfName name = roots_of(parts);
  const bool is_of_one = std::all_of(name.roots.begin(), name.roots.end(), [](const Found& root) {
    return root.second == Role::pressure || root.second == Role::port || root.second == Role::valve ||
           root.second == Role::actual || root.second == Role::gauge || root.second == Role::filler;
  });
  const bool is_port = name.has(Role::pressure) || name.has(Role::port);
  return number && name.is_whole && is_of_one && is_port ? number : std::nullopt;
}

std::optional<ColumnWord> column_word(std::string_view text) {
  if (is_formula(text)) return ColumnWord{std::string(text), "", Quantity::other};
  // "Position.Cmd" is no command of a valve: a last part that may belong to anything is judged with what is before it.
  const auto [part, before] = last_of_path(text);
  std::optional<ColumnWord> word = word_of(parts_of(part));
  const Found* root = word ? found_root(word->word) : nullptr;
  if (root && root->second != Role::reference && root->second != Role::command && word->is_sure)
    word = under(std::move(*word), part, before);
  else word = word_of(parts_of(text));
  if (!word) return word;
  const RootsOfName name = roots_of(parts_of(part)), path = roots_of(parts_of(text));
  word->is_actual = path.has(Role::actual);
  word->is_computed = path.has(Role::computed);
  word->is_gauge = word->quantity == Quantity::pressure && name.has(Role::gauge);
  return word;
}

}  // namespace pneuservo
