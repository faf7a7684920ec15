// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/jaw_scenario_file.h"

#include <gmock/gmock.h>

#include "hosted/files/input_error.h"
#include "simulation/kinematic/kinematic_simulation.h"
#include "simulation/scenario_file.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;

std::string problem_of(const std::string& text) {
  const testing_support::TemporaryFolder folder;
  try {
    const JawScenario scenario = load_jaw_scenario(folder.write("s.toml", text));
    KinematicSimulation(scenario, scenario.seed);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(KinematicScenarioFile, ReadsSubjectTasksAndMounting) {
  const testing_support::TemporaryFolder folder;
  const std::string path = folder.write("mine.toml", R"(
seed = 4
[kinematic]
inclination_deg = 48
[kinematic.right]
progressive_shift_deg = 12
[left]
strokes = 5
advance_mm = 6
[opening]
[chewing]
side = "alternating"
duration_s = 12
[facebow]
rate_Hz = 120
[mounting]
rotation_deg = [0, 90, 0]
moving = "upper"
[landmarks]
condyle_sd_mm = 2
)");
  ASSERT_TRUE(is_jaw_scenario(path));
  const JawScenario scenario = load_jaw_scenario(path);
  EXPECT_EQ(scenario.name, "mine");
  EXPECT_EQ(scenario.seed, 4U);
  EXPECT_EQ(scenario.anatomy.left.inclination_deg, 48);
  EXPECT_EQ(scenario.anatomy.right.inclination_deg, 48);
  EXPECT_EQ(scenario.anatomy.left.progressive_shift_deg, 8);
  EXPECT_EQ(scenario.anatomy.right.progressive_shift_deg, 12);
  ASSERT_EQ(scenario.tasks.size(), 3U);
  EXPECT_EQ(scenario.tasks[0].kind, JawTaskKind::opening);
  EXPECT_EQ(scenario.tasks[0].advance_mm, default_task(JawTaskKind::opening).advance_mm);
  EXPECT_EQ(scenario.tasks[1].kind, JawTaskKind::left);
  EXPECT_EQ(scenario.tasks[1].strokes, 5);
  EXPECT_TRUE(scenario.tasks[2].chewing.alternates);
  EXPECT_EQ(scenario.facebow.rate_Hz, 120);
  EXPECT_EQ(scenario.facebow.noise_rad, kFineNoise_rad);
  EXPECT_EQ(scenario.mounting.rotation_deg[1], 90);
  EXPECT_TRUE(scenario.mounting.is_upper);
  EXPECT_EQ(scenario.landmarks.condyle_sd_mm, 2);
}

TEST(KinematicScenarioFile, NamesPlaceProblemAndMend) {
  const auto expect = [](const char* text, const char* words) {
    EXPECT_THAT(problem_of(text), HasSubstr(words)) << text;
  };
  expect("[kinematic]\n[rest]\n", "no error");
  expect("[kinematic]\n", "s.toml: the jaw has no task; add a section such as [opening]");
  expect("[kinematic]\n[open]\n", "s.toml:2:2: unknown key 'open'");
  expect("[kinematic]\n[opening]\nduration_s = 3\n", "keys of [opening] are strokes");
  expect("[kinematic]\ninclination_deg = 90\n[rest]\n", "give 15 to 70 (deg)");
  expect("[kinematic]\n[opening]\nstrokes = 0\n", "s.toml:3:11: ");
  expect("[kinematic]\n[opening]\nadvance_mm = 24\n", "its path is lowest after");
  expect("[kinematic]\ninclination_deg = 65\ncurvature_per_mm = 0\n[opening]\nadvance_mm = 24\n",
         "moves further than it is from the midline");
  expect("[kinematic]\n[rest]\n[mounting]\nmoving = \"head\"\n", "give \"lower\" or \"upper\"");
  expect("[kinematic]\n[rest]\nduration_s = 1800\n[facebow]\nrate_Hz = 5000\n",
         "more than memory may hold");
  expect("[kinematic]\n[rest]\n[facebow]\njitter_s = 0.05\n", "a fifth of the sampling period");
}

TEST(KinematicScenarioFile, IsNoScenarioOfForces) {
  const std::string path =
      testing_support::source_path("/host_sim/scenarios/clinical_session.toml");
  EXPECT_THROW(load_scenario(path), InputError);
  EXPECT_FALSE(is_jaw_scenario(testing_support::source_path("/host_sim/scenarios/chewing.toml")));
}

TEST(KinematicScenarioFile, ClinicalSessionsHaveAllTasks) {
  for (const char* name : {"clinical_session", "clinical_session_coarse"}) {
    const JawScenario scenario =
        load_jaw_scenario(testing_support::source_path("/host_sim/scenarios/") + name + ".toml");
    EXPECT_GE(scenario.tasks.size(), 6U);
    EXPECT_GT(true_cycles(KinematicJaw(scenario)).size(), 10U);
  }
}

}  // namespace
}  // namespace condyle::host
