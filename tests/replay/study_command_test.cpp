// SPDX-License-Identifier: Apache-2.0
// `condyle study`: the same bytes whatever the number of processes, the shards, or the kills; one
// bad recording is a row.
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/paths.h"
#include "support/random.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::Random;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

// Every file below `folder` with its bytes.
std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    files[name] = entry.is_regular_file() ? read_file(entry.path().string()) : "folder";
  }
  return files;
}

class Study : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    fs::create_directories(folder_->path() / "data");
    const std::string scenario =
        testing_support::source_path("/host_sim/scenarios/clinical_session.toml");
    std::string table = "recording,subject,session,task\n";
    for (int subject = 1; subject <= 2; ++subject) {
      for (int session = 1; session <= 2; ++session) {
        for (int repeat = 1; repeat <= 2; ++repeat) {
          const int seed = 8 * subject + 4 * session + repeat;
          const std::string name = "s" + std::to_string(subject) + "_" + std::to_string(session) +
                                   "_" + std::to_string(repeat) + ".csv";
          const CommandResult made =
              run_condyle({"simulate", scenario, "--seed", std::to_string(seed), "--out",
                           *folder_ / ("data/" + name)});
          ASSERT_EQ(made.exit_code, 0) << made.errors;
          table +=
              name + ",0" + std::to_string(subject) + "," + std::to_string(session) + ",clinical\n";
        }
      }
    }
    folder_->write("data/broken.csv", "time_s,a_x_mm,a_y_mm,a_z_mm\n0,1,2,three\n");
    table += "broken.csv,02,2,clinical\nmissing.csv,02,2,clinical\n";
    folder_->write("data/recordings.csv", table);
    const CommandResult whole = run("whole", {"--jobs", "2"});
    ASSERT_EQ(whole.exit_code, 0) << whole.errors;
    whole_ = files_in(folder_->path() / "whole");
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::vector<std::string> words(const std::string& out, const std::string& level,
                                        const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"study", *folder_ / "data", *folder_ / out, level};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  static CommandResult run(const std::string& out, const std::vector<std::string>& more) {
    return run_condyle(words(out, "participant", more));
  }
  // Makes this process the command.
  [[noreturn]] static void become(const std::string& out) {
    std::vector<std::string> line = words(out, "participant", {"--jobs", "2"});
    line.insert(line.begin(), "condyle");
    std::vector<char*> arguments;
    for (std::string& word : line) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(testing_support::program_path("condyle").c_str(), arguments.data());
    _exit(1);
  }
  static void expect_same(const std::string& out) {
    const auto files = files_in(folder_->path() / out);
    ASSERT_EQ(files.size(), whole_.size());
    for (const auto& [name, bytes] : whole_) {
      ASSERT_TRUE(files.count(name)) << name;
      EXPECT_EQ(files.at(name), bytes) << name;
    }
  }

  static TemporaryFolder* folder_;
  static std::map<std::string, std::string> whole_;
};
TemporaryFolder* Study::folder_ = nullptr;
std::map<std::string, std::string> Study::whole_;

TEST_F(Study, HasAFolderForEachRecordingWithoutPathsTimesOrNames) {
  EXPECT_TRUE(whole_.count("sub-01/ses-1/s1_1_1/readings.csv"));
  EXPECT_TRUE(whole_.count("sub-02/ses-2/broken/provenance.json"));
  EXPECT_FALSE(whole_.count("sub-02/ses-2/broken/readings.csv"));
  EXPECT_TRUE(whole_.count("dataset_description.json"));
  EXPECT_TRUE(whole_.count(".bidsignore"));
  EXPECT_FALSE(whole_.count(".work"));
  char host[256] = {};
  ASSERT_EQ(gethostname(host, sizeof(host) - 1), 0);
  for (const auto& [name, bytes] : whole_) {
    EXPECT_THAT(bytes, Not(HasSubstr(folder_->path().string()))) << name;
    if (std::string(host).size() > 3 && std::string("condyle").find(host) == std::string::npos) {
      EXPECT_THAT(bytes, Not(HasSubstr(host))) << name;
    }
  }
}

