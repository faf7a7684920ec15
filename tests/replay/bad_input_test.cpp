// SPDX-License-Identifier: Apache-2.0
// Every bad input ends in exit code 2, a message that names the place and the mend, and no output.
#include <gmock/gmock.h>
#include <unistd.h>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing_support::CommandOptions;
using testing_support::CommandResult;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

class BadInput : public testing::Test {
 protected:
  // Replays `recording` with `more` arguments and expects to be refused with `words`.
  void expect_refused(const std::string& recording, const std::vector<std::string>& words,
                      std::vector<std::string> more = {}, const CommandOptions& options = {}) {
    const TemporaryFolder results;
    std::filesystem::permissions(results.path(), std::filesystem::perms(0777));
    std::vector<std::string> arguments = {
        "replay", recording, "--out", results / "estimates.csv", "--figures", results / "figures"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run_condyle(arguments, options);
    EXPECT_EQ(result.exit_code, 2) << result.errors;
    for (const std::string& word : words) EXPECT_THAT(result.errors, HasSubstr(word));
    EXPECT_THAT(result.output, testing::IsEmpty());
    EXPECT_EQ(results.count(), 0) << "output was left";
  }

  std::string csv(const std::string& rows) {
    return folder_.write("bad.csv", "time_s,position_m\n" + rows);
  }
  std::string good() { return csv("0,0.001\n0.02,0.002\n0.04,0.003\n"); }

  TemporaryFolder folder_;
};

TEST_F(BadInput, EmptyFile) {
  expect_refused(folder_.write("bad.csv", ""), {"bad.csv: is empty"});
}
TEST_F(BadInput, HeaderOnly) {
  expect_refused(csv(""), {"bad.csv: has no samples"});
}
TEST_F(BadInput, UnknownColumn) {
  expect_refused(folder_.write("bad.csv", "time_s,position_m,temp\n0,1,2\n"),
                 {"bad.csv:1: column 'temp'", "--ignore-column 'temp'"});
}
TEST_F(BadInput, TextInANumber) {
  expect_refused(csv("0,0.001\n0.02,12a\n"),
                 {"bad.csv:3: column position_m: '12a' is not a number", "decimal point"});
}
TEST_F(BadInput, NaN) {
  expect_refused(csv("0,0.001\nnan,0.002\n"),
                 {"bad.csv:3: column time_s: the value is missing", "--faults event"});
}
TEST_F(BadInput, Infinity) {
  expect_refused(csv("inf,0.001\n"), {"bad.csv:2: column time_s: 'inf' is not a finite number"});
}
TEST_F(BadInput, Overflow) {
  expect_refused(csv("0,1e999\n"), {"bad.csv:2: column position_m: '1e999' is larger than"});
  expect_refused(csv("1e10,1\n"), {"bad.csv:2: column time_s: '1e10' is larger than"});
}
TEST_F(BadInput, TimeRunningBackwards) {
  expect_refused(csv("0,1\n0.02,1\n0.01,1\n"),
                 {"bad.csv:4: time: runs backwards", "--faults event"});
}
TEST_F(BadInput, RowWithMissingColumns) {
  expect_refused(csv("0,1\n0.02\n"),
                 {"bad.csv:3: column position_m: the row has 1 columns, the header names 2"});
  expect_refused(csv("0,1\n,1\n"), {"bad.csv:3: column time_s: the value is missing"});
}
TEST_F(BadInput, Binary) {
  expect_refused(folder_.write("bad.csv", std::string("\x89PNG\r\n\x1a\n\0\0", 10)),
                 {"bad.csv: has an unknown binary format"});
  expect_refused(csv(std::string("0,\0\x01\n", 5)), {"bad.csv: has an unknown binary format"});
  std::string late;  // beyond what recognition looks at
  for (int i = 0; i < 2000; ++i) late += std::to_string(0.01 * i) + ",1\n";
  expect_refused(csv(late + std::string("2000,\x1b[2J\0\n", 12)),
                 {"bad.csv:2002: column position_m: '\\x1b[2J\\x00' is not a number"});
}
TEST_F(BadInput, CommaDecimals) {
  expect_refused(csv("0,0,001\n0,02,0,002\n"),
                 {"bad.csv:1", "commas separate the columns, and decimals too", "decimal points"});
  expect_refused(folder_.write("bad.csv", "time_s;position_m\n0;0,001\n1;0.002\n"),
                 {"bad.csv:2: column position_m: '0,001' is not a number"});
}

TEST_F(BadInput, ALineOfAGigabyteInBoundedMemory) {
  const std::string path = csv("0," + std::string(8192, '1'));
  std::filesystem::resize_file(path,
                               std::uintmax_t{1} << 30);  // the rest is a hole: no disk is used
  expect_refused(path, {"bad.csv:2: the line is longer than 1048576 bytes"});
  const CommandResult result = run_condyle({"replay", path});
  EXPECT_EQ(result.exit_code, 2);
  if (testing_support::command_memory_is_its_own()) {
    EXPECT_LT(result.peak_memory_kB, 64 * 1024);
  }
}

TEST_F(BadInput, ParametersWithAnUnknownKey) {
  expect_refused(
      good(), {"p.toml:1:1: unknown key 'sampletime'", "keys here are sample_time_s"},
      {"--estimator", "published", "--parameters", folder_.write("p.toml", "sampletime = 1\n")});
}
TEST_F(BadInput, NegativeVariance) {
  expect_refused(good(), {"p.toml:2:25: measurement_variance = -1e-08 is out of range", "give "},
                 {"--estimator", "published", "--parameters",
                  folder_.write("p.toml", "[motion]\nmeasurement_variance = [-1e-8]\n")});
}

TEST_F(BadInput, UnreadableFiles) {
  expect_refused(folder_ / "missing.csv", {"missing.csv: cannot be opened: No such file"});
  expect_refused(folder_.path().string(), {": is a directory"});
  expect_refused(good(), {"none.toml: cannot be opened"}, {"--parameters", folder_ / "none.toml"});
  const std::string path = good();
  std::filesystem::permissions(path, std::filesystem::perms(0));
  expect_refused(path, {"bad.csv: cannot be opened: Permission denied"}, {}, {.as_nobody = true});
}

TEST_F(BadInput, UnwritableOutput) {
  const std::string path = good();
  const auto expect = [&](const std::string& out, const CommandOptions& options = {}) {
    const CommandResult result = run_condyle({"replay", path, "--out", out}, options);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, AllOf(HasSubstr(out + ": "), HasSubstr("check the folder")));
  };
  expect(folder_ / "missing/estimates.csv");
  expect("/dev/full");
  const TemporaryFolder closed;
  std::filesystem::permissions(closed.path(), std::filesystem::perms(0555));
  expect(closed / "estimates.csv", {.as_nobody = true});
  EXPECT_EQ(closed.count(), 0);
  // Neither file nor figures where one of them cannot be written.
  const TemporaryFolder results;
  const CommandResult half =
      run_condyle({"replay", path, "--out", "/dev/full", "--figures", results / "a/b"});
  EXPECT_EQ(half.exit_code, 2);
  EXPECT_EQ(results.count(), 0);
  const std::string in_the_way = folder_.write("file", "");
  const CommandResult result = run_condyle({"replay", path, "--figures", in_the_way + "/figures"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("file/figures: cannot be made"));
}

// Gnuplot says nothing where it cannot write, and leaves what fitted.
TEST_F(BadInput, FilesThatMayNotGrow) {
  const TemporaryFolder results;
  const CommandOptions limited{.most_file_bytes = 4096};
  const std::string recording =
      testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");
  const CommandResult rows =
      run_condyle({"replay", recording, "--out", results / "out.csv"}, limited);
  EXPECT_EQ(rows.exit_code, 2);
  EXPECT_THAT(rows.errors, AllOf(HasSubstr("out.csv: cannot be written: File too large"),
                                 HasSubstr("the space on the disk")));
  const CommandResult figures =
      run_condyle({"replay", recording, "--figures", results / "figures"}, limited);
  EXPECT_EQ(figures.exit_code, 2);
  EXPECT_THAT(figures.errors, AllOf(HasSubstr("gnuplot: cannot draw the figures: "),
                                    HasSubstr(" is not complete; free space on the disk")));
  EXPECT_EQ(results.count(), 0);
}

TEST_F(BadInput, StandardOutputThatTakesNothing) {
  const CommandResult full = run_condyle({"replay", good()}, {.output_to = "/dev/full"});
  EXPECT_EQ(full.exit_code, 2);
  EXPECT_THAT(full.errors, HasSubstr("standard output: cannot be written"));
  EXPECT_EQ(run_condyle({"observability"}, {.output_to = "/dev/full"}).exit_code, 2);
  EXPECT_EQ(run_condyle({"replay", "/nowhere"}, {.errors_to = "/dev/full"}).exit_code, 2);
}

// Each element costs the parser many times its bytes.
TEST_F(BadInput, XmlOfMoreElementsThanFitInMemory) {
  std::string xml = "<d>";
  for (int i = 0; i < 6'000'000; ++i) xml += "<a/>";
  expect_refused(folder_.write("bad.xml", xml + "</d>"), {"bad.xml", "too many for the memory"},
                 {"--unit", "mm"});
}

TEST_F(BadInput, OutputOverItsOwnInput) {
  const std::string path = good();
  const std::string before = testing_support::read_file(path);
  const CommandResult result = run_condyle({"replay", path, "--out", path});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("is also an input"));
  EXPECT_EQ(testing_support::read_file(path), before);
}

