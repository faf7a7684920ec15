// SPDX-License-Identifier: Apache-2.0
// protocol head-motion and plan-head-motion as a user runs them, on a simulated jaw in a head that
// nods.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/head_motion_samples.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::HeadMotionTruth;
using testing_support::NoddingHead;
using testing_support::read_file;
using testing_support::run_condyle;

class HeadMotionCommand : public testing::Test {
 protected:
  // 30 s of positions at 60 Hz and accelerations at 120 Hz, these stamped 20 ms late; or all of it
  // at 60 Hz in one file.
  void record(const HeadMotionTruth& truth, unsigned seed, bool is_apart = true) {
    constexpr int kTicks = 3600;
    NoddingHead head(truth, is_apart ? 120 : 60, seed);
    std::string positions =
        is_apart ? "time_s,position_m\n" : "time_s,position_m,acceleration_m_s2\n";
    std::string accelerations = "time_s,acceleration_m_s2\n";
    for (int i = 0; i < (is_apart ? kTicks : kTicks / 2); ++i) {
      const auto sample = head.next();
      if (!is_apart) {
        positions += fmt::format("{:.9f},{:.9f},{:.9f}\n", 5 + i / 60.0, sample.position_m,
                                 sample.acceleration_m_s2);
        continue;
      }
      accelerations += fmt::format("{:.9f},{:.9f}\n", 5.02 + i / 120.0, sample.acceleration_m_s2);
      if (i % 2 == 0) positions += fmt::format("{:.9f},{:.9f}\n", 5 + i / 120.0, sample.position_m);
    }
    folder_.write("jaw.csv", positions);
    folder_.write("head.csv", accelerations);
  }
  CommandResult identify(std::vector<std::string> more = {}, bool is_apart = true) {
    std::vector<std::string> arguments = {"protocol", "head-motion", jaw_};
    if (is_apart) {
      arguments.insert(arguments.end(), {"--acceleration", head_, "--acceleration-delay-ms", "20"});
    }
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_condyle(arguments);
  }
  static bool holds(const nlohmann::json& value, double truth) {
    return value["low_95"].get<double>() < truth && truth < value["high_95"].get<double>();
  }

  testing_support::TemporaryFolder folder_;
  std::string jaw_ = folder_ / "jaw.csv", head_ = folder_ / "head.csv";
  const std::vector<std::string> relaxed_ = {"--muscle-share", "0", "--acceleration-delay-sd-ms",
                                             "0.2"};
};

TEST_F(HeadMotionCommand, MeasuresTheRatiosAndNoMass) {
  for (const bool is_apart : {true, false}) {
    record({}, 1, is_apart);
    auto more = relaxed_;
    more.insert(more.end(), {"--out", folder_ / "v.json", "--figures", folder_ / "figures"});
    const auto result = identify(more, is_apart);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.output,
                AllOf(HasSubstr("research use only"), HasSubstr("95 %:"), HasSubstr("measured"),
                      HasSubstr("mass cancels and is not determined"),
                      HasSubstr("relaxed jaw is assumed"), Not(HasSubstr("NOT KNOWN"))));
    const auto json = nlohmann::json::parse(read_file(folder_ / "v.json"));
    EXPECT_TRUE(holds(json["damping_rate_per_s"], 8)) << json;
    EXPECT_TRUE(holds(json["stiffness_per_mass_per_s2"], 400)) << json;
    EXPECT_EQ(json["damping_rate_per_s"]["provenance"], "measured");
    EXPECT_LT(json["damping_rate_per_s"]["standard_deviation"], 0.1);
    EXPECT_FALSE(json.contains("mass_kg"));
    EXPECT_THAT(read_file(folder_ / "figures/head_motion.svg"), HasSubstr("research use only"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "figures/head_motion.png"));
  }
}

