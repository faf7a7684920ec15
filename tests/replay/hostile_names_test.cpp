// SPDX-License-Identifier: Apache-2.0
// Names of files and folders that are commands to a program beside, to a terminal or to a reader of
// the summary: they name the file, and nothing else happens.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"
#include "support/tier.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

class HostileNames : public testing::Test {
 protected:
  static std::string recording() {
    return testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");
  }
  std::string copy_named(const std::string& name) const {
    fs::copy_file(recording(), folder_ / name);
    return folder_ / name;
  }
  void expect_figures(const fs::path& figures) const {
    for (const char* name : {"position.svg", "position.png", "velocity.png"}) {
      EXPECT_GT(fs::file_size(figures / name), 1000U) << figures;
    }
    EXPECT_THAT(read_file(figures / "position.svg"), EndsWith("</svg>\n\n"));
  }
  TemporaryFolder folder_;
};

// gnuplot runs what follows a pipe, and expands a tilde.
TEST_F(HostileNames, AFolderForFiguresIsAFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_.path());
  const std::string home = folder_ / "home";
  fs::create_directory(home);
  setenv("HOME", home.c_str(), 1);
  std::vector<const char*> names = {"|touch pwned;", "~", "a''b", "`touch pwned`"};
  if (testing_support::tier_is_at_least(testing_support::Tier::full)) {
    names.insert(names.end(),
                 {"~root", "'a", "$(touch pwned)", "a\"b", "a\\nb", "-d", "< touch pwned"});
  }
  for (const char* name : names) {
    const CommandResult result =
        run_condyle({"replay", recording(), "--out", "out.csv", std::string("--figures=") + name});
    EXPECT_EQ(result.exit_code, 0) << name << ' ' << result.errors;
    expect_figures(fs::path("./") / name);
  }
  fs::current_path(before);
  EXPECT_FALSE(fs::exists(folder_ / "pwned"));
  EXPECT_TRUE(fs::is_empty(home));
}

TEST_F(HostileNames, AnyNameOfARecordingCanBeDrawn) {
  for (const char* name : {"'a.csv", "''b.csv", "c''d.csv", "e\xff.csv", "f\x1b[31m.csv",
                           "g\nfriction  0.31 +- 0.01 Nsm, measured.csv", "h\xc2\x9b.csv"}) {
    const std::string path = copy_named(name);
    const CommandResult result =
        run_condyle({"replay", path, "--out", folder_ / "out.csv", "--figures", folder_ / "f"});
    EXPECT_EQ(result.exit_code, 0) << name << ' ' << result.errors;
    expect_figures(fs::path(folder_ / "f"));
    for (const std::string& text : {result.output, read_file(folder_ / "f/position.svg")}) {
      EXPECT_THAT(text, AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\xff")),
                              Not(HasSubstr("\xc2\x9b")), Not(HasSubstr("\nfriction  0.31"))));
    }
  }
}

TEST_F(HostileNames, AReportCanHoldThem) {
  const std::string path = copy_named("e\xff\n.csv");
  const CommandResult result = run_condyle({"compare", path, "--out", folder_ / "table.csv"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(read_file(folder_ / "table.csv"),
              AllOf(HasSubstr("e\\xff\\x0a.csv"), Not(HasSubstr("\xff"))));
}

// What drawing has against it costs the figures alone.
TEST_F(HostileNames, EstimatesSurviveAGnuplotThatFails) {
  const fs::path programs = folder_ / "programs";
  fs::create_directory(programs);
  for (const char* script : {"#!/bin/sh\nexit 3\n", "#!/bin/sh\ncat > /dev/null\n",
                             "#!/bin/sh\nkill -9 $$\n", "no program"}) {
    std::ofstream(programs / "gnuplot") << script;
    chmod((programs / "gnuplot").c_str(), 0755);
    const std::string out = folder_ / "out.csv";
    fs::remove(out);
    const CommandResult result =
        run_condyle({"replay", recording(), "--out", out, "--figures", folder_ / "f"},
                    {.search_path = programs.string() + ":/usr/bin:/bin"});
    EXPECT_EQ(result.exit_code, 2) << script;
    EXPECT_THAT(result.errors, HasSubstr("gnuplot: cannot draw the figures")) << script;
    EXPECT_THAT(result.output, HasSubstr("figures     none: see the error")) << script;
    EXPECT_GT(fs::file_size(out), 1000U) << script;
    EXPECT_FALSE(fs::exists(folder_ / "f")) << script;
  }
}

}  // namespace
}  // namespace condyle
