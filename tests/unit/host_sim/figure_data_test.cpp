// SPDX-License-Identifier: Apache-2.0
#include "output/figure_data.h"

#include <gtest/gtest.h>

#include "support/rapidcheck_gtest.h"

namespace condyle::host {
namespace {

// However long the recording, the runs are few, in order, and no extreme is lost.
RC_GTEST_PROP(FigureData, ThinsWithoutLosingExtremes, ()) {
  const auto samples = *rc::gen::inRange<std::size_t>(1, 40'000);
  const auto peak_at = *rc::gen::inRange<std::size_t>(0, samples);
  FigureData data;
  for (std::size_t i = 0; i < samples; ++i) {
    EstimateRow row;
    row.time_ns = static_cast<TimeNs>(i) * 1'000'000;
    row.measured_position_m = i == peak_at ? 0.5 : 0.001;
    row.position_m = {row.measured_position_m, 0.1,
                      i == peak_at ? Provenance::assumed : Provenance::measured};
    row.events.add(Event::time_gap, i == peak_at);
    data.add(row);
  }
  RC_ASSERT(data.runs().size() <= FigureData::kMostRuns);
  RC_ASSERT(data.runs().size() >= std::min(samples, FigureData::kMostRuns / 2));
  Extremes position;
  int events = 0;
  double previous_s = -1;
  for (const FigureRun& run : data.runs()) {
    RC_ASSERT(run.time_s > previous_s);
    previous_s = run.time_s;
    position.add(run.position_m.value);
    if (!run.has_event) continue;
    ++events;
    RC_ASSERT(run.position_m.provenance == Provenance::assumed);
    RC_ASSERT(run.position_m.band.highest > 0.69);
  }
  RC_ASSERT(events == 1);
  RC_ASSERT(position.highest == 0.5);
}

// Of Unix time a double holds 0.2 us, and the figures' nine digits hold 10 s.
TEST(FigureData, TimeStartsAtTheFirstSample) {
  constexpr TimeNs origin_ns = 1'763'716'110'000'000'007;
  FigureData data;
  data.add({});  // without a time
  for (TimeNs i = 0; i < 4; ++i) {
    EstimateRow row;
    row.time_ns = origin_ns + i;
    data.add(row);
  }
  EXPECT_EQ(data.origin_ns(), origin_ns);
  ASSERT_EQ(data.runs().size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(data.runs()[i].time_s, 1e-9 * static_cast<double>(i));
  }
}

TEST(FigureData, DifferentiatesOverTheTimeThatPassed) {
  FigureData data;
  for (const double t : {0.0, 0.1, 0.3}) {
    EstimateRow row;
    row.time_ns = nanoseconds(t);
    row.measured_position_m = t;
    data.add(row);
  }
  ASSERT_EQ(data.runs().size(), 3U);
  EXPECT_TRUE(std::isnan(data.runs()[0].differentiated_velocity_m_s.lowest));
  EXPECT_NEAR(data.runs()[1].differentiated_velocity_m_s.lowest, 1, 1e-12);
  EXPECT_NEAR(data.runs()[2].differentiated_velocity_m_s.lowest, 1, 1e-12);
}

}  // namespace
}  // namespace condyle::host
