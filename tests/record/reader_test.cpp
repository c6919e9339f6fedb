// The reader: every kind of problem with its line, damaged files, and errors that name what was expected.
#include <catch2/catch.hpp>

#include <cmath>
#include <random>

#include "config/input_error.hpp"
#include "core/test_seed.hpp"
#include "record/files.hpp"

using namespace pneuservo;
using Catch::Matchers::Contains;

namespace {

const std::string head = "# format: pneuservo-recording/1\n# rig: r\n# period_s: 0.001\n";  // lines 1 to 3

/// Reads head + text (line 4 on) as gzip and checks that it reads the same as plain CSV.
Recording read_text(const std::string& text) {
  const TemporaryFolder folder;
  const Recording plain = read_recording(put_plain(folder.file("r.csv"), head + text));
  Recording packed = read_recording(put_gzip(folder.file("r.csv.gz"), head + text));
  REQUIRE(problems_of(plain) == problems_of(packed));
  REQUIRE(plain.line_numbers == packed.line_numbers);
  return packed;
}

}  // namespace

TEST_CASE("columns by name, unknown ones kept, empty fields are no value") {
  const Recording r = read_text("t_s,x_m,own_column,u_V\n0,1.5,7,\n0.001, +2 ,8,-0.25\r\n");
  REQUIRE(problems_of(r).empty());
  REQUIRE(r.rows() == 2);
  REQUIRE(r.rig == "r");
  REQUIRE(r.period_s == 0.001);
  REQUIRE(r.column("x_m") == std::vector<double>{1.5, 2.0});
  REQUIRE(r.column("own_column") == std::vector<double>{7, 8});
  REQUIRE(std::isnan(r.column("u_V")[0]));
  REQUIRE(r.column("u_V")[1] == -0.25);
  REQUIRE(r.has("x_m"));
  REQUIRE_FALSE(r.has("v_mps"));
  REQUIRE_NOTHROW(r.require({"t_s", "u_V"}));
  REQUIRE_THROWS_WITH(r.require({"t_s", "v_mps", "F_N"}),
                      Contains("columns v_mps, F_N are missing; found t_s, x_m, own_column, u_V"));
  REQUIRE_THROWS_WITH(r.column("v_mps"), Contains("column v_mps is missing"));
  REQUIRE_THROWS_AS(r.column("v_mps"), InputError);
}

TEST_CASE("each problem is reported with its line") {
  const Recording r = read_text("t_s,x_m\n"          // 4
                                "0,0\n"              // 5
                                "0.001,nan\n"        // 6 not a number
                                "0.002,-inf\n"       // 7 not a number
                                "0.003,1e\n"         // 8 unreadable
                                "0.004\n"            // 9 field count
                                "0.004,1,2\n"        // 10 field count
                                "\n"                 // 11 field count
                                "# note\n"           // 12 field count
                                "0.005,5\n"          // 13 gap: 0.004 is missing
                                "0.005,6\n"          // 14 repeated
                                "0.0045,7\n"         // 15 decreasing
                                ",8\n"               // 16 no time
                                "0.006,1e400\n"      // 17 unreadable: beyond the range
                                "0.007,0.5 V\n");    // 18 unreadable
  REQUIRE(problems_of(r) ==
          "not_a_number@6 not_a_number@7 unreadable_field@8 field_count@9 field_count@10 field_count@11 "
          "field_count@12 gap@13 repeated_time@14 decreasing_time@15 no_time@16 unreadable_field@17 "
          "unreadable_field@18");
  REQUIRE(r.t_s() == std::vector<double>{0, 0.001, 0.002, 0.003, 0.005, 0.006, 0.007});
  REQUIRE(r.line_numbers == std::vector<std::size_t>{5, 6, 7, 8, 13, 17, 18});
  REQUIRE(std::isnan(r.column("x_m")[3]));
  REQUIRE(r.column("x_m")[4] == 5);
  REQUIRE(r.missing_rows == 1);
  REQUIRE(r.dropped_rows == 0);
  REQUIRE_THAT(r.problems[7].sentence,
               Contains("r.csv.gz, line 13: ") && Contains("from 0.003 to 0.005") && Contains("1 row is missing"));
  REQUIRE_THAT(r.problems[3].sentence, Contains("1 fields where 2 are expected"));
  const auto lines = problem_lines(r, 2);
  REQUIRE_THAT(lines.back(), Contains("1 more of the kind unreadable_field"));
}

