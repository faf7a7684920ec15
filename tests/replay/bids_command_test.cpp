// SPDX-License-Identifier: Apache-2.0
// `condyle export --format bids`, and `condyle study` on the data set that it writes.
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

std::vector<std::vector<std::string>> table_of(const std::string& path, char separator) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream file(read_file(path));
  for (std::string line; std::getline(file, line);) {
    rows.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, separator);) rows.back().push_back(field);
  }
  return rows;
}

class Bids : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    ASSERT_EQ(
        run_condyle({"simulate",
                     testing_support::source_path("/host_sim/scenarios/clinical_session.toml"),
                     "--out", *folder_ / "session.csv"})
            .exit_code,
        0);
    for (const char* subject : {"01", "02"}) {
      const auto exported =
          run_condyle({"export", *folder_ / "session.csv", "--out", *folder_ / "ds", "--format",
                       "bids", "--subject", subject, "--task", "clinical"});
      ASSERT_EQ(exported.exit_code, 0) << exported.errors;
    }
  }
  static void TearDownTestSuite() { delete folder_; }
  static TemporaryFolder* folder_;
};
TemporaryFolder* Bids::folder_ = nullptr;

// The study's readings of the data set are those of the recording that was exported.
TEST_F(Bids, StudyReadsTheExportedDataSet) {
  const std::vector<std::string> study = {
      "study",       *folder_ / "ds", *folder_ / "ds/derivatives/readings",
      "participant", "--landmarks",   *folder_ / "session.landmarks.toml"};
  const auto participants = run_condyle(study);
  ASSERT_EQ(participants.exit_code, 0) << participants.errors;
  EXPECT_THAT(participants.output, HasSubstr("2 analysed"));
  ASSERT_EQ(run_condyle({"study", *folder_ / "ds", *folder_ / "ds/derivatives/readings", "group"})
                .exit_code,
            0);
  ASSERT_EQ(run_condyle({"analyse", *folder_ / "session.csv", "--landmarks",
                         *folder_ / "session.landmarks.toml", "--out", *folder_ / "readings"})
                .exit_code,
            0);
  const auto own = table_of(*folder_ / "readings/readings.csv", ',');
  for (const char* subject : {"01", "02"}) {
    const std::string name = std::string("sub-") + subject;
    const auto read = table_of(*folder_ / ("ds/derivatives/readings/" + name + "/" + name +
                                           "_task-clinical_tracksys-facebow_motion/readings.csv"),
                               ',');
    ASSERT_GT(own.size(), 20U);
    ASSERT_EQ(read.size(), own.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
      // All but the column with the recording's name.
      for (std::size_t j = 1; j < own[i].size(); ++j) EXPECT_EQ(read[i][j], own[i][j]) << i;
    }
  }
}

// The estimates are those of replay, in mm.
TEST_F(Bids, DerivativesAreTheEstimatesOfReplay) {
  ASSERT_EQ(run_condyle({"replay", *folder_ / "session.csv", "--out", *folder_ / "e.csv",
                         "--out-unit", "mm"})
                .exit_code,
            0);
  const auto expected = table_of(*folder_ / "e.csv", ',');
  const std::string stem =
      "ds/derivatives/condyle/sub-01/motion/sub-01_task-clinical_tracksys-facebow_desc-estimates_";
  const auto rows = table_of(*folder_ / (stem + "motion.tsv"), '\t');
  const auto channels = table_of(*folder_ / (stem + "channels.tsv"), '\t');
  std::map<std::string, std::size_t> column;
  for (std::size_t i = 0; i < expected[0].size(); ++i) column[expected[0][i]] = i;
  const std::map<std::string, std::string> names = {
      {"x_position", "x_position_mm"},
      {"y_velocity", "y_velocity_mm_s"},
      {"y_velocity_sd", "y_velocity_sd_mm_s"},
      {"z_acceleration", "z_acceleration_mm_s2"},
      {"force", "force_N"},
      {"z_velocity_provenance", "z_velocity_provenance"}};
  const std::map<std::string, std::string> provenances = {
      {"", "0"}, {"assumed", "1"}, {"derived", "2"}, {"measured", "3"}};
  ASSERT_EQ(rows.size() + 1, expected.size());
  std::size_t compared = 0;
  for (std::size_t i = 1; i < channels.size(); ++i) {
    const auto name = names.find(channels[i][0]);
    if (name == names.end()) continue;
    ++compared;
    for (std::size_t k = 0; k < rows.size(); ++k) {
      ASSERT_EQ(rows[k].size() + 1, channels.size());
      const std::string& text = expected[k + 1][column.at(name->second)];
      if (channels[i][0].ends_with("provenance")) {
        ASSERT_EQ(rows[k][i - 1], provenances.at(text)) << k;
      } else {
        ASSERT_NEAR(std::stod(rows[k][i - 1]), std::stod(text), 1e-12 * std::abs(std::stod(text)))
            << name->first << " " << k;
      }
    }
  }
  EXPECT_EQ(compared, names.size());
}

TEST_F(Bids, LabelsAreOnlyForBids) {
  const auto result = run_condyle(
      {"export", *folder_ / "session.csv", "--out", *folder_ / "x.csv", "--subject", "01"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors,
              HasSubstr("does not apply to csv; leave it out, or give --format bids"));
  EXPECT_FALSE(fs::exists(*folder_ / "x.csv"));
}

}  // namespace
}  // namespace condyle
