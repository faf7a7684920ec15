// SPDX-License-Identifier: Apache-2.0
// evaluate: as a user runs it, and against errors that are computed here from the files that
// simulate and replay write.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::Interrupt;
using testing_support::read_file;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;
using testing_support::TemporaryFolder;

std::string scenario(const std::string& name) {
  return testing_support::source_path("/host_sim/scenarios/") + name + ".toml";
}

// A column of evaluate's table by quantity; NaN for an empty field.
std::map<std::string, double> by_quantity(const Table& table, const std::string& column) {
  std::map<std::string, double> values;
  const auto numbers = table.numbers(column);
  for (std::size_t i = 0; i < table.rows; ++i) {
    values[table.columns.at("quantity")[i]] = numbers[i];
  }
  return values;
}

// The slope that the report gives for `quantity`.
double slope_in(const std::string& output, const std::string& quantity) {
  const std::string words = "d(estimate)/d(truth) = ";
  for (std::size_t i = 0; (i = output.find(words, i)) != std::string::npos; i += words.size()) {
    const std::size_t line = output.rfind('\n', i) + 1;
    if (output.compare(line, quantity.size(), quantity) == 0) {
      return std::strtod(output.c_str() + i + words.size(), nullptr);
    }
  }
  ADD_FAILURE() << output;
  return 1e9;
}

// What the text says after `label` at the start of a line.
std::string line_of(const std::string& output, const std::string& label) {
  const std::size_t start = output.find("\n" + label) + 1;
  return start == 0 ? std::string() : output.substr(start, output.find('\n', start) - start);
}

// Lost, repeated and thrown-off samples, so that rows, samples and instants cannot be mixed up.
constexpr double kDuration_s = 12;
constexpr const char* kFaulty =
    "duration_s = 12\n[subject]\nmotion = \"point_mass\"\nmass_kg = 0.4\n"
    "support_stiffness_N_m = 20\nsupport_rest_m = -0.01\n"
    "[task]\nrest_position_m = 0.0\namplitude_m = 0.015\ncycle_rate_Hz = 1.3\n"
    "[friction]\nviscous_Ns_m = 0.022\n"
    "[facebow]\nlost_share = 0.03\nrepeated_share = 0.03\nglitch_share = 0.01\n";

struct Errors {
  double square = 0, sum = 0, covered = 0, count = 0;
};

// Errors of one run from its files: each row against the truth at the row's time_s.
std::map<std::string, Errors> errors_of(const Table& estimates, const Table& truth) {
  std::map<std::string, std::size_t> row_at;
  for (std::size_t i = 0; i < truth.rows; ++i) row_at[truth.columns.at("time_s")[i]] = i;
  const auto true_times = truth.numbers("time_s");
  const auto true_acceleration = truth.numbers("acceleration_m_s2");
  const auto true_mass = truth.numbers("effective_mass_kg");
  std::vector<double> true_force;
  for (std::size_t i = 0; i < truth.rows; ++i) {
    true_force.push_back(true_mass[i] * true_acceleration[i]);
  }
  std::map<std::string, Errors> result;
  const auto compare = [&](const char* quantity, const std::string& name, const std::string& unit,
                           const std::vector<double>& true_values) {
    if (estimates.columns.count(name + unit) == 0) return;
    const auto values = estimates.numbers(name + unit);
    const auto deviations = estimates.numbers(name + "_sd" + unit);
    Errors& errors = result[quantity];
    for (std::size_t i = 0; i < estimates.rows; ++i) {
      const std::size_t at = row_at.at(estimates.columns.at("time_s")[i]);
      if (true_times[at] < 0.2 * kDuration_s || std::isnan(values[i])) continue;
      const double error = values[i] - true_values[at];
      errors.square += error * error;
      errors.sum += error;
      errors.covered += std::abs(error) <= 1.959963984540054 * deviations[i] ? 1 : 0;
      ++errors.count;
    }
  };
  compare("position", "position", "_m", truth.numbers("position_m"));
  compare("velocity", "velocity", "_m_s", truth.numbers("velocity_m_s"));
  compare("acceleration", "acceleration", "_m_s2", true_acceleration);
  compare("force", "force", "_N", true_force);
  return result;
}

struct Choice {
  const char* name;
  std::vector<std::string> options;
};

