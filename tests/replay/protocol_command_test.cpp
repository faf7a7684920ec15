// SPDX-License-Identifier: Apache-2.0
// protocol: plans, fits and combines passive releases, as a user runs it, on simulated recordings.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/command.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

// A jaw held open and let go at 0.2 s.
struct Subject {
  double mass_kg = 0.25, stiffness_N_m = 100, friction_Ns_m = 2, rest_m = -0.002;
  double opening_m = 0.01;
};

// Simulates its recording, with a facebow that does not rotate, and returns the path.
std::string record(const TemporaryFolder& folder, const std::string& name, const Subject& subject,
                   int seed, const std::string& more = "") {
  const std::string scenario = folder.write(
      name + ".toml",
      fmt::format("duration_s = 1.2\n[subject]\nmotion = \"point_mass\"\ndrive = \"released\"\n"
                  "mass_kg = {}\nsupport_stiffness_N_m = {}\nsupport_rest_m = {}\n"
                  "release_s = 0.2\n[task]\nrest_position_m = {}\namplitude_m = {}\n"
                  "[friction]\nviscous_Ns_m = {}\n{}",
                  subject.mass_kg, subject.stiffness_N_m, subject.rest_m, subject.rest_m,
                  subject.opening_m, subject.friction_Ns_m, more));
  const std::string path = folder / (name + ".csv");
  const auto result =
      run_condyle({"simulate", scenario, "--out", path, "--seed", std::to_string(seed)});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  return path;
}

nlohmann::json read_json(const std::string& path) {
  return nlohmann::json::parse(read_file(path));
}

bool holds(const nlohmann::json& value, double truth) {
  return value["low_95"].get<double>() < truth && truth < value["high_95"].get<double>();
}

TEST(ProtocolPlan, PrintsTheBoundAndTheEffort) {
  const auto result = run_condyle({"protocol", "plan-release", "--damping-rate-per-s", "40",
                                   "--wanted-damping-rate-sd-per-s", "0.5"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("\n0.6         1.63 "), HasSubstr("Cramer-Rao"),
                    HasSubstr("the mean of 10 releases"), HasSubstr("Research use only")));
  const auto single = run_condyle({"protocol", "plan-release", "--damping-rate-per-s", "8",
                                   "--wanted-damping-rate-sd-per-s", "0.06"});
  EXPECT_THAT(single.output, HasSubstr("one release of "));
  const auto strong = run_condyle({"protocol", "plan-release", "--damping-rate-per-s", "80"});
  EXPECT_THAT(strong.output, HasSubstr("give no upper end"));
  const auto short_one = run_condyle({"protocol", "plan-release", "--duration-s", "0.05"});
  EXPECT_THAT(short_one.output, HasSubstr("Too few samples"));
}

TEST(ProtocolRelease, FindsTheReleaseAndItsValues) {
  const TemporaryFolder folder;
  const std::string path = record(folder, "release", {}, 1);
  const auto result = run_condyle({"protocol", "release", path, "--noise-mm", "0.05", "--out",
                                   folder / "r.json", "--figures", folder / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("research use only"), HasSubstr("start found"), HasSubstr("(sd "),
                    HasSubstr("measured"), HasSubstr("as stated")));
  const auto json = read_json(folder / "r.json");
  EXPECT_TRUE(holds(json["damping_rate_per_s"], 8));
  EXPECT_TRUE(holds(json["stiffness_per_mass_per_s2"], 400));
  EXPECT_TRUE(holds(json["damping_ratio"], 0.2));
  EXPECT_TRUE(holds(json["natural_frequency_rad_s"], 20));
  EXPECT_EQ(json["damping_rate_per_s"]["provenance"], "measured");
  EXPECT_NEAR(json["begin_s"], 0.22, 0.03);
  EXPECT_THAT(read_file(folder / "figures/release.svg"),
              AllOf(HasSubstr("research use only"), HasSubstr("fitted release")));
  EXPECT_TRUE(std::filesystem::exists(folder / "figures/release.png"));
}

