// SPDX-License-Identifier: Apache-2.0
// Real recordings. They are not part of the project: without CONDYLE_REFERENCE_DATA these tests
// skip.
//
// JMA_position.txt serves as a waveform along one axis. The script that converted it from a Zebris
// recording lost the rotation, and its rigid distances come from that script. marker1 to marker3
// are the tracks of the instrument: the three-dimensional recording.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "support/command.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AnyOf;
using testing::HasSubstr;
using testing_support::reference_data;
using testing_support::run_condyle;
using testing_support::Table;

class RealRecordings : public testing::Test {
 protected:
  void SetUp() override {
    if (reference_data("zebris_jma/JMA_position.txt").empty()) {
      GTEST_SKIP() << "set CONDYLE_REFERENCE_DATA to the folder of reference data";
    }
  }

  // Replays and returns the estimates; the summary stays in `summary_`, warnings in `errors_`.
  Table replay(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "replay");
    arguments.insert(arguments.end(), {"--out", folder_ / "estimates.csv"});
    const auto result = run_condyle(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    summary_ = result.output;
    errors_ = result.errors;
    return testing_support::read_table(folder_ / "estimates.csv");
  }

  testing_support::TemporaryFolder folder_;
  std::string summary_, errors_;
};

// The paper's figures 5 and 6: friction stands still, the mass climbs to the assumed one.
TEST_F(RealRecordings, ZebrisGivesThePapersFrictionAndMassAndCallsThemAssumed) {
  const Table table =
      replay({reference_data("zebris_jma/JMA_position.txt"), "--estimator", "published",
              "--parameters", reference_data("zebris_opening_50hz.toml")});
  ASSERT_EQ(table.rows, 634U);
  for (const double friction : table.numbers("friction_Ns_m")) {
    EXPECT_GE(friction, 0.0219);
    EXPECT_LE(friction, 0.0221);
  }
  EXPECT_EQ(table.numbers("mass_kg").front(), 0.1);
  EXPECT_NEAR(table.numbers("mass_kg").back(), 0.247, 0.0005);
  EXPECT_THAT(table.columns.at("friction_provenance"), testing::Each("assumed"));
  EXPECT_THAT(table.columns.at("mass_provenance"), testing::Each("assumed"));
  EXPECT_THAT(summary_, HasSubstr("Friction and mass are assumed, not measured: the force that"));
  EXPECT_THAT(summary_, HasSubstr("friction  0.02199 Ns/m, assumed"));
  EXPECT_THAT(summary_, HasSubstr("verdict     matched"));
}

// Point 1's z axis of the file is what the reference vector was made from.
TEST_F(RealRecordings, ZebrisWaveformIsReadAsTheVectorSays) {
  const Table table =
      replay({reference_data("zebris_jma/JMA_position.txt"), "--estimator", "published",
              "--parameters", reference_data("zebris_opening_50hz.toml")});
  const Table expected =
      testing_support::read_table(reference_data("zebris_opening_50hz.estimates.csv"));
  for (const char* column : {"position_m", "velocity_m_s", "force_N", "mass_kg"}) {
    const auto a = table.numbers(column), b = expected.numbers(column);
    ASSERT_EQ(a.size(), b.size());
    const double scale = testing_support::rms(b);
    for (std::size_t i = 0; i < a.size(); ++i) {
      ASSERT_LE(std::abs(a[i] - b[i]), 1e-9 * std::max(std::abs(b[i]), scale)) << column << i;
    }
  }
}

TEST_F(RealRecordings, ProbeTextsPointsAndAxesAreToldApart) {
  const std::string path = reference_data("zebris_jma/JMA_position.txt");
  EXPECT_NEAR(replay({path, "--estimator", "published", "--point", "1", "--axis", "x"})
                  .numbers("position_m")[0],
              0.40567, 1e-9);
  EXPECT_NEAR(replay({path, "--estimator", "published", "--point", "3", "--axis", "y"})
                  .numbers("position_m")[0],
              0.34193, 1e-9);
  EXPECT_NEAR(replay({path, "--estimator", "published", "--point", "2"}).numbers("position_m")[0],
              0.010911, 1e-9);
}