class EvaluateAgainstFiles : public testing::TestWithParam<Choice> {};
INSTANTIATE_TEST_SUITE_P(Estimators, EvaluateAgainstFiles,
                         testing::Values(Choice{"recommended", {}}, Choice{"lag_1", {"--lag", "1"}},
                                         Choice{"lag_10", {"--lag", "10"}},
                                         Choice{"published", {"--estimator", "published"}}),
                         [](const auto& test) { return test.param.name; });

// Compared one sample too early or late, the position would be off by most of a millimetre.
TEST_P(EvaluateAgainstFiles, ErrorsAreThoseOfTheRowsAtTheirTimes) {
  const TemporaryFolder folder;
  const std::string path = folder.write("faulty.toml", kFaulty);
  const auto run = [&](std::vector<std::string> arguments, bool with_estimator) {
    if (with_estimator) {
      arguments.insert(arguments.end(), GetParam().options.begin(), GetParam().options.end());
    }
    const CommandResult result = run_condyle(arguments);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  };
  std::map<std::string, Errors> means;  // each run counts once
  for (const char* seed : {"7", "8"}) {
    run({"simulate", path, "--seed", seed, "--out", folder / "r.csv", "--truth", folder / "t.csv"},
        false);
    run({"replay", folder / "r.csv", "--out", folder / "e.csv"}, true);
    for (const auto& [name, errors] :
         errors_of(read_table(folder / "e.csv"), read_table(folder / "t.csv"))) {
      ASSERT_GT(errors.count, 500) << name;
      means[name].square += errors.square / errors.count / 2;
      means[name].sum += errors.sum / errors.count / 2;
      means[name].covered += errors.covered / errors.count / 2;
    }
  }
  run({"evaluate", path, "--seed", "7", "--runs", "2", "--out", folder / "table.csv"}, true);
  const Table table = read_table(folder / "table.csv");
  EXPECT_LT(by_quantity(table, "error_rms").at("position"), 3e-4);
  for (const auto& [name, mean] : means) {
    const double rms = std::sqrt(mean.square);
    EXPECT_NEAR(by_quantity(table, "error_rms").at(name), rms, 1e-5 * rms) << name;
    EXPECT_NEAR(by_quantity(table, "bias").at(name), mean.sum, 1e-5 * rms) << name;
    EXPECT_NEAR(by_quantity(table, "coverage").at(name), mean.covered, 2e-3) << name;
  }
}

TEST(Evaluate, TheRecommendedEstimatorIsTheDefaultAndSaysNothingOfFrictionAndMass) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_condyle({"evaluate", scenario("point_mass"), "--runs", "6", "--friction-factors", "1,22",
                   "--figures", folder / "figures", "--out", folder / "table.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("recommended estimator, lag 0 samples, assumed mass 0.25 kg, "
                              "learning with 96 kernels; simulated subjects, research use "
                              "only"),
                    HasSubstr("ASSUMED mass times acceleration"), Not(HasSubstr("matched")),
                    Not(HasSubstr("response slope")), Not(HasSubstr("d(estimate)")),
                    Not(HasSubstr("to bound"))));
  for (const char* axis : {"NIS x", "NIS y", "NIS z", "whiteness   x ", "events "}) {
    EXPECT_NE(line_of(result.output, axis), "") << axis;
  }
  const Table table = read_table(folder / "table.csv");
  ASSERT_EQ(table.rows, 6U);
  for (const char* name : {"friction", "mass"}) {
    EXPECT_THAT(line_of(result.output, name), HasSubstr("not estimated"));
    for (const char* column : {"error_rms", "bias", "coverage"}) {
      EXPECT_TRUE(std::isnan(by_quantity(table, column).at(name))) << name << column;
    }
  }
  EXPECT_GT(by_quantity(table, "coverage").at("velocity"), 0.9);
  EXPECT_TRUE(std::isnan(by_quantity(table, "ratio_to_bound").at("position")));
  EXPECT_THAT(read_file(folder / "figures/velocity_error.svg"), HasSubstr("research use only"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "figures"), {}), 2)
      << "no response of what is not estimated";
}