// A begin before the hand let go is not a release: found out, nothing measured.
TEST(ProtocolRelease, ABeginTooEarlyIsFoundOut) {
  const TemporaryFolder folder;
  const std::string path = record(folder, "release", {}, 2);
  const auto result = run_condyle(
      {"protocol", "release", path, "--noise-mm", "0.05", "--begin-s", "0.15", "--end-s", "0.75"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("NOTHING IS MEASURED"));
  EXPECT_THAT(result.output, HasSubstr("kv/m                NOT KNOWN"));
  EXPECT_THAT(result.output, Not(HasSubstr(" measured\n")));
}

// A slow hand looks like an overdamped jaw, until the user states when the support was gone.
TEST(ProtocolRelease, AnOverdampedJawNeedsAStatedLetGo) {
  const TemporaryFolder folder;
  const std::string path = record(folder, "release", {.friction_Ns_m = 12}, 4);
  const auto unsaid = run_condyle({"protocol", "release", path, "--noise-mm", "0.05"});
  ASSERT_EQ(unsaid.exit_code, 0) << unsaid.errors;
  EXPECT_THAT(unsaid.output, AllOf(HasSubstr("overdamped"), HasSubstr("--let-go-ms"),
                                   HasSubstr("kv/m                NOT KNOWN")));
  const auto result = run_condyle({"protocol", "release", path, "--noise-mm", "0.05", "--let-go-ms",
                                   "5", "--out", folder / "values.json"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const auto json = read_json(folder / "values.json");
  EXPECT_EQ(json["residuals"], "as stated");
  EXPECT_TRUE(holds(json["damping_rate_per_s"], 48));
  EXPECT_TRUE(holds(json["stiffness_per_mass_per_s2"], 400));
}

TEST(ProtocolRelease, SaysWhatItCannotUse) {
  const TemporaryFolder folder;
  const std::string path = record(folder, "release", {}, 3);
  const auto refuse = [&](std::vector<std::string> arguments, const char* words) {
    arguments.insert(arguments.begin(), "protocol");
    const auto result = run_condyle(arguments);
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_EQ(result.output, "");
  };
  refuse({"release", path, "--begin-s", "0.9", "--end-s", "0.5"}, "is not after the start");
  refuse({"release", path, "--begin-s", "1.15"}, "a fit needs 10");
  refuse({"release", path, "--noise-mm", "0.05", "--begin-s", "0.01", "--end-s", "0.19"},
         "no motion above the noise");
  refuse({"release", folder / "none.csv"}, "none.csv");
  refuse({"release", path, "--out", path}, "is also an input");
  std::string text = "time_s,position_mm\n";
  for (int i = 0; i < 120; ++i) text += fmt::format("{:.6f},{:.6f}\n", i / 60.0, std::sin(0.5 * i));
  refuse({"release", folder.write("moving.csv", text)}, "give --begin-s");
  text = "time_s,position_mm\n";  // opened, held, let go: two motions
  for (int i = 0; i < 180; ++i) {
    const double up = i < 60 ? 0.0 : i < 120 ? 10.0 * (1 - std::exp(-0.2 * (i - 60))) : 1.0;
    text += fmt::format("{:.6f},{:.6f}\n", i / 60.0, up);
  }
  refuse({"release", folder.write("two.csv", text)}, "choose the release with --begin-s");
  refuse({"combine", path, path}, "no load is given");
  refuse({"combine", path, path, "--added-spring-N-m", "10", "--added-weight-N", "1"},
         "cannot be used together");
  EXPECT_EQ(run_condyle({"protocol"}).exit_code, 2);
  EXPECT_EQ(run_condyle({"protocol", "release", path, "--noise-mm", "nan"}).exit_code, 2);
}

TEST(ProtocolCombine, GivesFrictionStiffnessAndMass) {
  const TemporaryFolder folder;
  Subject loaded;
  loaded.mass_kg += 0.1;
  const std::string first = record(folder, "first", {}, 4);
  const std::string second = record(folder, "second", loaded, 5);
  const auto result = run_condyle({"protocol", "combine", first, second, "--noise-mm", "0.05",
                                   "--added-mass-kg", "0.1", "--added-mass-sd-kg", "0.001", "--out",
                                   folder / "pair.json", "--figures", folder / "figures"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("they agree"));
  const auto json = read_json(folder / "pair.json");
  EXPECT_TRUE(holds(json["friction_Ns_m"], 2));
  EXPECT_TRUE(holds(json["stiffness_N_m"], 100));
  EXPECT_TRUE(holds(json["mass_kg"], 0.25));
  EXPECT_TRUE(std::filesystem::exists(folder / "figures/second_release.svg"));

  loaded.friction_Ns_m = 3;  // not relaxed the second time
  const std::string tense = record(folder, "tense", loaded, 6);
  const auto refused = run_condyle(
      {"protocol", "combine", first, tense, "--noise-mm", "0.05", "--added-mass-kg", "0.1"});
  ASSERT_EQ(refused.exit_code, 0) << refused.errors;
  EXPECT_THAT(refused.output, HasSubstr("NOT KNOWN: no single (kv, ks, m) explains both"));
}

}  // namespace
}  // namespace condyle
