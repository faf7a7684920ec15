// SPDX-License-Identifier: Apache-2.0
// What the command says of itself: the map, help, suggestions, manual pages, completion.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "replay/pointer_session.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;
using testing_support::CommandResult;
using testing_support::run_condyle;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The commands that the map names, "protocol release" among them.
std::vector<std::vector<std::string>> all_commands(const std::vector<std::string>& of = {}) {
  std::vector<std::string> arguments = {"help"};
  arguments.insert(arguments.end(), of.begin(), of.end());
  const std::string help = run_condyle(arguments).output;
  std::vector<std::vector<std::string>> commands;
  if (help.find(" COMMAND") == std::string::npos) return commands;
  for (const std::string& line : lines_of(help)) {
    if (!line.starts_with("  ") || line[2] == ' ' || line[2] == '-') continue;
    std::vector<std::string> command = of;
    command.push_back(line.substr(2, line.find(' ', 2) - 2));
    if (command.back() == "condyle") continue;  // an example
    commands.push_back(command);
    for (auto& part : all_commands(command)) commands.push_back(part);
  }
  return commands;
}

// The lines below "Examples:".
std::vector<std::string> examples_of(const std::vector<std::string>& command) {
  std::vector<std::string> arguments = {"help"}, examples;
  arguments.insert(arguments.end(), command.begin(), command.end());
  const std::string help = run_condyle(arguments).output;
  const std::size_t begin = help.find("\nExamples:\n");
  if (begin == std::string::npos) return examples;
  for (const std::string& line : lines_of(help.substr(begin))) {
    if (line.starts_with("  condyle ")) examples.push_back(line.substr(2));
  }
  return examples;
}

TEST(Help, AloneShowsTheMap) {
  const CommandResult alone = run_condyle({});
  EXPECT_EQ(alone.exit_code, 0);
  EXPECT_THAT(alone.output, StartsWith("Usage: condyle COMMAND"));
  for (const char* heading :
       {"\nAnalyse recordings:\n", "\nSimulate:\n", "\nMeasure with a device:\n"})
    EXPECT_THAT(alone.output, HasSubstr(heading));
  for (const char* argument : {"help", "--help", "-h"}) {
    EXPECT_EQ(run_condyle({argument}).output, alone.output);
  }
  EXPECT_EQ(run_condyle({"-v"}).output, run_condyle({"--version"}).output);
  EXPECT_THAT(run_condyle({"-v"}).output, StartsWith("condyle "));
}

// What was left out of a build is named as left out.
TEST(Help, KnowsTheCommandsThatABuildMayLack) {
  for (const char* command : {"report", "live"}) {
    const CommandResult alone = run_condyle({command});
    EXPECT_EQ(alone.exit_code, 2);
    EXPECT_THAT(alone.errors, Not(HasSubstr("is not a command")));
    if (testing_support::condyle_has(command)) continue;
    EXPECT_THAT(alone.errors, HasSubstr("was built without its pages for browsers"));
    EXPECT_EQ(run_condyle({"help", command}).errors, alone.errors);
  }
}

TEST(Help, OfEachCommandFitsATerminal) {
  const auto commands = all_commands();
  EXPECT_GE(commands.size(), 20U);
  for (std::vector<std::string> command : commands) {
    std::vector<std::string> by_help = {"help"};
    by_help.insert(by_help.end(), command.begin(), command.end());
    const CommandResult help = run_condyle(by_help);
    command.push_back("--help");
    EXPECT_EQ(run_condyle(command).output, help.output);
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.output, StartsWith("Usage: condyle " + command[0]));
    EXPECT_THAT(help.output, Not(HasSubstr("FLOAT")));
    for (const std::string& line : lines_of(help.output)) {
      // The line of an example is there to be copied.
      if (!line.starts_with("  condyle ")) {
        EXPECT_LE(line.size(), 100U) << line;
      }
    }
  }
  for (const std::vector<std::string>& command : commands) {
    if (command.size() == 1) {
      EXPECT_GE(examples_of(command).size(), 2U) << command[0];
    }
  }
}

