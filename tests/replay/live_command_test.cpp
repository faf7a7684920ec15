// SPDX-License-Identifier: Apache-2.0
// condyle live, without a browser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "recordings/played_recording.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing_support::CommandResult;
using testing_support::run_condyle;

const std::string kSource =
    "synth:" + testing_support::source_path("/hal/profiles/condyle_facebow.toml");

TEST(Live, NamesItsAddressAndLeavesNoEmptyFolder) {
  const testing_support::TemporaryFolder folder;
  const CommandResult result =
      run_condyle({"live", kSource, "--sessions", folder / "sessions", "--duration-s", "0.3"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, IsEmpty());
  EXPECT_THAT(result.output,
              AllOf(MatchesRegex("http://127\\.0\\.0\\.1:[1-9][0-9]*/ shows (.|\n)*"),
                    HasSubstr("research use only; not a diagnosis")));
  EXPECT_EQ(folder.count(), 0);
}

TEST(Live, KeepsAFolderThatWasThere) {
  const testing_support::TemporaryFolder folder;
  EXPECT_EQ(
      run_condyle({"live", kSource, "--sessions", folder.path(), "--duration-s", "0.1"}).exit_code,
      0);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path()));
}

TEST(Live, PlaysARecordingThatIsNoLog) {
  const testing_support::TemporaryFolder folder;
  const std::string recording =
      testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");
  const CommandResult result = run_condyle(
      {"live", "file:" + recording, "--sessions", folder / "sessions", "--duration-s", "0.3"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, IsEmpty());
  EXPECT_THAT(result.output, HasSubstr("chewing_60hz.csv"));
  EXPECT_EQ(folder.count(), 0);
}

// Times and coordinates are those of the recording, to the last digit of its estimates.
TEST(Live, PlaysTheSameSamples) {
  const testing_support::TemporaryFolder folder;
  const auto scenario = testing_support::source_path("/host_sim/scenarios/clinical_session.toml");
  const std::string session = folder / "session.csv", log = folder / "played.mcap";
  ASSERT_EQ(run_condyle({"simulate", scenario, "--out", session}).exit_code, 0);
  host::write_as_session_log(session, log, [] { return false; });
  EXPECT_TRUE(host::is_session_log(log));
  EXPECT_FALSE(host::is_session_log(session));
  for (const std::string& source : {session, log}) {
    const CommandResult result =
        run_condyle({"replay", source, "--faults", "event", "--out", source + ".out"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  const auto estimates = testing_support::read_file(session + ".out");
  EXPECT_GT(estimates.size(), 100'000U);
  EXPECT_EQ(testing_support::read_file(log + ".out"), estimates);
}

TEST(Live, SaysWhatIsWrong) {
  const testing_support::TemporaryFolder folder;
  const std::string file = folder.write("file", "text");
  const std::string sessions = folder / "sessions";
  const struct {
    std::vector<std::string> arguments;
    const char* errors;
  } cases[] = {
      {{"sim:x.toml"}, "a simulated subject does not send reports"},
      {{"synth:"}, "does not name a file"},
      {{"hid:missing.toml"}, "missing.toml"},
      {{"file:" + file}, "file"},
      {{file}, "file"},
      {{kSource, "--port", "65536"}, "--port: must be a whole number from 0 to 65535"},
      {{kSource, "--sessions", file}, "--sessions"},
      {{kSource, "--point", "4"}, "--point"},
      {{kSource, "--pose-point", "a", "1", "2", "x"}, "--pose-point"},
      {{kSource, "--pose-point", "twist", "1", "2", "3"}, "twist is already the name of a value"},
      {{kSource, "--landmarks", "missing.toml"}, "missing.toml"},
      {{kSource, "--parameters", "missing.toml"}, "missing.toml"},
      {{}, "SOURCE"},
  };
  for (const auto& wrong : cases) {
    std::vector<std::string> arguments = {"live"};
    arguments.insert(arguments.end(), wrong.arguments.begin(), wrong.arguments.end());
    if (wrong.arguments.size() < 3) {
      arguments.insert(arguments.end(), {"--sessions", sessions, "--duration-s", "0.1"});
    }
    const CommandResult result = run_condyle(arguments);
    EXPECT_EQ(result.exit_code, 2) << wrong.errors;
    EXPECT_THAT(result.errors, HasSubstr(wrong.errors));
    EXPECT_FALSE(std::filesystem::exists(sessions)) << wrong.errors;
  }
}

}  // namespace
}  // namespace condyle