TEST(Evaluate, ALagMakesTheMotionBetter) {
  const TemporaryFolder folder;
  const auto errors = [&](const char* lag) {
    const CommandResult result = run_condyle({"evaluate", scenario("chewing"), "--runs", "2",
                                              "--lag", lag, "--out", folder / "table.csv"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.output, HasSubstr("lag " + std::string(lag) + " samples"));
    return by_quantity(read_table(folder / "table.csv"), "error_rms");
  };
  auto now = errors("0"), later = errors("10");
  for (const char* name : {"position", "velocity", "acceleration"}) {
    EXPECT_LT(later[name], 0.8 * now[name]) << name;
  }
}

// The force is wrong by what the assumed mass is wrong, and the report does not hide it.
TEST(Evaluate, TheForceIsHeldAgainstTheTruth) {
  const TemporaryFolder folder;
  const auto force = [&](const char* mass_factor) {
    EXPECT_EQ(run_condyle({"evaluate", scenario("prescribed"), "--runs", "2", "--lag", "10",
                           "--mass-factors", mass_factor, "--out", folder / "table.csv"})
                  .exit_code,
              0);
    return read_table(folder / "table.csv");
  };
  const Table light = force("1"), heavy = force("4");
  EXPECT_GT(by_quantity(heavy, "error_rms").at("force"),
            3 * by_quantity(light, "error_rms").at("force"));
  EXPECT_LT(by_quantity(heavy, "coverage").at("force"), 0.5);
  EXPECT_NEAR(by_quantity(heavy, "error_rms").at("acceleration"),
              by_quantity(light, "error_rms").at("acceleration"),
              0.2 * by_quantity(light, "error_rms").at("acceleration"));
}

// Under the same drive, friction 22 times as large does not show; the mass returns is the assumed
// one.
TEST(Evaluate, ThePublishedCascadeFollowsNeitherFrictionNorMass) {
  const TemporaryFolder folder;
  const CommandResult friction =
      run_condyle({"evaluate", scenario("point_mass"), "--estimator", "published", "--runs", "20",
                   "--friction-factors", "1,22", "--figures", folder / "figures", "--out",
                   folder / "table.csv"});
  ASSERT_EQ(friction.exit_code, 0) << friction.errors;
  EXPECT_LT(std::abs(slope_in(friction.output, "friction")), 0.05);
  EXPECT_THAT(friction.output, HasSubstr("20 matched"));
  const auto table = read_table(folder / "table.csv");
  EXPECT_LT(std::abs(by_quantity(table, "bias").at("mass")), 0.02 * 0.25) << "the assumed mass";
  EXPECT_LT(by_quantity(table, "coverage").at("friction"), 0.05)
      << "and its friction's interval misses the truth";
  for (const char* name : {"position", "velocity", "acceleration", "force"}) {
    EXPECT_GT(by_quantity(table, "ratio_to_bound").at(name), 0) << name;
  }
  for (const char* name : {"NEES", "NIS", "whiteness", "events"}) {
    EXPECT_NE(line_of(friction.output, name), "") << name;
  }
  for (const char* name : {"friction_response", "velocity_error"}) {
    EXPECT_THAT(read_file(folder / ("figures/" + std::string(name) + ".svg")),
                AllOf(HasSubstr("research use only"), HasSubstr("</svg>")));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "figures/mass_response.svg"));
  const CommandResult mass = run_condyle({"evaluate", scenario("prescribed"), "--estimator",
                                          "published", "--runs", "20", "--mass-factors", "0.5,2"});
  ASSERT_EQ(mass.exit_code, 0) << mass.errors;
  EXPECT_LT(std::abs(slope_in(mass.output, "mass")), 0.05);
}

// The response slope is 1 where the whole drive is measured; where it is computed from the
// position, nothing is shown, however small the covariance.
TEST(Evaluate, FrictionAndMassRespondOnlyToAMeasuredDrive) {
  std::vector<std::string> arguments = {"evaluate",
                                        scenario("point_mass"),
                                        "--runs",
                                        "20",
                                        "--friction-factors",
                                        "0,22.7",
                                        "--drive-missing",
                                        "0",
                                        "--drive-delay-sd-ms",
                                        "0.5"};
  const auto measured = run_condyle(arguments);
  ASSERT_EQ(measured.exit_code, 0) << measured.errors;
  EXPECT_NEAR(slope_in(measured.output, "friction"), 1, 0.02);
  for (const char* quantity : {"friction    shown", "mass        shown"}) {
    EXPECT_THAT(line_of(measured.output, quantity), HasSubstr("in 20 of 20 runs"));
  }
}

