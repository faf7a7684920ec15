// SPDX-License-Identifier: Apache-2.0
// A point of the jaw, followed through its pose, as a user of replay meets it.
#include <gmock/gmock.h>

#include <cmath>

#include "replay/hinged_jaw.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::CommandResult;
using testing_support::HingedJaw;
using testing_support::run_condyle;
using testing_support::Table;

TEST_F(HingedJaw, StandsStillAtItsHinge) {
  const std::string recording = write([](int, double*) {});
  const Table fork = replay(recording, {});
  EXPECT_GT(largest(fork, "z_velocity_m_s"), 0.07);
  // In the jaw frame x is left-right, z from point 1 to the middle of 2 and 3, y = z cross x.
  const Table hinge = replay(recording, {"--jaw-point-mm", "0", "80", "40"});
  EXPECT_THAT(summary_, HasSubstr("jaw point (0, 80, 40) mm"));
  for (const char* axis : {"x", "y", "z"}) {
    const auto position = hinge.numbers(std::string(axis) + "_position_m");
    const auto velocity = hinge.numbers(std::string(axis) + "_velocity_m_s");
    for (std::size_t i = 60; i < position.size(); ++i) {
      ASSERT_LT(std::abs(position[i]), 5e-5) << axis << i;
      ASSERT_LT(std::abs(velocity[i]), 5e-3) << axis << i;
    }
  }
  // What is learned differs, as the noise does.
  const std::string filter = folder_.write("filter.toml", "[learning]\nkernels = 0\n");
  const Table plain = replay(recording, {"--parameters", filter});
  const Table same = replay(recording, {"--parameters", filter, "--jaw-point-mm", "0", "0", "0"});
  for (const char* column : {"x_position_m", "y_velocity_m_s", "z_velocity_m_s"}) {
    const auto a = plain.numbers(column), b = same.numbers(column);
    for (std::size_t i = 60; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 5e-4) << column << i;
  }
}

TEST_F(HingedJaw, ABadFirstSampleMovesNothingAndTheFitIsReported) {
  const auto at_hinge = [&](double off_mm) {
    const Table table = replay(write([&](int i, double* points) {
                                 if (i == 0) points[1] += off_mm;  // point 1, in the points' plane
                               }),
                               {"--jaw-point-mm", "0", "80", "40"});
    EXPECT_EQ(table.columns.at("events")[0], "not_started");
    EXPECT_EQ(table.columns.at("position_m")[13], "") << "the shape is being learned";
    EXPECT_NE(table.columns.at("position_m")[14], "");
    EXPECT_THAT(summary_, HasSubstr("14 not_started"));
    EXPECT_THAT(summary_, HasSubstr("body        residual of its fit "));
    EXPECT_THAT(summary_, HasSubstr("0 samples beyond 0.1 mm not used; 14 withheld"));
    return largest(table, "y_position_m");
  };
  EXPECT_LT(at_hinge(3), 5e-5);
  EXPECT_NEAR(at_hinge(3), at_hinge(0), 1e-6) << "a wrong shape is 2 mm off";
}

TEST_F(HingedJaw, SaysWhereItIsNotRigidOrFrozen) {
  double frozen[9];
  const std::string recording = write([&](int i, double* points) {
    if (i == 200) points[3] += 20;  // point 2 jumps along the line between 2 and 3
    if (i == 300) std::copy(points, points + 9, frozen);
    if (i > 300 && i < 360) std::copy(frozen, frozen + 9, points);
  });
  const Table table = replay(recording, {"--jaw-point-mm", "0", "80", "40"});
  EXPECT_THAT(summary_, HasSubstr("1 points_not_rigid"));
  EXPECT_THAT(table.columns.at("events")[200], HasSubstr("points_not_rigid"));
  EXPECT_EQ(table.columns.at("position_provenance")[200], "derived");
  const auto& events = table.columns.at("events");
  for (std::size_t i = 310; i < 360; ++i) EXPECT_THAT(events[i], HasSubstr("position_frozen")) << i;
  EXPECT_THAT(events[359], HasSubstr("state_lost"));
  EXPECT_EQ(table.columns.at("position_m")[359], "") << "after 0.25 s nothing is known";
  EXPECT_THAT(events[360], HasSubstr("state_restarted"));
  EXPECT_THAT(events[360], testing::Not(HasSubstr("frozen")));
  for (const double velocity : table.numbers("velocity_m_s")) {
    ASSERT_FALSE(std::abs(velocity) > 0.02);
  }
}

TEST_F(HingedJaw, EveryValueSaysWhereItComesFrom) {
  const Table table = replay(write([](int i, double* points) {
                               if (i == 300) std::fill_n(points, 9, std::nan(""));
                             }),
                             {"--faults", "event", "--axis", "y"});
  for (const std::string quantity : {"position", "velocity", "acceleration"}) {
    const auto& followed = table.columns.at(quantity + "_provenance");
    EXPECT_EQ(followed.front(), "assumed");
    EXPECT_EQ(followed[300], "derived");
    EXPECT_EQ(followed.back(), "measured");
    EXPECT_EQ(table.columns.at("y_" + quantity + "_provenance"), followed);
    const std::string unit = quantity == "position"   ? "_m"
                             : quantity == "velocity" ? "_m_s"
                                                      : "_m_s2";
    for (const std::string axis : {"x_", "y_", "z_"}) {
      const auto& provenance = table.columns.at(axis + quantity + "_provenance");
      const auto& value = table.columns.at(axis + quantity + unit);
      for (std::size_t i = 0; i < table.rows; ++i) {
        ASSERT_EQ(provenance[i].empty(), value[i].empty()) << axis << quantity << i;
      }
    }
  }
}

TEST_F(HingedJaw, SaysWhyThePoseIsNotKnown) {
  const std::vector<std::string> jaw_point = {"--jaw-point-mm", "0", "0", "-90"};
  replay(write([](int, double* points) {
           for (int i = 3; i < 9; ++i) points[i] = points[i % 3] + (i < 6 ? 20 : 50);
         }),
         jaw_point);
  EXPECT_THAT(summary_, HasSubstr("600 points_not_rigid"));
  EXPECT_THAT(summary_, HasSubstr("estimates   none: the jaw's pose is not known: 600 samples had "
                                  "three points that coincide or lie on a line\n"));
  replay(write([](int i, double* points) { points[3] += 20 * (i % 2) + 20 * (i % 3); }), jaw_point);
  EXPECT_THAT(summary_, HasSubstr("586 samples had points whose distances changed, 14 "
                                  "samples were withheld to learn the body's shape, which takes "
                                  "15\n"));
}

// The hinge stands still for whoever follows it, and only there.
TEST_F(HingedJaw, StandsStillForOtherCommands) {
  const std::string recording = write([](int, double*) {});
  const std::vector<std::string> release = {"protocol", "release", recording, "--begin-s",
                                            "0.6",      "--end-s", "1.1"};
  std::vector<std::string> at_hinge = release;
  at_hinge.insert(at_hinge.end(), {"--jaw-point-mm", "0", "80", "40"});
  EXPECT_THAT(run_condyle(at_hinge).errors, HasSubstr("no motion above the noise"));
  EXPECT_THAT(run_condyle(release).errors, testing::Not(HasSubstr("no motion")));
  const CommandResult compared = run_condyle(
      {"compare", recording, "--with", "recommended", "--jaw-point-mm", "0", "80", "40"});
  EXPECT_EQ(compared.exit_code, 0) << compared.errors;
}

}  // namespace
}  // namespace condyle
