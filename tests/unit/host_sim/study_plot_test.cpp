// SPDX-License-Identifier: Apache-2.0
// The group level of a study: values by subject and session, and their figure, whose size does not
// grow with the number of subjects.
#include "study/study_plot.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "support/random.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;
using testing::Not;

// A study in which each subject has up to 3 sessions, and each session up to 3 recordings that show
// the reading.
StudyTables random_study(std::size_t subjects, testing_support::Random& random,
                         std::vector<StudyValue>& values) {
  StudyTables tables;
  for (std::size_t subject = 0; subject < subjects; ++subject) {
    for (int session = 1; session <= 3; ++session) {
      for (int recording = 0; recording < 3; ++recording) {
        const auto outcome = static_cast<std::uint32_t>(tables.outcomes.size());
        StudyOutcome one;
        one.recording.subject = std::to_string(1000 + subject);
        one.recording.session = std::to_string(session);
        tables.outcomes.push_back(one);
        if (random.uniform() < 0.3) continue;  // does not show it
        const double value = random.normal();
        values.push_back({outcome, value, value - 1, value + 2});
      }
    }
  }
  return tables;
}

TEST(StudySessions, HoldTheValuesOfTheirRecordings) {
  testing_support::Random random(1);
  for (std::size_t study = 0; study < 50; ++study) {
    StudyReading reading;
    const StudyTables tables = random_study(1 + study, random, reading.values);
    std::map<std::pair<std::string, std::string>, std::vector<double>> expected;
    for (const StudyValue& value : reading.values) {
      const StudyRecording& recording = tables.outcomes[value.outcome].recording;
      expected[{recording.subject, recording.session}].push_back(value.value);
    }
    const std::vector<StudySession> sessions = sessions_of(tables, reading);
    ASSERT_EQ(sessions.size(), expected.size());
    auto next = sessions.begin();
    for (const auto& [key, values] : expected) {
      EXPECT_EQ(next->subject, key.first);
      EXPECT_EQ(next->session, key.second);
      EXPECT_EQ(next->values, values);
      double mean = 0;
      for (const double value : values) mean += value / static_cast<double>(values.size());
      EXPECT_NEAR(next->mean, mean, 1e-12);
      EXPECT_NEAR(next->low, mean - 1, 1e-12);
      EXPECT_NEAR(next->high, mean + 2, 1e-12);
      ++next;
    }
  }
}

TEST(StudyChanges, AreOfEachPairOfSessionsOfASubject) {
  testing_support::Random random(2);
  StudyReading reading;
  const StudyTables tables = random_study(40, random, reading.values);
  const std::vector<StudySession> sessions = sessions_of(tables, reading);
  std::size_t pairs = 0;
  for (const StudySession& a : sessions) {
    pairs += static_cast<std::size_t>(std::count_if(
        sessions.begin(), sessions.end(),
        [&](const StudySession& b) { return a.subject == b.subject && a.session < b.session; }));
  }
  const std::vector<StudyChange> changes = changes_of(tables, reading);
  EXPECT_EQ(changes.size(), pairs);
  for (const StudyChange& change : changes) EXPECT_LT(change.from, change.to);
}

// Subject i of `subjects` has the mean i in each of two sessions, in no order.
struct Ladder {
  explicit Ladder(std::size_t subjects) {
    for (std::size_t i = 0; i < subjects; ++i) names.push_back(std::to_string(10'000 + i));
    for (std::size_t i = 0; i < subjects; ++i) {
      const std::size_t subject = i * 7 % subjects;  // 7 divides no count that is used
      const auto mean = static_cast<double>(subject);
      for (const char* session : {"1", "2"}) {
        sessions.push_back({names[subject], session, {mean}, mean, mean - 1, mean + 1});
      }
    }
  }
  std::string plot() const { return study_plot("opening_mm", "mm", sessions); }

  std::vector<std::string> names;
  std::vector<StudySession> sessions;
};

TEST(StudyPlot, HasALineForEachSubjectOfASmallStudy) {
  const Ladder study(kMostSubjectsDrawn);
  const std::string plot = study.plot();
  for (const std::string& name : study.names) {
    EXPECT_THAT(plot, HasSubstr("<title>" + name + "</title>"));
  }
  EXPECT_THAT(plot, Not(HasSubstr("<rect")));
}

TEST(StudyPlot, HasBoxesOfALargeStudyAndDoesNotGrow) {
  const std::string small = Ladder(kMostSubjectsDrawn + 1).plot();
  const std::string large = Ladder(20'000).plot();
  EXPECT_THAT(small, HasSubstr("<rect"));
  EXPECT_LT(large.size(), small.size() + 100);
  EXPECT_THAT(large, HasSubstr("<title>10000</title>"));
  EXPECT_THAT(large, HasSubstr("<title>29999</title>"));
}

TEST(StudyPlot, HasTheQuantilesOfTheSubjectsAtTheirPlaces) {
  const std::string plot = Ladder(401).plot();
  const std::regex circle("cy=\"([0-9.]+)\""),
      box("rect [^>]* y=\"([0-9.]+)\" [^>]*height=\"([0-9.]+)\""),
      bar("d=\"M[0-9.]+ ([0-9.]+)V([0-9.]+)\"/><rect"), median("d=\"M[0-9.]+ ([0-9.]+)h");
  std::smatch found;
  ASSERT_TRUE(std::regex_search(plot, found, circle));
  const double lowest = std::stod(found[1]);
  const std::string after = found.suffix();
  ASSERT_TRUE(std::regex_search(after, found, circle));
  const double highest = std::stod(found[1]);
  const auto place = [&](double share) { return lowest + share * (highest - lowest); };
  constexpr double kRounding = 0.11;  // of two numbers with one decimal
  EXPECT_GT(lowest, highest);         // SVG counts from above
  ASSERT_TRUE(std::regex_search(plot, found, box));
  EXPECT_NEAR(std::stod(found[1]), place(0.75), kRounding);
  EXPECT_NEAR(std::stod(found[2]), place(0.25) - place(0.75), kRounding);
  ASSERT_TRUE(std::regex_search(plot, found, bar));
  EXPECT_NEAR(std::stod(found[1]), place(0.025), kRounding);
  EXPECT_NEAR(std::stod(found[2]), place(0.975), kRounding);
  ASSERT_TRUE(std::regex_search(plot, found, median));
  EXPECT_NEAR(std::stod(found[1]), place(0.5), kRounding);
}

}  // namespace
}  // namespace condyle::host
