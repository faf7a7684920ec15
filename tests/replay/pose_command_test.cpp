// SPDX-License-Identifier: Apache-2.0
// The whole pose, as a user of replay meets it.
#include <gmock/gmock.h>

#include <cmath>

#include "replay/hinged_jaw.h"
#include "support/paths.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::CommandResult;
using testing_support::HingedJaw;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;

constexpr double kStep_s = 1 / 60.0;
constexpr std::size_t kLearned = 60;  // samples

class PoseCommand : public HingedJaw {
 protected:
  Table poses(const std::string& recording, std::vector<std::string> more = {}) {
    more.insert(more.end(), {"--pose", folder_ / "pose.csv"});
    points_ = replay(recording, std::move(more));
    return read_table(folder_ / "pose.csv");
  }
  std::string problem(const std::string& recording, std::vector<std::string> more) {
    more.insert(more.begin(), {"replay", recording});
    const CommandResult result = run_condyle(more);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    return result.errors;
  }
  Table points_;  // of the followed point
};

TEST_F(PoseCommand, HasTheTurnAndTheMotionOfAnyPoint) {
  const Table pose =
      poses(write([](int, double*) {}), {"--lag", "5", "--pose-point", "hinge", "0", "80", "40",
                                         "--pose-point", "incisor", "0", "0", "-30"});
  ASSERT_EQ(pose.rows, 600U);
  const auto column = [&pose](const std::string& name) { return pose.numbers(name); };
  const auto turn = column("rotation_vector_x_rad"), rate = column("angular_velocity_x_rad_s");
  const auto twist = column("twist_rad"), swing = column("swing_rad");
  const auto speed_y = column("incisor_velocity_y_m_s"), speed_z = column("incisor_velocity_z_m_s");
  const double reference_rad = angle_rad(14 * kStep_s);  // the first sample with a pose
  for (std::size_t i = kLearned; i < pose.rows; ++i) {
    const double time_s = static_cast<double>(i) * kStep_s;
    ASSERT_NEAR(turn[i], angle_rad(time_s) - reference_rad, 2e-3) << i;
    ASSERT_NEAR(rate[i], rate_rad_s(time_s), 3e-2) << i;
    ASSERT_NEAR(twist[i], turn[i], 1e-4) << i;
    ASSERT_LT(swing[i], 1e-3) << i;
    // 80 mm before the hinge and 70 mm below it.
    const double arm_m = std::hypot(0.080, 0.070);
    ASSERT_NEAR(std::hypot(speed_y[i], speed_z[i]), arm_m * std::abs(rate_rad_s(time_s)), 5e-3);
  }
  for (const char axis : {'x', 'y', 'z'}) {
    const auto hinge = column(std::string("hinge_") + axis + "_m");
    for (std::size_t i = kLearned; i < pose.rows; ++i) ASSERT_NEAR(hinge[i], 0, 2e-4) << axis << i;
  }
  EXPECT_THAT(summary_, HasSubstr("\npose        586 of 600 samples have a pose; largest turn 9."));
  EXPECT_THAT(summary_, HasSubstr("\nposes       "));
}

// The time of a row is that of its values, and the followed point's file is as without the pose.
TEST_F(PoseCommand, LeavesTheFollowedPointAsItIs) {
  const std::string recording = write([](int, double*) {});
  const Table pose = poses(recording, {"--lag", "3"});
  const Table beside = points_;
  const Table alone = replay(recording, {"--lag", "3"});
  EXPECT_EQ(beside.columns, alone.columns);
  EXPECT_EQ(pose.columns.at("time_s"), alone.columns.at("time_s"));
}