// Any sharding, in any order, with and without a drive: the bytes of one computer.
TEST(Evaluate, ShardsMergeToTheBytesOfOneRun) {
  const TemporaryFolder folder;
  const auto without_names = [](std::string text, const std::string& name) {
    for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name)) {
      text.erase(at, name.size());
    }
    return text;
  };
  const std::vector<std::vector<std::string>> choices = {
      {scenario("point_mass"), "--runs", "7", "--friction-factors", "1,3"},
      {scenario("point_mass"), "--runs", "5", "--estimator", "published"},
      {scenario("chin_load"), "--runs", "4", "--drive-missing", "0", "--lag", "3"}};
  for (const auto& choice : choices) {
    const auto run = [&](std::vector<std::string> more) {
      more.insert(more.begin(), choice.begin(), choice.end());
      more.insert(more.begin(), "evaluate");
      const CommandResult result = run_condyle(more);
      EXPECT_EQ(result.exit_code, 0) << result.errors;
      return result;
    };
    const std::string one = folder / "one.csv", merged = folder / "merged.csv";
    const CommandResult whole = run({"--out", one});
    for (const int count : {1, 3, 4}) {
      std::vector<std::string> merge = {"evaluate", "merge", "--out", merged};
      for (int shard = count; shard > 0; --shard) {
        merge.push_back(folder / ("shard" + std::to_string(shard)));
        run({"--shard", std::to_string(shard) + "/" + std::to_string(count), "--out",
             merge.back()});
        EXPECT_THAT(read_file(merge.back()), Not(HasSubstr(folder.path().string())));
      }
      const CommandResult result = run_condyle(merge);
      ASSERT_EQ(result.exit_code, 0) << result.errors;
      EXPECT_EQ(read_file(merged), read_file(one));
      EXPECT_EQ(without_names(result.output, merged), without_names(whole.output, one));
    }
  }
}

TEST(Evaluate, MergesNothingThatDoesNotBelongTogether) {
  const TemporaryFolder folder;
  const auto shard = [&](const std::string& name, const char* part, const char* seed) {
    const CommandResult result =
        run_condyle({"evaluate", scenario("point_mass"), "--runs", "4", "--seed", seed, "--shard",
                     part, "--out", folder / name});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return folder / name;
  };
  const std::string first = shard("a", "1/2", "1"), second = shard("b", "2/2", "1"),
                    other = shard("c", "2/2", "9");
  const auto expect_refused = [&](std::vector<std::string> files, const char* words) {
    files.insert(files.begin(), {"evaluate", "merge", "--out", folder / "merged.csv"});
    const CommandResult result = run_condyle(files);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(folder / "merged.csv"));
  };
  expect_refused({first}, "one of 2 shards");
  expect_refused({first, first}, "is shard 1, as is");
  expect_refused({first, other}, "belongs to another evaluation");
  expect_refused({}, "no file is given");
  // Damage at any place is found, or changes nothing that is merged.
  const std::string text = read_file(second);
  expect_refused({first, folder.write("cut", text.substr(0, text.size() / 2))}, "damaged");
  expect_refused({first, folder.write("more", text + "1 2\n")}, "more runs");
  expect_refused({first, folder.write("none", "")}, "is not a shard");
  expect_refused({scenario("chewing"), first}, "is not a shard");
}

TEST(Evaluate, StopsWhenInterrupted) {
  const CommandResult result = run_condyle({"evaluate", scenario("chewing"), "--runs", "100000"},
                                           {.interrupt = Interrupt::once_it_can_be});
  EXPECT_EQ(result.exit_code, 130);
}

TEST(Evaluate, RefusesWhatTheEstimatorHasNot) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](std::vector<std::string> more, const char* words) {
    more.insert(more.begin(), {"evaluate", scenario("point_mass"), "--out", folder / "table.csv"});
    const CommandResult result = run_condyle(more);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(folder / "table.csv"));
  };
  expect_refused({"--lag", "17"}, "--lag");
  expect_refused({"--lag", "-1"}, "--lag");
  expect_refused({"--estimator", "best"}, "--estimator");
  expect_refused({"--lag", "3", "--estimator", "published"},
                 "--lag: is not supported by --estimator published");
  expect_refused({"--parameters", folder.write("p.toml", "sample_time_s = 0.02\n")},
                 "belongs to the published estimator's parameters");
  expect_refused({"--estimator", "published", "--parameters", folder.write("q.toml", "[noise]\n")},
                 "belongs to the recommended estimator's parameters");
  const std::string slow = folder.write("s.toml", "duration_s = 20\n[facebow]\nrate_Hz = 1\n");
  EXPECT_THAT(run_condyle({"evaluate", slow}).errors,
              HasSubstr("its step of 1 s is longer than longest_gap_s"));
}

}  // namespace
}  // namespace condyle