TEST_CASE("a gap that the recorder made says so and counts its rows") {
  const Recording r = read_text("t_s,flags\n0,0\n0.001,1\n0.011,6\n0.012,0\n0.02,1\n");
  REQUIRE(problems_of(r) == "gap@7 gap@9");
  REQUIRE(r.missing_rows == 9 + 7);
  REQUIRE(r.dropped_rows == 9);
  REQUIRE_THAT(r.problems[0].sentence, Contains("9 rows are missing, which the recorder dropped"));
  REQUIRE_THAT(r.problems[1].sentence, !Contains("dropped"));
}

TEST_CASE("one time that jumps ahead costs its own row alone") {
  const Recording r = read_text("t_s,x_m\n0,0\n0.001,1\n99,2\n0.003,3\n0.004,4\n");
  REQUIRE(problems_of(r) == "decreasing_time@7");
  REQUIRE(r.column("x_m") == std::vector<double>{0, 1, 3, 4});
}

TEST_CASE("jitter below half a period is no gap") {
  REQUIRE(problems_of(read_text("t_s\n0\n0.00145\n0.0018\n0.0032\n")).empty());
}

TEST_CASE("missing and impossible header keys are reported, free text among them does no harm") {
  const TemporaryFolder folder;
  const Recording bare = read_recording(put_plain(folder.file("a.csv"), "t_s\n0\n5\n"));
  REQUIRE(problems_of(bare) == "header@0 header@0 header@0");
  REQUIRE(std::isnan(bare.period_s));
  const Recording odd = read_recording(
      put_plain(folder.file("b.csv"), "\xef\xbb\xbf# Strokes: a, b: c\n# free text: {\n#format: other/1\n# period_s: "
                                      "-1\n# rig: q\n# reference:\n#   kind: steps\nt_s\n0\n"));
  REQUIRE(problems_of(odd) == "header@0 header@0");
  REQUIRE_THAT(odd.problems[0].sentence, Contains("\"other/1\"; expected pneuservo-recording/1"));
  REQUIRE_THAT(odd.problems[1].sentence, Contains("\"-1\"; expected a number above 0"));
  REQUIRE(odd.rig == "q");
  REQUIRE(odd.header["reference"]["kind"].as<std::string>() == "steps");
}

TEST_CASE("unusable files are one clear sentence with file and line") {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& name, const std::string& bytes, const std::string& what) {
    const std::string path = put_plain(folder.file(name), bytes);
    REQUIRE_THROWS_AS(read_recording(path), InputError);
    REQUIRE_THROWS_WITH(read_recording(path), Contains(name) && Contains(what));
  };
  REQUIRE_THROWS_WITH(read_recording(folder.file("none.csv.gz")), Contains("none.csv.gz") && Contains("No such file"));
  REQUIRE_THROWS_AS(read_recording(folder.file("none.csv.gz")), InputError);
  REQUIRE_THROWS_AS(read_recording(folder.file(".")), InputError);
  refused("plain.csv.gz", head + "t_s\n0\n", "is not gzip");
  refused("empty.csv", "", "is empty");
  refused("empty.csv.gz", "", "is empty");
  refused("comments.csv", head, "line 4: the file ends before the line of column names");
  refused("numbers.csv", head + "0,1.5\n0.001,2\n", "line 4: found \"0\" where a column name is expected");
  refused("twice.csv", head + "t_s,x_m,x_m\n0,1,2\n", "line 4: column x_m is there twice");
  refused("no_time.csv", head + "time,x_m\n0,1\n", "column t_s is missing; found time, x_m");
  refused("no_rows.csv", head + "t_s,x_m\n", "line 5: there is no row");
  refused("no_whole_row.csv", head + "t_s,x_m\n0\n", "there is no row");
  refused("no_times.csv", head + "t_s,x_m\n,1\n", "no row has a time");
}