TEST_F(PoseCommand, EveryValueSaysWhereItComesFrom) {
  std::mt19937 generator(4);
  std::normal_distribution<double> noise_mm(0, 0.02);
  const Table pose = poses(write([&](int i, double* points) {
                             for (int k = 0; k < 9; ++k) points[k] += noise_mm(generator);
                             if (i == 300) std::fill_n(points, 9, std::nan(""));
                             if (i == 400) points[3] += 20;  // along the line between 2 and 3
                             if (i >= 500 && i < 530) std::fill_n(points, 9, std::nan(""));
                           }),
                           {"--faults", "event", "--pose-point", "incisor", "0", "0", "-30"});
  const std::vector<std::string> positions = {"centre", "rotation_vector", "twist", "incisor"};
  const std::vector<std::string> rates = {"centre_velocity", "angular_velocity", "twist_rate",
                                          "incisor_velocity"};
  for (const auto& names : {positions, rates}) {
    for (const std::string& name : names) {
      const auto& provenance = pose.columns.at(name + "_provenance");
      EXPECT_EQ(provenance[5], "") << name << ": the shape is being learned";
      EXPECT_EQ(provenance[200], "measured") << name;
      EXPECT_EQ(provenance[300], "derived") << name;
      EXPECT_EQ(provenance[400], "derived") << name;
      EXPECT_EQ(provenance[529], "") << name << ": after 0.25 s nothing is known";
      EXPECT_EQ(provenance[599], "measured") << name;
    }
  }
  // The jaw turns about one axis: its swing is noise, which is not measured.
  const auto swing = pose.numbers("swing_rad"), swing_sd = pose.numbers("swing_sd_rad");
  int noise = 0;
  for (std::size_t i = 0; i < pose.rows; ++i) {
    if (!(swing[i] <= 2 * swing_sd[i])) continue;
    ++noise;
    ASSERT_EQ(pose.columns.at("swing_provenance")[i], "assumed") << i;
  }
  EXPECT_GT(noise, 300);
  const auto& events = pose.columns.at("events");
  EXPECT_THAT(events[5], HasSubstr("not_started"));
  EXPECT_THAT(events[300], HasSubstr("position_missing"));
  EXPECT_THAT(events[400], HasSubstr("points_not_rigid"));
  EXPECT_THAT(events[529], HasSubstr("state_lost"));
  // A value is there with its deviation and its provenance, or none of them is.
  for (const std::string& name : pose.header) {
    if (!name.ends_with("_provenance")) continue;
    const std::string quantity = name.substr(0, name.size() - 11);
    for (const std::string& other : pose.header) {
      const bool is_its = other.starts_with(quantity + "_x_") || other == quantity + "_rad" ||
                          other == quantity + "_sd_rad";
      for (std::size_t i = 0; is_its && i < pose.rows; ++i) {
        ASSERT_EQ(pose.columns.at(name)[i].empty(), pose.columns.at(other)[i].empty())
            << other << i;
      }
    }
  }
}

TEST_F(PoseCommand, SaysWhatItCannotUse) {
  const std::string recording = write([](int, double*) {});
  const std::string out = folder_ / "pose.csv";
  const std::string one = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");
  EXPECT_THAT(problem(one, {"--pose", out}),
              HasSubstr("chewing_60hz.csv: has no three points and no orientation, so the jaw's "
                        "pose is not known; leave out --pose"));
  EXPECT_THAT(problem(recording, {"--pose", out, "--estimator", "published"}),
              HasSubstr("--pose: is not supported by --estimator published"));
  EXPECT_THAT(problem(recording, {"--pose", out, "--pose-point", "a", "0", "x", "1"}),
              HasSubstr("--pose-point a: 'x' is not a coordinate from -1000 to 1000 mm; give "
                        "NAME X Y Z"));
  EXPECT_THAT(problem(recording, {"--pose", out, "--pose-point", "1a", "0", "0", "1"}),
              HasSubstr("is not a name for a point; begin with a letter"));
  EXPECT_THAT(problem(recording, {"--pose", out, "--pose-point", "centre", "0", "0", "1"}),
              HasSubstr("centre is already the name of a value; give the point another name"));
  EXPECT_THAT(problem(recording, {"--pose", out, "--pose-point", "a", "0", "0", "1", "--pose-point",
                                  "a", "0", "0", "2"}),
              HasSubstr("a is already the name of a value"));
  EXPECT_THAT(problem(recording, {"--pose", recording}), HasSubstr(recording));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace condyle
