// SPDX-License-Identifier: Apache-2.0
#include "fake/fault_script.h"

#include <gmock/gmock.h>

#include <set>

#include "hosted/files/input_error.h"
#include "support/temporary_folder.h"

namespace condyle::host::fake {
namespace {

using testing::HasSubstr;

std::vector<FaultRule> load(const std::string& text, std::uint64_t& seed) {
  const testing_support::TemporaryFolder folder;
  return load_faults(folder.write("f.toml", text), seed);
}

std::string problem_of_file(const std::string& text) {
  try {
    std::uint64_t seed = 0;
    load(text, seed);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string problem_of(const std::string& text) {
  try {
    parse_fault(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

// The reports that a script hits, report k being due k milliseconds after the start.
std::set<std::uint64_t> hits(const std::vector<FaultRule>& rules, std::uint64_t seed,
                             std::uint64_t count) {
  FaultScript script(rules, seed);
  std::set<std::uint64_t> reports;
  for (std::uint64_t k = 0; k < count; ++k) {
    if (!script.faults_of(k, static_cast<TimeNs>(k) * 1'000'000, false).empty()) reports.insert(k);
  }
  return reports;
}

TEST(FaultScript, ErrorsNamePlaceProblemAndMend) {
  const auto expect = [](const char* text, const char* words) {
    EXPECT_THAT(problem_of_file(text), HasSubstr(words)) << text;
  };
  expect("", "no error");
  expect("[unplug]\nreports = [3]\n", "no error");
  expect("[unplugs]\nreports = [3]\n", "f.toml:1:2: unknown key 'unplugs'");
  expect("[unplug]\nreport = [3]\n",
         "f.toml:2:1: unknown key 'report'; keys of [unplug] are off_s");
  expect("[unplug]\nreports = 3\n", "f.toml:2:11: reports takes an array");
  expect("[unplug]\nreports = [3, -1]\n", "f.toml:2:15: reports = -1 is out of range");
  expect("[unplug]\nreports = [3.5]\n", "reports = 3.5 is not a whole number");
  expect("[unplug]\nreports = [\"3\"]\n", "f.toml:2:12: reports takes numbers");
  expect("[unplug]\noff_s = 1\n", "f.toml:1:1: [unplug] never happens; give reports, times_s");
  expect("[unplug]\nreports = []\n", "[unplug] never happens");
  expect("[unplug]\nreports = [1]\noff_s = nan\n", "f.toml:3:9: off_s = nan is out of range");
  expect("[garbage]\nreports = [1]\noff_s = 1\n", "unknown key 'off_s'");
  expect("[truncated]\nreports = [1]\nsize_bytes = 29\n", "give 1 to 28 (bytes)");
  expect("[truncated]\nreports = [1]\nsize_bytes = 2.5\n", "f.toml:3:14: size_bytes = 2.5 is not");
  expect("[stall]\nprobability = 1.1\n", "probability = 1.1 is out of range; give 0 to 1");
  expect("[stall]\nevery_reports = 0\n", "every_reports = 0 is out of range");
  expect("stall = 3\n", "f.toml:1:1: stall is a section; write [stall]");
  expect("seed = 0.5\n", "f.toml:1:8: seed = 0.5 is not a whole number");
  expect("[unplug\n", "f.toml:1:");
}

TEST(FaultScript, ErrorsInOptionsNameTheOption) {
  const auto expect = [](const char* text, const char* words) {
    EXPECT_THAT(problem_of(text), HasSubstr(words)) << text;
  };
  for (const char* good : {"unplug@3", "unplug@1.25s=0.5", "pause/60=1", "stall~0.5", "burst@0=2",
                           "counter_jump@9=-7", "clock_jump@9=-0.5"}) {
    expect(good, "no error");
  }
  expect("", "fault '': lacks the time of the fault; write KIND@REPORT");
  expect("unplug", "fault 'unplug': lacks the time of the fault");
  expect("unplug=3@5", "'unplug=3' is not a kind of fault; kinds are unplug, pause");
  expect("unplug@", "'' is not a number from 0");
  expect("unplug@s", "'' is not a number from 0");
  expect("unplug@-3", "'-3' is not a number from 0");
  expect("unplug@3.5", "report = 3.5 is not a whole number");
  expect("unplug@3=", "'' is not a number from 0 to 3600");
  expect("unplug@3=1=2", "'1=2' is not a number");
  expect("unplug/0", "'0' is not a number from 1");
  expect("unplug~2", "'2' is not a number from 0 to 1");
  expect("stall@3=1", "stall has no amount; leave it out");
  expect("burst@3=2.5", "count = 2.5 is not a whole number; give whole reports");
}

TEST(FaultScript, FileAndOptionsSayTheSame) {
  std::uint64_t seed = 1;
  const auto rules = load(
      "seed = 9\n[pause]\nreports = [4]\ntimes_s = [0.5]\nevery_reports = 7\n"
      "probability = 0.25\nduration_s = 0.125\n",
      seed);
  EXPECT_EQ(seed, 9U);
  const char* options[] = {"pause@4=0.125", "pause@0.5s=0.125", "pause/7=0.125",
                           "pause~0.25=0.125"};
  ASSERT_EQ(rules.size(), std::size(options));
  for (std::size_t i = 0; i < rules.size(); ++i) {
    const FaultRule option = parse_fault(options[i]);
    EXPECT_EQ(rules[i].kind, option.kind) << i;
    EXPECT_EQ(rules[i].amount, option.amount) << i;
    EXPECT_EQ(rules[i].at_report, option.at_report) << i;
    EXPECT_EQ(rules[i].at_time_ns, option.at_time_ns) << i;
    EXPECT_EQ(rules[i].every_reports, option.every_reports) << i;
    EXPECT_EQ(rules[i].probability, option.probability) << i;
  }
}

TEST(FaultScript, HitsWhatItSays) {
  EXPECT_THAT(hits({parse_fault("garbage@0"), parse_fault("garbage@5")}, 1, 10),
              testing::ElementsAre(0, 5));
  EXPECT_THAT(hits({parse_fault("garbage/4")}, 1, 13), testing::ElementsAre(4, 8, 12));
  // A time hits once: the first report that is due then or later.
  EXPECT_THAT(hits({parse_fault("garbage@0.0035s")}, 1, 10), testing::ElementsAre(4));
}

TEST(FaultScript, OfOneKindOneHitsAReport) {
  FaultScript script({parse_fault("pause@3=1"), parse_fault("stall@3"), parse_fault("pause@3=2")},
                     1);
  const auto faults = script.faults_of(3, 0, false);
  ASSERT_EQ(faults.size(), 2U);
  EXPECT_EQ(faults[0].kind, FaultKind::pause);
  EXPECT_EQ(faults[0].amount, 1);
  EXPECT_EQ(faults[1].kind, FaultKind::stall);
}

TEST(FaultScript, ChanceKeepsItsRateAndRepeatsWithTheSeed) {
  constexpr std::uint64_t count = 40000;
  const auto rules = std::vector{parse_fault("garbage~0.1")};
  const auto reports = hits(rules, 5, count);
  // 4000 expected, standard deviation 60: beyond five of them for one seed in a million.
  EXPECT_NEAR(static_cast<double>(reports.size()), 4000, 300);
  EXPECT_EQ(reports, hits(rules, 5, count));
  EXPECT_NE(reports, hits(rules, 6, count));
}

TEST(FaultScript, OneKindsChanceDoesNotChangeAnothers) {
  FaultScript alone({parse_fault("garbage~0.2")}, 3);
  FaultScript both({parse_fault("stall~0.5"), parse_fault("garbage~0.2")}, 3);
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const auto has_garbage = [k](FaultScript& script) {
      const auto faults = script.faults_of(k, 0, false);
      return std::any_of(faults.begin(), faults.end(),
                         [](const Fault& fault) { return fault.kind == FaultKind::garbage; });
    };
    ASSERT_EQ(has_garbage(alone), has_garbage(both)) << k;
  }
}

TEST(FaultScript, ChanceCanBeSpared) {
  FaultScript script({parse_fault("garbage~1"), parse_fault("stall@0")}, 1);
  const auto faults = script.faults_of(0, 0, true);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, FaultKind::stall);
}

}  // namespace
}  // namespace condyle::host::fake