TEST_F(RealRecordings, Jaws3dsUnevenStepsAreWarnedAbout) {
  const Table table =
      replay({reference_data("jaws3d/jawPosition.txt"), "--estimator", "published", "--axis", "x"});
  EXPECT_EQ(table.rows, 1017U);
  EXPECT_THAT(errors_, HasSubstr("134 of 1016 steps (14 to 15 ms) differ from the sample time"));
  EXPECT_THAT(summary_, HasSubstr("sample time 0.015 s"));
  EXPECT_EQ(table.columns.at("time_s")[4], "0.059") << "nothing is resampled";
}

TEST_F(RealRecordings, SsffsZeroFilledEndIsAnEvent) {
  const Table table = replay({reference_data("ema_jaw/0020.jaw"), "--estimator", "published"});
  EXPECT_EQ(table.rows, 800U);
  EXPECT_THAT(summary_, HasSubstr("40 position_missing"));
  const auto& events = table.columns.at("events");
  EXPECT_EQ(std::count(events.begin(), events.end(), "position_missing"), 40);
  EXPECT_EQ(events.back(), "position_missing");
  EXPECT_EQ(table.columns.at("force_provenance").back(), "assumed");
  EXPECT_EQ(table.columns.at("motion_nis").back(), "");
}

// The glitches of 3 mm near 8.9 s and the zero-filled end make no velocity.
TEST_F(RealRecordings, GlitchesAndDropoutsMakeNoVelocity) {
  const auto largest_speed_mm_s = [](const Table& table) {
    double largest = 0;
    for (const char* column : {"x_velocity_m_s", "y_velocity_m_s", "z_velocity_m_s"}) {
      for (const double velocity : table.numbers(column)) {
        if (std::isfinite(velocity)) largest = std::max(largest, 1e3 * std::abs(velocity));
      }
    }
    return largest;
  };
  for (const char* lag : {"0", "3"}) {
    const Table zebris = replay({reference_data("zebris_jma/JMA_position.txt"), "--lag", lag});
    EXPECT_LT(largest_speed_mm_s(zebris), 150);
    EXPECT_THAT(zebris.columns.at("events")[447],
                AnyOf(HasSubstr("outlier_rejected"), HasSubstr("motion_changed")));
    EXPECT_THAT(
        errors_,
        HasSubstr("the positions were smoothed or otherwise filtered before they were recorded"));
    const Table speech = replay({reference_data("ema_jaw/0020.jaw"), "--lag", lag});
    EXPECT_LT(largest_speed_mm_s(speech), 150);
    EXPECT_THAT(summary_, HasSubstr("40 position_missing"));
    EXPECT_THAT(errors_, HasSubstr("neighbouring innovations (x, y, z) are correlated"));
  }
}

TEST_F(RealRecordings, FollowsAnyPointOfTheJaw) {
  const std::string path = reference_data("zebris_jma/marker1.txt") + "+" +
                           reference_data("zebris_jma/marker2.txt") + "+" +
                           reference_data("zebris_jma/marker3.txt");
  const Table point = replay({path}), same = replay({path, "--jaw-point-mm", "0", "0", "0"});
  ASSERT_EQ(point.rows, 401U);
  EXPECT_THAT(summary_, HasSubstr("3 x ArtiSynth probe text"));
  const auto a = point.numbers("z_position_m"), b = same.numbers("z_position_m");
  constexpr std::size_t settled = 24;  // samples after which the points' distances are known
  EXPECT_TRUE(std::isnan(b[settled - 1]));
  // At two glitches all tracks jump by 3 mm and more; what the estimator makes of them depends on
  // the samples before, of which a jaw point has fewer.
  const auto is_glitch = [](std::size_t i) {
    return (i >= 107 && i <= 115) || (i >= 232 && i <= 241);
  };
  const auto expect_same = [&](const std::vector<double>& x, const std::vector<double>& y) {
    for (std::size_t i = settled; i < x.size(); ++i) {
      if (!is_glitch(i)) {
        EXPECT_NEAR(x[i], y[i], 5e-5) << i;
      }
    }
  };
  expect_same(a, b);
  EXPECT_THAT(summary_, testing::Not(HasSubstr("points_not_rigid")));
  EXPECT_THAT(summary_, HasSubstr("residual of its fit 0.003 mm rms"));
  // Point 2 of the bite fork is at (25, 0, 30.5) mm in the frame of the three.
  const Table second = replay({path, "--point", "2"}),
              fitted = replay({path, "--jaw-point-mm", "25", "0", "30.5"});
  const auto c = second.numbers("y_position_m"), d = fitted.numbers("y_position_m");
  expect_same(c, d);
}

}  // namespace
}  // namespace condyle
