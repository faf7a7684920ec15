// SPDX-License-Identifier: Apache-2.0
// The estimates of `replay` in the forms that its user may choose.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::read_file;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;
using testing_support::TemporaryFolder;

const std::string kShipped = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");

class EstimatesForm : public testing::Test {
 protected:
  std::string replay(const std::string& name, std::vector<std::string> more,
                     const std::string& recording = kShipped) {
    std::vector<std::string> words = {"replay", recording, "--out", folder_ / name};
    words.insert(words.end(), more.begin(), more.end());
    const auto result = run_condyle(words);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return folder_ / name;
  }
  TemporaryFolder folder_;
};

TEST_F(EstimatesForm, MillimetresAreMetresTimesAThousand) {
  const Table in_m = read_table(replay("m.csv", {}));
  const Table in_mm = read_table(replay("mm.csv", {"--out-unit", "mm"}));
  ASSERT_EQ(in_m.header.size(), in_mm.header.size());
  int scaled = 0;
  for (std::size_t c = 0; c < in_m.header.size(); ++c) {
    const std::string &from = in_m.header[c], &to = in_mm.header[c];
    if (from == to) {
      EXPECT_EQ(in_m.columns.at(from), in_mm.columns.at(to)) << from;
      continue;
    }
    ++scaled;
    const double factor = from == "jerk_density_m2_s5" ? 1e6 : 1e3;
    const auto metres = in_m.numbers(from), millimetres = in_mm.numbers(to);
    for (std::size_t i = 0; i < metres.size(); ++i) {
      ASSERT_TRUE(std::isnan(metres[i]) ? std::isnan(millimetres[i])
                                        : factor * metres[i] == millimetres[i])
          << from << " row " << i;
    }
  }
  EXPECT_EQ(scaled, 11);
}

TEST_F(EstimatesForm, ADecimalCommaChangesNothingElse) {
  const std::string plain = read_file(replay("plain.csv", {}));
  std::string local = read_file(replay("local.csv", {"--decimal-comma"}));
  EXPECT_THAT(local, testing::Not(HasSubstr(".")));
  std::replace(local.begin(), local.end(), ',', '.');
  std::replace(local.begin(), local.end(), ';', ',');
  EXPECT_EQ(local, plain);
}

// Rows at instants of samples are those of the samples; the others have no measured values.
TEST_F(EstimatesForm, ResamplingKeepsTheEstimatesOfSamples) {
  std::string rows = "time_s,position_m\n";
  for (int i = 0; i < 600; ++i) {
    const double t = i * 0.01;
    rows += std::to_string(t) + "," + std::to_string(0.01 * std::sin(6 * t) + 1e-5 * (i * i % 7)) +
            "\n";
  }
  const std::string recording = folder_.write("sine.csv", rows);
  const Table samples = read_table(replay("samples.csv", {}, recording));
  const Table instants = read_table(replay("instants.csv", {"--resample-Hz", "400"}, recording));
  ASSERT_EQ(samples.rows, 600U);
  ASSERT_EQ(instants.rows, 4 * 599U + 1);
  for (const std::string& column : instants.header) {
    for (std::size_t i = 0; i < samples.rows; ++i) {
      ASSERT_EQ(instants.columns.at(column)[4 * i], samples.columns.at(column)[i]) << column;
    }
  }
  const auto& provenance = instants.columns.at("position_provenance");
  EXPECT_EQ(provenance[2000], "measured");
  EXPECT_EQ(provenance[2001], "derived");
  for (const char* column : {"measured_position_m", "innovation_m", "motion_nis"}) {
    EXPECT_EQ(instants.columns.count(column), 0U) << column;
  }
}

TEST_F(EstimatesForm, ColumnsFollowFromEstimatorAndInputs) {
  const std::string points = folder_.write(
      "point.csv", "time_s,x1_m,y1_m,z1_m\n0,0.1,0.2,0.3\n0.01,0.1,0.2,0.3\n0.02,0.1,0.2,0.31\n");
  const Table three = read_table(replay("points.csv", {}, points));
  EXPECT_EQ(three.columns.at("y_measured_position_m"), std::vector<std::string>(3, "0.2"));
  EXPECT_EQ(three.columns.count("mass_kg"), 0U);
  const Table published = read_table(replay("published.csv", {"--estimator", "published"}));
  for (const char* column : {"measured_position_m", "friction_Ns_m", "mass_nis"}) {
    EXPECT_EQ(published.columns.count(column), 1U) << column;
  }
}

TEST_F(EstimatesForm, IsRefusedWhereItMeansNothing) {
  const auto alone = run_condyle({"replay", kShipped, "--out-unit", "mm"});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.errors, HasSubstr("--out"));
  const auto published = run_condyle({"replay", kShipped, "--estimator", "published", "--out",
                                      folder_ / "p.csv", "--resample-Hz", "50"});
  EXPECT_EQ(published.exit_code, 2);
  EXPECT_THAT(published.errors, HasSubstr("--resample-Hz"));
}

}  // namespace
}  // namespace condyle
