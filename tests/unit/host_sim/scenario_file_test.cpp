// SPDX-License-Identifier: Apache-2.0
#include "simulation/scenario_file.h"

#include <gmock/gmock.h>

#include "hosted/files/input_error.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;

std::string problem_of(const std::string& text) {
  const testing_support::TemporaryFolder folder;
  try {
    load_scenario(folder.write("s.toml", text));
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ScenarioFile, AnEmptyFileIsAScenario) {
  EXPECT_EQ(problem_of(""), "no error");
}

TEST(ScenarioFile, NamesPlaceProblemAndMend) {
  const auto expect = [](const char* text, const char* words) {
    EXPECT_THAT(problem_of(text), HasSubstr(words)) << text;
  };
  expect("durations_s = 3\n",
         "s.toml:1:1: unknown key 'durations_s'; keys here are duration_s, seed");
  expect("[fud]\n", "unknown key 'fud'");
  expect("[food]\nsize_m = 1\n", "keys of [food] are height_m");
  expect("duration_s = 0\n", "duration_s = 0 is out of range; give 0.1 to 86400 (s)");
  expect("duration_s = 31557600\n", "is out of range");
  expect("duration_s = nan\n", "is out of range");
  expect("seed = 1.5\n", "s.toml:1:8: is not a whole number");
  expect("[subject]\nmass_kg = -0.2\n", "s.toml:2:11: mass_kg = -0.2 is out of range");
  expect("[subject]\nmass_kg = \"0.2 kg\"\n", "mass_kg takes numbers; give them in kg");
  expect("[subject]\njaw = \"horse\"\n", "give \"artisynth\" or \"anybody\"");
  expect("[subject]\nmotion = \"point_mass\"\n", "no error");
  expect("[subject]\nmotion = \"point_mass\"\ndrive = \"muscles\"\n", "does not match this motion");
  expect("[subject]\ndrive = \"prescribed\"\n", "does not match this motion");
  expect("[muscle_anterior_digastric]\nmaximum_force_N = -1\n", "is out of range");
  expect("[friction]\nmodel = \"stribeck\"\nstatic_N = 0.5\n", "static_N is below coulomb_N");
  expect("[friction]\nchange = \"ramp\"\nchange_start_s = 5\nchange_end_s = 5\n",
         "ends before it starts");
  expect("[facebow]\nrate_Hz = 0\n", "rate_Hz = 0 is out of range");
  expect("[task]\namplitude_m = 40\n", "amplitude_m = 40 is out of range; give 0 to 0.06 (m)");
}

TEST(ScenarioFile, ChangesTheTabulatedSubject) {
  const testing_support::TemporaryFolder folder;
  const Scenario s = load_scenario(folder.write(
      "mine.toml",
      "[subject]\njaw = \"anybody\"\nmass_kg = 0.3\n[muscle_geniohyoid]\nmaximum_force_N = 55\n"));
  EXPECT_EQ(s.name, "mine");
  EXPECT_EQ(s.subject.jaw.mass_kg, 0.3);
  EXPECT_EQ(s.subject.jaw.inertia_kg_m2, 4.2e-3);
  EXPECT_EQ(s.subject.jaw.muscles.back().maximum_force_N, 55);
  EXPECT_EQ(s.subject.jaw.muscles.size(), kMostMuscles);
}

}  // namespace
}  // namespace condyle::host