TEST(Help, NamesWhatItDoesNotKnowAndTheNearest) {
  const struct {
    std::vector<std::string> arguments;
    const char* unknown;
    const char* nearest;
  } cases[] = {
      {{"replya", "x.csv"}, "'replya' is not a command", "did you mean replay?"},
      {{"--verison"}, "no option '--verison'", "did you mean --version?"},
      {{"protocol", "realease", "x.csv"},
       "'realease' is not a command of condyle protocol",
       "did you mean release?"},
      {{"help", "recrod"}, "'recrod' is not a command", "did you mean record?"},
      {{"replay", "x.csv", "--figure", "f"}, "no option '--figure'", "did you mean --figures?"},
      {{"replay", "x.csv", "--output=f"}, "no option '--output'", "did you mean --out?"},
      {{"replay", "--otu", "f"}, "no option '--otu'", "did you mean --out?"},
  };
  for (const auto& wrong : cases) {
    const CommandResult result = run_condyle(wrong.arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.output, IsEmpty());
    EXPECT_THAT(result.errors, AllOf(HasSubstr(wrong.unknown), HasSubstr(wrong.nearest)));
  }
  const CommandResult file = run_condyle({"x.csv"});
  EXPECT_EQ(file.exit_code, 2);
  EXPECT_THAT(file.errors, AllOf(HasSubstr("'x.csv' is not a command"), Not(HasSubstr("mean"))));
  // What it does not know stays on its line.
  EXPECT_THAT(run_condyle({"a\nmass 0.2 kg"}).errors, Not(HasSubstr("\nmass")));
  EXPECT_THAT(run_condyle({"replay", "--a\nmass"}).errors, Not(HasSubstr("\nmass")));
}

TEST(Help, SaysWhatAnOptionTakes) {
  const struct {
    std::vector<std::string> arguments;
    const char* errors;
  } cases[] = {
      {{"replay", "x.csv", "--lag", "99"}, "--lag: must be a whole number from 0 to 16, not '99'"},
      {{"replay", "x.csv", "--lag", "2.5"}, "--lag: must be a whole number from 0 to 16"},
      {{"replay", "x.csv", "--axis", "w"}, "--axis: must be one of x, y, z, not 'w'"},
      {{"replay", "x.csv", "--speed", "fast"}, "--speed: 'fast' is not a number from 0 to 1000000"},
      {{"analyse", "x.csv", "--reference-s", "a", "b"}, "--reference-s: takes numbers, not 'a,b'"},
      {{"simulate", "x.toml", "--out", "x.csv", "--seed", "-1"},
       "--seed: must be a whole number of 0 or more, not '-1'"},
      {{"evaluate", "x.toml", "--seed", "-1"}, "--seed: must be a whole number of 0 or more"},
      {{"replay", "x.csv", "y.csv"}, "condyle replay: one argument too many: y.csv"},
  };
  for (const auto& wrong : cases) {
    const CommandResult result = run_condyle(wrong.arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, HasSubstr(wrong.errors));
  }
}

// Each example of a command that needs no device, on the files that it names.
TEST(Help, ItsExamplesRun) {
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path home = folder.path();
  const auto scenario = [](const char* name) {
    return testing_support::source_path(std::string("/host_sim/scenarios/") + name);
  };
  const auto copy = [&](const char* name, const char* duration, const char* to) {
    std::string text = text_of(scenario(name));
    const std::size_t at = text.find("duration_s");
    text.replace(at, text.find('\n', at) - at, duration);
    std::ofstream(home / to) << text;
  };
  copy("chewing.toml", "duration_s = 12", "chewing.toml");
  copy("point_mass.toml", "duration_s = 12", "point_mass.toml");
  copy("point_mass.toml", "duration_s = 220", "long.toml");
  const auto make = [&](const std::string& toml, const std::string& out) {
    ASSERT_EQ(run_condyle({"simulate", toml, "--out", home / out}).exit_code, 0);
  };
  make(home / "point_mass.toml", "jaw.csv");
  make(scenario("passive_release.toml"), "release.csv");
  make(home / "long.toml", "chewing.csv");
  make(scenario("passive_release.toml"), "first.csv");
  std::string loaded = text_of(scenario("passive_release.toml"));
  const std::size_t mass = loaded.find("mass_kg");
  loaded.replace(mass, loaded.find('\n', mass) - mass, "mass_kg = 0.45");
  std::ofstream(home / "loaded.toml") << loaded;
  make(home / "loaded.toml", "second.csv");
  make(scenario("nodding_head.toml"), "nods.csv");
  make(scenario("clinical_session.toml"), "session.csv");  // with its landmarks and tasks
  make(scenario("chewing_with_emg.toml"), "food.csv");
  std::ofstream(home / "pointer.csv") << testing_support::pointer_session();
  std::ofstream(home / "touched.csv") << testing_support::pointer_session(true);
  std::filesystem::copy(testing_support::source_path("/host_sim/muscles/artisynth.toml"), home);
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    ASSERT_EQ(run_condyle({"simulate", home / "point_mass.toml", "--seed", std::to_string(name[0]),
                           "--out", home / (std::string(name) + ".csv")})
                  .exit_code,
              0);
  }
  std::filesystem::create_directory(home / "dataset");
  std::filesystem::copy(home / "session.csv", home / "dataset");
  std::ofstream(home / "dataset/recordings.csv")
      << "recording,subject,session,task\nsession.csv,01,1,clinical\n";
  for (const std::string number : {"1", "2"}) {
    ASSERT_EQ(run_condyle({"evaluate", home / "point_mass.toml", "--runs", "2", "--shard",
                           number + "/2", "--out", home / ("shard" + number + ".txt")})
                  .exit_code,
              0);
  }
  for (const auto& command : all_commands()) {
    const bool needs_device = command[0] == "inspect" || command[0] == "doctor" ||
                              command[0] == "record" || command[0] == "session" ||
                              command[0] == "live" || command[0] == "bridge" ||
                              command[0] == "fake";
    if (needs_device) continue;
    for (const std::string& example : examples_of(command)) {
      const std::string program = testing_support::program_path("condyle");
      const std::string line = "cd '" + home.string() + "' && HOME=. " + program +
                               example.substr(std::string("condyle").size()) +
                               " >out.txt 2>errors.txt";
      EXPECT_EQ(std::system(line.c_str()), 0) << example << "\n" << text_of(home / "errors.txt");
    }
  }
}

