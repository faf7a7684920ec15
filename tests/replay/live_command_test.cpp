// SPDX-License-Identifier: Apache-2.0
// condyle live, without a browser.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

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