// All but the figures is kept.
TEST_F(BadInput, FiguresWithoutGnuplot) {
  const std::string out = folder_ / "out.csv";
  const CommandResult result =
      run_condyle({"replay", good(), "--out", out, "--figures", folder_ / "figures"},
                  {.search_path = "/nowhere"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors,
              AllOf(HasSubstr("gnuplot: cannot draw the figures: it is not installed"),
                    HasSubstr("gnuplot-nox")));
  EXPECT_TRUE(std::filesystem::exists(out));
}

TEST_F(BadInput, NoUsableSampleTime) {
  expect_refused(csv("0,1\n0,1\n"), {"no time passes between its samples", "sample_time_s"},
                 {"--estimator", "published"});
  expect_refused(csv("0,1\n100,1\n"), {"median step of 100 s is not a usable sample time"},
                 {"--estimator", "published"});
  expect_refused(csv("0,1\n100,1\n"), {"median step of 100 s is longer than longest_gap_s"});
}

TEST_F(BadInput, CommandLine) {
  for (const std::vector<std::string>& arguments : {std::vector<std::string>{"replay"},
                                                    {"dance"},
                                                    {"replay", good(), "--point", "4"},
                                                    {"replay", good(), "--axis", "w"},
                                                    {"replay", good(), "--speed", "-1"},
                                                    {"replay", good(), "--speed", "nan"},
                                                    {"replay", good(), "--axis", "2"},
                                                    {"observability", "--velocity-m-s", "nan"},
                                                    {"observability", "--mass-kg", "1e-300"},
                                                    {"replay", good(), "--estimator", "best"},
                                                    {"replay", good(), "--faults", "ignore"},
                                                    {"replay", good(), "--nonsense"},
                                                    {"observability", "--mass-kg", "0"}}) {
    const CommandResult result = run_condyle(arguments);
    EXPECT_EQ(result.exit_code, 2) << testing::PrintToString(arguments);
    EXPECT_THAT(result.errors, testing::Not(testing::IsEmpty()));
  }
  expect_refused(good(), {"has one point, not point 2"}, {"--point", "2"});
  expect_refused(good(), {"has one axis"}, {"--axis", "x"});
}

}  // namespace
}  // namespace condyle