TEST_CASE("a file cut anywhere gives its whole rows and says where it ends, or is refused") {
  const unsigned seed = test::new_seed();
  INFO("seed " << seed << " (PNEUSERVO_TEST_SEED)");
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  const TemporaryFolder folder;
  const std::string whole = folder.file("whole.csv.gz");
  {
    GzipFile file(whole);
    file.write(head + "t_s,x_m\n");
    for (int i = 0; i < 2000; ++i) {
      file.write(std::to_string(i * 0.001) + "," + std::to_string(value(generator)) + "\n");
      if (i % 300 == 0) file.flush(false);
    }
    file.close();
  }
  const Recording all = read_recording(whole);
  REQUIRE(all.problems.empty());
  const std::string bytes = bytes_of(whole);
  std::size_t most = 0;
  for (std::size_t size = 1; size < bytes.size(); size += size < 300 || size + 120 > bytes.size() ? 1 : 97) {
    CAPTURE(size);
    put_plain(folder.file("cut.csv.gz"), bytes.substr(0, size));
    try {
      const Recording cut = read_recording(folder.file("cut.csv.gz"));
      REQUIRE(cut.problems.size() == 1);
      REQUIRE(cut.problems[0].kind == ProblemKind::truncated);
      REQUIRE(cut.problems[0].line == cut.line_numbers.back() + 1);
      REQUIRE(cut.rows() >= most);
      REQUIRE(std::equal(cut.t_s().begin(), cut.t_s().end(), all.t_s().begin()));
      REQUIRE(std::equal(cut.column("x_m").begin(), cut.column("x_m").end(), all.column("x_m").begin()));
      most = cut.rows();
    } catch (const InputError&) {
      REQUIRE(most == 0);  // nothing usable, before the first whole row
    }
  }
  REQUIRE(most >= 1999);

  // Wrong bytes: never a crash, and never silent. The bits that fill the last byte before a flush carry nothing: one of
  // 10 000 changes hits no other, and the file reads as before.
  for (int i = 0; i < 200; ++i) {
    std::string wrong = bytes;
    const std::size_t at = 20 + generator() % (wrong.size() - 20);
    wrong[at] = static_cast<char>(wrong[at] ^ (1 + generator() % 255));
    CAPTURE(at);
    try {
      const Recording read = read_recording(put_plain(folder.file("wrong.csv.gz"), wrong));
      if (read.problems.empty()) REQUIRE((read.t_s() == all.t_s() && read.column("x_m") == all.column("x_m")));
    } catch (const InputError&) { continue; }
  }
}

TEST_CASE("gzip files joined end to end read as one, a plain file without its last LF is cut off") {
  const TemporaryFolder folder;
  const std::string one = bytes_of(put_gzip(folder.file("1.csv.gz"), head + "t_s\n0\n"));
  const std::string two = bytes_of(put_gzip(folder.file("2.csv.gz"), "0.001\n0.002"));
  const Recording joined = read_recording(put_plain(folder.file("12.csv.gz"), one + two));
  REQUIRE(problems_of(joined).empty());
  REQUIRE(joined.rows() == 3);
  const Recording plain = read_recording(put_plain(folder.file("p.csv"), head + "t_s,x_m\n0,0.25\n0.001,0.2"));
  REQUIRE(problems_of(plain) == "truncated@6");
  REQUIRE(plain.rows() == 1);
  REQUIRE(problems_of(read_recording(put_plain(folder.file("tail.csv.gz"), one + "tail"))) == "damaged@6");
}

TEST_CASE("a table of foreign columns needs no times") {
  const TemporaryFolder folder;
  const CsvTable table =
      read_table(put_plain(folder.file("f.csv"), "# Flow of a valve\nduty,q_m3_s\n0.1,1e-3\n0.1,2e-3\n"));
  REQUIRE(table.rows() == 2);
  REQUIRE(table.comments == "Flow of a valve\n");
  REQUIRE(table.problems.empty());
}

TEST_CASE("of our own format wanted columns alone are kept, with the same values, of foreign tables all") {
  const TemporaryFolder folder;
  const std::string text = "t_s,x_m,note,u_V,flags\n0,1.5,x,-0.5,0\n0.001,2,y,0.5,0\n";
  const CsvTable table = read_table(put_plain(folder.file("w.csv"), head + text), {"t_s", "u_V", "p1_port_Pa"});
  REQUIRE(table.names == std::vector<std::string>{"t_s", "u_V"});
  REQUIRE(table.values == std::vector<std::vector<double>>{{0, 0.001}, {-0.5, 0.5}});
  REQUIRE(table.problems.empty());  // of a column that is not kept nothing is read
  REQUIRE_THROWS_WITH(table.require({"p1_port_Pa"}), Contains("p1_port_Pa is missing") && Contains("x_m"));
  const CsvTable foreign = read_table(put_plain(folder.file("f.csv"), "a,b\n1,2\n"), {"a"});
  REQUIRE(foreign.names == std::vector<std::string>{"a", "b"});
}