TEST_F(Study, IsTheSameWithOneProcessAndByShards) {
  EXPECT_EQ(run("one", {"--jobs", "1"}).exit_code, 0);
  expect_same("one");
  for (const char* shard : {"3/3", "1/3", "2/3"}) {
    EXPECT_EQ(run("shards", {"--shard", shard}).exit_code, 0);
  }
  expect_same("shards");
  for (const char* subject : {"02", "sub-01"}) {
    EXPECT_EQ(run("subjects", {"--participant-label", subject}).exit_code, 0);
  }
  expect_same("subjects");
}

TEST_F(Study, DoesOnlyWhatIsMissingOrHasChanged) {
  fs::copy(folder_->path() / "whole", folder_->path() / "again", fs::copy_options::recursive);
  EXPECT_THAT(run("again", {}).output, HasSubstr("0 analysed, 10 unchanged"));
  fs::remove_all(folder_->path() / "again/sub-01/ses-1/s1_1_2");
  EXPECT_THAT(run("again", {}).output, HasSubstr("1 analysed, 9 unchanged"));
  expect_same("again");
  // Other options, other results.
  EXPECT_THAT(run("again", {"--poses"}).output, HasSubstr("10 analysed, 0 unchanged"));
  EXPECT_TRUE(fs::exists(folder_->path() / "again/sub-01/ses-1/s1_1_2/poses.csv"));
  EXPECT_THAT(run("again", {}).output, HasSubstr("10 analysed, 0 unchanged"));
  expect_same("again");
}

// Killed at random times, and started again until it ends by itself.
TEST_F(Study, GoesOnAfterKills) {
  Random random(7);
  bool is_done = false;
  for (int kills = 0; !is_done; ++kills) {
    const pid_t process = fork();
    ASSERT_GE(process, 0);
    if (process == 0) {
      if (kills < 6) {
        // Ends this process, which becomes the command, at an instant of its work.
        const auto wait_us = static_cast<unsigned>(50'000 + 400'000 * random.uniform());
        ualarm(wait_us, 0);
      }
      become("killed");
    }
    random.uniform();
    int status = 0;
    ASSERT_EQ(waitpid(process, &status, 0), process);
    is_done = WIFEXITED(status);
    if (is_done) {
      EXPECT_EQ(WEXITSTATUS(status), 0);
    } else {
      EXPECT_EQ(WTERMSIG(status), SIGALRM);
    }
  }
  expect_same("killed");
}

// Killed before each of the first system calls that follow the creation of the folder.
TEST_F(Study, LeavesNothingBehindWhereverItIsKilled) {
  const fs::path out = folder_->path() / "stepped";
  for (int kill_at = 1; kill_at <= 20; ++kill_at) {
    fs::remove_all(out);
    const pid_t process = fork();
    ASSERT_GE(process, 0);
    if (process == 0) {
      if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
      become("stepped");
    }
    int status = 0;
    ASSERT_EQ(waitpid(process, &status, 0), process);
    // Each call stops the process twice: before and after it.
    for (int stops = 0; WIFSTOPPED(status) && stops < 2 * kill_at;) {
      ASSERT_EQ(ptrace(PTRACE_SYSCALL, process, nullptr, nullptr), 0);
      ASSERT_EQ(waitpid(process, &status, 0), process);
      if (fs::exists(out)) ++stops;
    }
    ASSERT_TRUE(WIFSTOPPED(status)) << "it ended by itself";
    kill(process, SIGKILL);
    while (waitpid(process, &status, 0) == process && !WIFSIGNALED(status)) {
    }
    for (const auto& [name, bytes] : files_in(out)) {
      EXPECT_TRUE(name.starts_with(".work") || name.find(".partial-") == std::string::npos)
          << name << " after " << kill_at << " calls";
    }
  }
  EXPECT_EQ(run("stepped", {}).exit_code, 0);
  expect_same("stepped");
}

