// Files whose names are not in UTF-8.
#include <string>
#include <vector>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "record/foreign/text_encoding.hpp"
#include "record/motion.hpp"

#include <iconv.h>

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

std::string in_encoding(const std::string& encoding, std::string text) {
  const iconv_t converter = iconv_open(encoding.c_str(), "UTF-8");
  REQUIRE(converter != reinterpret_cast<iconv_t>(-1));
  std::string out(4 * text.size() + 8, '\0');
  char *from = text.data(), *to = out.data();
  std::size_t left = text.size(), room = out.size();
  CHECK(iconv(converter, &from, &left, &to, &room) == 0);
  iconv_close(converter);
  out.resize(out.size() - room);
  return out;
}

struct Written {
  const char* encoding;
  const char* names;
  const char* told;
};

}  // namespace

TEST_CASE("names in the encodings of their countries are read as in UTF-8") {
  const std::vector<Written> files{
      {"CP932", "時間 [s],位置 [mm],バルブ指令 [V]", "text in Shift-JIS"},
      {"CP932", "時間[s],シリンダ位置[mm],指令電圧[V]", "text in Shift-JIS"},
      {"EUC-JP", "時間 [s],位置 [mm],バルブ指令 [V]", "text in EUC-JP"},
      {"GB18030", "时间 [s],位置 [mm],阀控制 [V]", "text in GBK"},
      {"GBK", "时间(s),气缸位移(mm),比例阀控制电压(V)", "text in GBK"},
      {"EUC-KR", "시간 [s],위치 [mm],밸브 명령 [V]", "text in EUC-KR"},
      {"CP1251", "Время [s],Положение штока [mm],Клапан [V]", "text in Windows-1251"},
      {"CP1251", "время [s],положение [mm],управление [V]", "text in Windows-1251"},
      {"CP1251", "Время (с),Положение (мм),Клапан (В)", "text in Windows-1251"},
      {"KOI8-R", "Время [s],Положение штока [mm],Клапан [V]", "text in KOI8-R"},
      {"CP1252", "Zeit [s],Kolbenlängslage Weg [mm],Stellgröße [V]", "text in Windows-1252"},
      {"ISO-8859-1", "Temps [s],Déplacement [mm],Commande [V]", "text in Windows-1252"},
      {"CP850", "Zeit [s],Weg [mm],Stellgröße [V]", "text in IBM850"},
      {"CP1250", "Czas [s],Położenie [mm],Zawór [V]", "text in Windows-1250"},
      {"UTF-16LE", "Zeit [s],Weg [mm],Stellgröße [V]", "UTF-16"},
      {"UTF-8", "Zeit [s],Weg [mm],Stellgröße [V]", ""}};
  for (const Written& written : files) {
    CAPTURE(written.encoding, written.names);
    const std::string text = std::string(written.names) + "\n" + rows([](int, double t, double x, double u) {
                               return fmt::format("{:.3f},{:.4f},{:.4f}", t, 1e3 * x, u);
                             });
    const std::string told = check_motion(in_encoding(written.encoding, text));
    CHECK_THAT(told, Contains(written.told));
  }
}

TEST_CASE("Greek names keep their letters though no word of them is known") {
  const TextEncoding greek = encoding_of(in_encoding("CP1253", "Χρόνος (s),Θέση (mm),Βαλβίδα (V)\n"));
  CHECK(greek.name == "Windows-1253");
}

TEST_CASE("a degree sign of Latin-1 is one, and text that is mostly UTF-8 stays so") {
  CHECK(encoding_of("t,x,T [\xb0"
                    "C]\n")
            .iconv == "CP1252");
  CHECK(encoding_of("t,x,dp [\xb5"
                    "bar]\n")
            .iconv == "CP1252");
  CHECK(encoding_of("Größe,Länge,\xe4\n").iconv.empty());
  CHECK(encoding_of("t,x\n").iconv.empty());
  CHECK(encoding_of("Gr\xc3").iconv.empty());  // cut in the middle of a character
}

TEST_CASE("bytes that are no text of any encoding are told, and the numbers are read") {
  const std::string told = check_motion("time,x,valve,\xff\xfe\x80\x81\n" + rows([](int, double t, double x, double u) {
                                          return fmt::format("{:.3f},{:.7f},{:.4f},1", t, x, u);
                                        }));
  CHECK_THAT(told, Contains("that may be in"));
}

TEST_CASE("a character that two parts of a text share is one") {
  TextConverter converter("CP932");
  std::string out;
  const std::string position = in_encoding("CP932", "位置");
  for (const char byte : position) converter.append(std::string_view(&byte, 1), out);
  CHECK(out == "位置");
  CHECK(converter.errors() == 0);
}
