// SPDX-License-Identifier: Apache-2.0
// simulate, friction and sim: as a user runs them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

std::string scenario(const std::string& name) {
  return testing_support::source_path("/host_sim/scenarios/") + name + ".toml";
}

TEST(Simulate, WritesWhatReplayReads) {
  const TemporaryFolder folder;
  const CommandResult simulated = run_condyle({"simulate", scenario("chin_load"), "--out",
                                               folder / "r.csv", "--truth", folder / "truth.csv"});
  ASSERT_EQ(simulated.exit_code, 0) << simulated.errors;
  EXPECT_EQ(folder.count(), 3) << "the drive stands beside the recording";
  EXPECT_GT(read_table(folder / "r.drive.csv").rows, 3990U);
  const auto truth = read_table(folder / "truth.csv");
  EXPECT_EQ(truth.rows, 1200U);
  EXPECT_EQ(truth.columns.count("anterior_digastric_activation"), 1U);
  EXPECT_EQ(truth.columns.count("friction_force_N"), 1U);
  const CommandResult replayed =
      run_condyle({"replay", folder / "r.csv", "--out", folder / "e.csv"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
  EXPECT_EQ(read_table(folder / "e.csv").rows, 1200U);
}

// What the head's accelerometer measures gives the ratios of the simulated jaw.
TEST(Simulate, WritesTheHeadsAccelerationBesideTheRecording) {
  const TemporaryFolder folder;
  ASSERT_EQ(
      run_condyle({"simulate", scenario("nodding_head"), "--out", folder / "r.csv"}).exit_code, 0);
  EXPECT_EQ(folder.count(), 2);
  const CommandResult result = run_condyle(
      {"protocol", "head-motion", folder / "r.csv", "--acceleration", folder / "r.head.csv",
       "--muscle-share", "0", "--acceleration-delay-sd-ms", "0.2", "--out", folder / "v.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto values = nlohmann::json::parse(read_file(folder / "v.json"));
  for (const auto& [name, truth] :
       {std::pair{"damping_rate_per_s", 8.0}, std::pair{"stiffness_per_mass_per_s2", 400.0}}) {
    EXPECT_EQ(values[name]["provenance"], "measured") << result.output;
    EXPECT_LT(values[name]["low_95"], truth);
    EXPECT_GT(values[name]["high_95"], truth);
  }
}

// The whole session of a kinematic jaw: tasks, landmarks, poses and readings beside the recording.
TEST(Simulate, WritesAClinicalSession) {
  const TemporaryFolder folder;
  const CommandResult result = run_condyle({"simulate", scenario("clinical_session"), "--out",
                                            folder / "jaw.csv", "--truth", folder / "truth.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(folder.count(), 6);
  const std::size_t rows = read_table(folder / "jaw.csv").rows;
  EXPECT_GT(rows, 3600U);
  EXPECT_EQ(read_table(folder / "truth.csv").rows, rows);
  EXPECT_THAT(read_file(folder / "jaw.landmarks.toml"), HasSubstr("\ncondyle_left = ["));
  EXPECT_THAT(read_file(folder / "jaw.tasks.csv"), HasSubstr("\nprotrusion,"));
  EXPECT_THAT(read_file(folder / "jaw.readings.csv"),
              HasSubstr("\nleft,right,0,bennett_angle_5mm_deg,"));
  EXPECT_THAT(read_file(folder / "jaw.cycles.csv"), HasSubstr("\n1,1,left,0,"));
  const CommandResult replayed =
      run_condyle({"replay", "sim:" + scenario("clinical_session"), "--out", folder / "e.csv"});
  EXPECT_EQ(replayed.exit_code, 0) << replayed.errors;
  EXPECT_EQ(read_table(folder / "e.csv").rows, rows);
  EXPECT_EQ(run_condyle({"simulate", scenario("clinical_session"), "--out", "-"}).exit_code, 2);
}

TEST(Simulate, SameSeedSameBytes) {
  const TemporaryFolder folder;
  const auto simulate = [&](const char* name, const char* seed) {
    EXPECT_EQ(run_condyle({"simulate", scenario("chewing"), "--out", folder / name, "--seed", seed})
                  .exit_code,
              0);
    return read_file(folder / name);
  };
  const std::string first = simulate("a.csv", "5");
  EXPECT_EQ(first, simulate("b.csv", "5"));
  EXPECT_NE(first, simulate("c.csv", "6"));
}

// The same simulation, written first or played live behind the facebow interface.
TEST(Sim, IsTheSimulationLive) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_condyle({"simulate", scenario("chewing"), "--out", folder / "r.csv"}).exit_code, 0);
  ASSERT_EQ(
      run_condyle({"replay", "file:" + (folder / "r.csv"), "--out", folder / "a.csv"}).exit_code,
      0);
  const CommandResult live =
      run_condyle({"replay", "sim:" + scenario("chewing"), "--out", folder / "b.csv"});
  ASSERT_EQ(live.exit_code, 0) << live.errors;
  EXPECT_THAT(live.output, HasSubstr("no person was recorded"));
  EXPECT_EQ(read_file(folder / "a.csv"), read_file(folder / "b.csv"));
}

// As it was once written.
TEST(Sim, IsMeantBySynthWithAScenario) {
  const TemporaryFolder folder;
  const std::string path = folder.write("s.toml", "duration_s = 1\n");
  const CommandResult now = run_condyle({"replay", "sim:" + path, "--out", folder / "a.csv"});
  const CommandResult once = run_condyle({"replay", "synth:" + path, "--out", folder / "b.csv"});
  ASSERT_EQ(now.exit_code, 0) << now.errors;
  EXPECT_EQ(now.errors, "");
  ASSERT_EQ(once.exit_code, 0) << once.errors;
  EXPECT_THAT(once.errors, HasSubstr("note: synth:" + path + " is a scenario; write sim:" + path));
  EXPECT_EQ(read_file(folder / "a.csv"), read_file(folder / "b.csv"));
}

TEST(Sources, OfDevicesAreNoRecordings) {
  const std::string profile = testing_support::source_path("/hal/profiles/condyle_facebow.toml");
  const CommandResult device = run_condyle({"replay", "usb:" + profile});
  EXPECT_EQ(device.exit_code, 2);
  EXPECT_THAT(device.errors, HasSubstr("is a device, not a recording; record it first: condyle "
                                       "record --profile '" +
                                       profile + "' --backend libusb --out session.mcap"));
  const CommandResult made_up = run_condyle({"replay", "synth:" + profile});
  EXPECT_EQ(made_up.exit_code, 2);
  EXPECT_THAT(made_up.errors, HasSubstr("is a synthetic device, which never ends"));
}

TEST(Friction, DrawsItsTextbookFigures) {
  const TemporaryFolder folder;
  const CommandResult result = run_condyle({"friction", "--figures", folder / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  for (const char* name : {"stribeck_curve", "stick_slip", "hysteresis", "break_away"}) {
    EXPECT_THAT(read_file(folder / ("figures/" + std::string(name) + ".svg")),
                testing::AllOf(HasSubstr("research use only"), HasSubstr("</svg>")));
  }
}

TEST(Simulate, RefusesBadInput) {
  const TemporaryFolder folder;
  for (const auto& [text, words] :
       {std::pair{"[subject]\nmass_kg = -1\n", "mass_kg = -1 is out of range"},
        std::pair{"duration_s = 0\n", "duration_s = 0 is out of range"},
        std::pair{"[friction]\nmodel = \"coulomb\"\nsmoothing_velocity_m_s = 1e-6\n",
                  "the forces are so stiff"},
        std::pair{"[task]\namplitude_m = 0.06\n", "the task reaches -61.0 mm, but this jaw"},
        std::pair{"[facebow]\njitter_s = 0.01\n", "more than a fifth of the sampling period"},
        std::pair{"[head]\nrate_Hz = 120\n", "the head's acceleration drives a point_mass only"},
        std::pair{"colour = \"red\"\n", "unknown key 'colour'"}}) {
    const std::string path = folder.write("s.toml", text);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"simulate", path, "--out", folder / "r.csv"},
          {"evaluate", path, "--out", folder / "r.csv"},
          {"replay", "sim:" + path, "--out", folder / "r.csv"}}) {
      const CommandResult result = run_condyle(arguments);
      EXPECT_EQ(result.exit_code, 2);
      EXPECT_THAT(result.errors, HasSubstr(words));
      EXPECT_EQ(folder.count(), 1);
    }
  }
  EXPECT_EQ(run_condyle({"simulate", scenario("chewing"), "--out", "/nowhere/r.csv"}).exit_code, 2);
  const std::string path = folder.write("s.toml", "duration_s = 1\n");
  EXPECT_THAT(run_condyle({"simulate", path, "--out", path}).errors, HasSubstr("is also an input"));
  EXPECT_THAT(
      run_condyle({"simulate", path, "--out", folder / "r", "--truth", folder / "r"}).errors,
      HasSubstr("is given for two outputs"));
  const std::string nothing =
      folder.write("s.toml", "duration_s = 1\n[facebow]\nlost_share = 0.99\nrate_Hz = 5\n");
  for (const char* estimator : {"recommended", "published"}) {
    EXPECT_THAT(run_condyle({"evaluate", nothing, "--estimator", estimator, "--runs", "2"}).errors,
                HasSubstr("no sample of any run could be compared"));
  }
  EXPECT_EQ(run_condyle({"evaluate", scenario("chewing"), "--runs", "1"}).exit_code, 2);
}

}  // namespace
}  // namespace condyle