TEST(Help, WritesManualPagesAndCompletion) {
  const testing_support::TemporaryFolder folder;
  const std::filesystem::path manual = std::filesystem::path(folder.path()) / "manual";
  ASSERT_EQ(run_condyle({"help", "--manual", manual}).exit_code, 0);
  for (const auto& command : all_commands()) {
    std::string name = "condyle";
    for (const std::string& word : command) name += "-" + word;
    const std::string page = text_of(manual / (name + ".1"));
    EXPECT_THAT(page, AllOf(StartsWith(".TH "), HasSubstr(".SH NAME"), HasSubstr(".SH SYNOPSIS")));
    for (const std::string& line : lines_of(page)) {
      if (line.starts_with('.')) {
        EXPECT_THAT(line, testing::MatchesRegex("\\.(TH|SH|TP|B).*")) << name;
      }
    }
  }
  const auto complete = [&](const std::string& words) {
    const std::string script = "source '" + (manual / "condyle.bash").string() + "'; COMP_WORDS=(" +
                               words + "); COMP_CWORD=$((${#COMP_WORDS[@]}-1)); _condyle; " +
                               "printf '%s ' \"${COMPREPLY[@]}\"";
    const std::string line = "bash -c \"" + [&] {
      std::string escaped;
      for (const char c : script) {
        if (c == '"' || c == '$' || c == '\\') escaped += '\\';
        escaped += c;
      }
      return escaped;
    }() + "\"";
    std::string output;
    std::FILE* const pipe = popen(line.c_str(), "r");
    std::array<char, 4096> buffer;
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe)) {
      output.append(buffer.data(), n);
    }
    pclose(pipe);
    return output;
  };
  EXPECT_EQ(complete("condyle repl"), "replay ");
  EXPECT_EQ(complete("condyle protocol rel"), "release ");
  EXPECT_EQ(complete("condyle replay --fig"), "--figures ");
  EXPECT_EQ(complete("condyle replay --axis ''"), "x y z ");
}

TEST(StandardOutput, TakesTheEstimatesAndLeavesTheSummaryToTheOther) {
  const std::string recording =
      testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");
  const testing_support::TemporaryFolder folder;
  const std::string file = std::filesystem::path(folder.path()) / "estimates.csv";
  ASSERT_EQ(run_condyle({"replay", recording, "-o", file}).exit_code, 0);
  const CommandResult result = run_condyle({"replay", recording, "--out", "-"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, text_of(file));
  EXPECT_THAT(result.errors, HasSubstr("last values"));
  const CommandResult drive = run_condyle(
      {"simulate", testing_support::source_path("/host_sim/scenarios/point_mass.toml"), "-o", "-"});
  EXPECT_EQ(drive.exit_code, 2);
  EXPECT_THAT(drive.errors, HasSubstr("name a file"));
}

TEST(Summary, IsDataOnRequest) {
  const std::string recording =
      testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");
  for (const char* estimator : {"recommended", "published"}) {
    const CommandResult result =
        run_condyle({"replay", recording, "--json", "--estimator", estimator});
    ASSERT_EQ(result.exit_code, 0);
    const auto json = nlohmann::json::parse(result.output);
    EXPECT_EQ(json["format"], "condyle-replay-1");
    EXPECT_EQ(json["samples"], 1800);
    EXPECT_NEAR(json["rate_Hz"], 60, 0.1);
    EXPECT_EQ(json["estimator"], estimator);
    EXPECT_EQ(json["last"]["velocity_m_s"]["provenance"], "measured");
    EXPECT_TRUE(json["warnings"].is_array());
  }
}

}  // namespace
}  // namespace condyle