TEST_F(HeadMotionCommand, WithholdsWhatMusclesOrTheDelayMayMake) {
  record({}, 2);
  const auto result = identify({"--out", folder_ / "v.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("muscles not known"), HasSubstr("kv/m                NOT"),
                    HasSubstr("ks/m                NOT"), HasSubstr("muscles may add too much")));
  const auto json = nlohmann::json::parse(read_file(folder_ / "v.json"));
  for (const char* key : {"value", "standard_deviation", "low_95", "high_95"}) {
    EXPECT_TRUE(json["damping_rate_per_s"][key].is_null()) << key;
  }
  EXPECT_EQ(json["damping_rate_per_s"]["limit"], "missing");
  EXPECT_THAT(identify({"--muscle-share", "0"}).output,
              HasSubstr("uncertainty of the acceleration's delay is too large"));
}

// Bursts of a muscle, said to be none.
TEST_F(HeadMotionCommand, FindsOutAMuscleThatDoesNotMoveAsTheModel) {
  HeadMotionTruth truth;
  truth.muscles = [](double, double v, double) { return v > 0 ? 0.3 : -0.3; };
  record(truth, 3);
  const auto result = identify(relaxed_);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("kv/m                NOT KNOWN"),
                                   HasSubstr("such as Coulomb friction or bursts of a muscle")));
}

TEST_F(HeadMotionCommand, SaysWhatItCannotUse) {
  record({}, 4);
  const auto refuse = [](const CommandResult& result, const char* words) {
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_EQ(result.output, "");
  };
  refuse(identify({}, false), "has no acceleration");
  refuse(run_condyle({"protocol", "head-motion", jaw_, "--acceleration", jaw_}),
         "no column acceleration_m_s2");
  refuse(run_condyle({"protocol", "head-motion", jaw_, "--acceleration", folder_ / "none.csv"}),
         "none.csv");
  refuse(identify({"--begin-s", "3", "--end-s", "2"}), "is not after the start");
  refuse(identify({"--begin-s", "100"}), "none of its positions has accelerations");
  refuse(identify({"--out", jaw_}), "is also an input");
  refuse(identify({"--point", "2"}), "has one point");
  refuse(identify({"--axis", "x"}), "has one axis");
  const std::string elsewhere =
      folder_.write("late.csv", "time_s,acceleration_m_s2\n100,1\n100.1,2\n");
  refuse(run_condyle({"protocol", "head-motion", jaw_, "--acceleration", elsewhere,
                      "--acceleration-noise-m-s2", "0.05"}),
         "none of its positions has accelerations");
  const std::string repeated =
      folder_.write("twice.csv", "time_s,acceleration_m_s2\n5,1\n5.1,2\n5.1,2\n");
  refuse(run_condyle({"protocol", "head-motion", jaw_, "--acceleration", repeated}),
         "twice.csv:4: time does not increase");
  EXPECT_THAT(identify({"--noise-mm", "0.5"}).output, HasSubstr("(0.5 stated: smoothed, or not"));
  EXPECT_EQ(identify({"--muscle-share", "2"}).exit_code, 2);
  EXPECT_EQ(identify({"--noise-mm", "nan"}).exit_code, 2);

  const auto result = identify({"--muscle-share", "0", "--end-s", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("NOT KNOWN: too short; record"));
}

TEST(HeadMotionPlanCommand, PrintsDeviationsAndTheDuration) {
  const auto plan = [](std::vector<std::string> more) {
    std::vector<std::string> arguments = {"protocol", "plan-head-motion",
                                          "--acceleration-delay-sd-ms", "0.2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_condyle(arguments);
  };
  const auto result = plan({"--wanted-damping-rate-sd-per-s", "0.1"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("Research use only"), HasSubstr("Cramer-Rao"),
                                   HasSubstr("\n30 "), HasSubstr("For kv/m to +- 0.1 1/s: 12")));
  EXPECT_THAT(plan({"--wanted-damping-rate-sd-per-s", "0.001"}).output,
              HasSubstr("no duration suffices"));
  EXPECT_EQ(plan({"--rate-Hz", "0"}).exit_code, 2);
}

}  // namespace
}  // namespace condyle
