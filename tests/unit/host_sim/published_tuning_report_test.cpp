// SPDX-License-Identifier: Apache-2.0
#include "tuning/published_tuning_report.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "support/temporary_folder.h"
#include "unit/host_sim/golden_tunings.h"

namespace condyle::host {
namespace {

using ::testing::HasSubstr;
using testing_support::golden_chewing;
using testing_support::golden_parameters;
using testing_support::tune;

TEST(PublishedTuningReport, SaysThatItIsAssumed) {
  const PublishedTuningResult result = tune({golden_chewing()});
  const std::string text = published_tuning_text(result);
  EXPECT_THAT(text, HasSubstr("100 with seed 1"));
  EXPECT_THAT(text, HasSubstr("does not distinguish these tunings"));
  EXPECT_THAT(text, HasSubstr("ASSUMED"));
  EXPECT_THAT(text, HasSubstr("not measurements of the subject. Research use only."));
  EXPECT_THAT(text, HasSubstr("P_kv  initial variance of friction"));
  const auto shown = tunings_spread_evenly(result, 12);
  ASSERT_GE(shown.size(), 5U);
  EXPECT_LE(shown.size(), 12U);
  EXPECT_EQ(result.tunings[shown.front()].friction_Ns_m, result.lowest_friction_Ns_m);
  EXPECT_EQ(result.tunings[shown.back()].friction_Ns_m, result.highest_friction_Ns_m);
  auto all = tunings_spread_evenly(result, 300);
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
  PublishedParameters learnt = golden_parameters();
  learnt.mass.initial_kg = learnt.assumed_mass_kg;
  EXPECT_THAT(text, ::testing::Not(HasSubstr("learns nothing")));
  EXPECT_THAT(published_tuning_text(tune({golden_chewing()}, {}, learnt)),
              HasSubstr("a filter that learns nothing"));
}

TEST(PublishedTuningReport, DrawsTheTunings) {
  const PublishedRecording recording = golden_chewing();
  const PublishedTuningResult result = tune({recording});
  const testing_support::TemporaryFolder folder;
  for (const auto& file :
       draw_published_tunings(folder.path().string(), "chewing's", result, recording)) {
    file->commit();
  }
  const std::string drawing = testing_support::read_file(folder / "published_tunings.svg");
  EXPECT_THAT(drawing, HasSubstr("friction of a tuning: ASSUMED, not measured"));
  EXPECT_THAT(drawing, HasSubstr("research use only"));
  EXPECT_THAT(drawing, HasSubstr("within 2 % of the assumed 0.25 kg"));
  EXPECT_EQ(testing_support::read_file(folder / "published_tunings.png").substr(1, 3), "PNG");
}

}  // namespace
}  // namespace condyle::host
