// SPDX-License-Identifier: Apache-2.0
#include "hosted/config/parameter_file.h"

#include <gmock/gmock.h>

#include "hosted/files/input_error.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;

LoadedParameters load(const std::string& text) {
  const TemporaryFolder folder;
  return load_parameters(folder.write("p.toml", text));
}

std::string problem_of(const std::string& text) {
  try {
    load(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParameterFile, LoadsEveryField) {
  std::string text = "sample_time_s = 0.004\nassumed_mass_kg = 0.5\n";
  text += "[motion]\ndiscretisation = \"backward\"\ninitial_variance = [1, 2, 3]\n";
  text += "process_variance = [4.0, 5, 6]\nmeasurement_variance = [7]\n";
  text += "[friction]\ninitial_Ns_m = 0.1\nmeasurement_variance = [8, 9]\n";
  text += "[mass]\ninitial_kg = 0.2\nprocess_variance = [0, 0, 1e-3]\n";
  const LoadedParameters loaded = load(text);
  EXPECT_TRUE(loaded.gives_sample_time);
  const PublishedParameters& p = loaded.values;
  EXPECT_EQ(p.sample_time_s, 0.004);
  EXPECT_EQ(p.assumed_mass_kg, 0.5);
  EXPECT_EQ(p.motion.discretisation, Discretisation::backward);
  EXPECT_THAT(p.motion.initial_variance, testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(p.motion.process_variance, testing::ElementsAre(4, 5, 6));
  EXPECT_THAT(p.motion.measurement_variance, testing::ElementsAre(7));
  EXPECT_EQ(p.friction.initial_Ns_m, 0.1);
  EXPECT_THAT(p.friction.measurement_variance, testing::ElementsAre(8, 9));
  EXPECT_THAT(p.friction.initial_variance, testing::ElementsAre(1e-6, 0.01, 1e-8)) << "default";
  EXPECT_EQ(p.mass.initial_kg, 0.2);
  EXPECT_THAT(p.mass.process_variance, testing::ElementsAre(0, 0, 1e-3));
}

TEST(ParameterFile, TheShippedFileHoldsTheDefaults) {
  const LoadedParameters shipped =
      load_parameters(testing_support::source_path("/host_sim/recordings/chewing_60hz.toml"));
  std::vector<double> values, defaults;
  const auto collect = [](std::vector<double>& into) {
    return [&into](const char*, const char*, const double* v, std::size_t n, const char*, Range) {
      into.insert(into.end(), v, v + n);
    };
  };
  PublishedParameters expected;
  expected.sample_time_s = 1.0 / 60;
  visit_fields(shipped.values, collect(values));
  visit_fields(expected, collect(defaults));
  EXPECT_EQ(values, defaults);
  EXPECT_EQ(shipped.values.motion.discretisation, expected.motion.discretisation);
}

TEST(ParameterFile, AnEmptyFileGivesDefaults) {
  EXPECT_FALSE(load("").gives_sample_time);
}

TEST(ParameterFile, NamesPlaceProblemAndMend) {
  EXPECT_THAT(problem_of("sample_time = 1\n"),
              testing::AllOf(HasSubstr("p.toml:1:1: unknown key 'sample_time'"),
                             HasSubstr("sample_time_s, assumed_mass_kg")));
  EXPECT_THAT(problem_of("\n[motion]\nprocess = 1\n"),
              testing::AllOf(HasSubstr(":3:1: unknown key 'process'"), HasSubstr("[motion] are")));
  EXPECT_THAT(problem_of("[spring]\nk = 1\n"), HasSubstr("unknown key 'spring'"));
  EXPECT_THAT(problem_of("[motion]\nprocess_variance = [1e-12, -1e-8, 2e-3]\n"),
              testing::AllOf(HasSubstr(":2:28: process_variance = -1e-08 is out of range"),
                             HasSubstr("give 0 to")));
  EXPECT_THAT(problem_of("[mass]\nmeasurement_variance = [0, 1]\n"), HasSubstr("out of range"));
  EXPECT_THAT(problem_of("assumed_mass_kg = nan\n"), HasSubstr("out of range"));
  EXPECT_THAT(problem_of("assumed_mass_kg = inf\n"), HasSubstr("out of range"));
  EXPECT_THAT(problem_of("assumed_mass_kg = \"heavy\"\n"),
              HasSubstr(":1:19: assumed_mass_kg takes"));
  EXPECT_THAT(problem_of("assumed_mass_kg = [1]\n"), HasSubstr("takes one number"));
  EXPECT_THAT(problem_of("[friction]\ninitial_variance = [1, 2]\n"),
              HasSubstr("array of 3 numbers"));
  EXPECT_THAT(problem_of("[friction]\ninitial_variance = 1\n"), HasSubstr("array of 3 numbers"));
  EXPECT_THAT(problem_of("[motion]\ndiscretisation = \"midpoint\"\n"), HasSubstr("\"forward\""));
  EXPECT_THAT(problem_of("[motion]\ndiscretisation = 1\n"), HasSubstr("\"forward\""));
  EXPECT_THAT(problem_of("motion = 1\n"), HasSubstr("motion is a section"));
  EXPECT_THAT(problem_of("a = = 1\n"), HasSubstr("p.toml:1:"));
  EXPECT_THAT(problem_of(std::string("\x00\xff\xfe", 3)), HasSubstr("p.toml:1:"));
  EXPECT_THROW(load_parameters("/nowhere/p.toml"), InputError);
}

}  // namespace
}  // namespace condyle::host