TEST_F(Study, GathersTablesAndNamesProblems) {
  fs::copy(folder_->path() / "whole", folder_->path() / "group", fs::copy_options::recursive);
  const CommandResult first = run_condyle(words("group", "group"));
  ASSERT_EQ(first.exit_code, 0) << first.errors;
  const auto files = files_in(folder_->path() / "group/group");
  ASSERT_EQ(run_condyle(words("group", "group")).exit_code, 0);
  EXPECT_EQ(files_in(folder_->path() / "group/group"), files);
  folder_->write("group/group/readings.csv.partial-aBc123", "of a run that was killed\n");
  ASSERT_EQ(run_condyle(words("group", "group")).exit_code, 0);
  EXPECT_EQ(files_in(folder_->path() / "group/group"), files);

  EXPECT_THAT(files.at("problems.csv"), HasSubstr("broken.csv,02,2,clinical,"));
  EXPECT_THAT(files.at("problems.csv"), HasSubstr("missing.csv,02,2,clinical,"));
  EXPECT_THAT(files.at("study.html"), HasSubstr("8 of 10 recordings were analysed"));
  // One row for each row of each recording, and the scatter of eight recordings in four sessions.
  std::size_t rows = 0;
  for (const auto& [name, bytes] : whole_) {
    if (name.ends_with("readings.csv")) {
      rows += static_cast<std::size_t>(std::count(bytes.begin(), bytes.end(), '\n')) - 1;
    }
  }
  const std::string& all = files.at("readings.csv");
  EXPECT_EQ(static_cast<std::size_t>(std::count(all.begin(), all.end(), '\n')) - 1, rows);
  EXPECT_THAT(files.at("repeatability.csv"),
              HasSubstr("clinical,opening,,opening_mm,mm,within sessions,2,8,4,"));
  EXPECT_THAT(files.at("repeatability.csv"),
              HasSubstr("clinical,opening,,opening_mm,mm,between sessions,2,8,2,"));
  EXPECT_THAT(files.at("changes.csv"), HasSubstr("01,clinical,opening,,opening_mm,mm,1,2,"));
}

TEST_F(Study, NamesWhatIsWrongWithTheTable) {
  const auto expect = [&](const std::string& table, const char* words) {
    folder_->write("table.csv", table);
    const CommandResult result = run_condyle({"study", *folder_ / "data", *folder_ / "none",
                                              "participant", "--table", *folder_ / "table.csv"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_FALSE(fs::exists(folder_->path() / "none"));
  };
  expect("recording,subject,session\n", "table.csv:1: there is no column task");
  expect("recording,subject,session,task\n", "names no recording");
  expect("recording,subject,session,task\na.csv,../../x,1,chewing\n", "table.csv:2: subject");
  expect("recording,subject,session,task\n/etc/a.csv,1,1,chewing\n", "is not relative");
  expect("recording,subject,session,task\na.csv,1,1,x\na.csv,1,2,x\n", "is named twice");
  const CommandResult subject = run("none", {"--participant-label", "77"});
  EXPECT_EQ(subject.exit_code, 2);
  EXPECT_THAT(subject.errors, HasSubstr("77"));
}

TEST_F(Study, WritesAScriptForSlurmThatRunsEveryShard) {
  const std::string script = *folder_ / "study.sbatch";
  const CommandResult result = run("whole", {"--slurm", script, "--shards", "4"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string text = read_file(script);
  EXPECT_THAT(text, HasSubstr("#SBATCH --array=1-4\n"));
  EXPECT_THAT(text, HasSubstr("--shard \"$SLURM_ARRAY_TASK_ID/4\""));
}

}  // namespace
}  // namespace condyle
