// SPDX-License-Identifier: Apache-2.0
#include "inspect/byte_statistics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <random>

namespace condyle::host {
namespace {

using testing::HasSubstr;

// Reports of 16 bytes, 2 ms apart; `fill` sets the bytes of number k.
struct Watched : ByteStatistics {
  Watched(int count, const std::function<void(int, hal::RawReport&)>& fill) {
    for (int k = 0; k < count; ++k) {
      hal::RawReport report;
      report.host_time_ns = k * TimeNs{2'000'000};
      report.size = 16;
      fill(k, report);
      add(report);
    }
  }
};

void put(hal::RawReport& report, std::size_t at, std::size_t width, bool is_big_endian,
         std::uint64_t value) {
  for (std::size_t i = 0; i < width; ++i) {
    report.bytes[at + (is_big_endian ? width - 1 - i : i)] =
        static_cast<std::uint8_t>(value >> (8 * i));
  }
}

struct Form {
  std::size_t width;
  bool is_big_endian;
  std::uint64_t first, step;
};

class SteadyForms : public testing::TestWithParam<Form> {};

// Between noise, so that nothing else is steady: found where it is, as wide as it is.
TEST_P(SteadyForms, AreFoundAmongNoise) {
  const Form form = GetParam();
  std::mt19937 random(1);
  const Watched watch(2000, [&](int k, hal::RawReport& report) {
    for (std::size_t i = 0; i < 16; ++i) report.bytes[i] = static_cast<std::uint8_t>(random());
    put(report, 3, form.width, form.is_big_endian,
        form.first + form.step * static_cast<std::uint64_t>(k));
  });
  const auto fields = watch.steady_fields();
  ASSERT_EQ(fields.size(), 1U);
  EXPECT_EQ(fields[0].offset_bytes, 3U);
  EXPECT_EQ(fields[0].width_bytes, form.width);
  EXPECT_EQ(fields[0].is_big_endian, form.is_big_endian);
  EXPECT_EQ(fields[0].step, form.step);
}
// Each carries into all of its bytes, or passes its end.
INSTANTIATE_TEST_SUITE_P(ByteStatistics, SteadyForms,
                         testing::Values(Form{1, false, 0, 1}, Form{2, false, 65000, 1},
                                         Form{2, true, 65000, 1}, Form{4, false, 0xFFFFFE00, 1},
                                         Form{4, true, 0xFFFFFE00, 1},
                                         Form{4, false, 0xFFF00000, 2000}, Form{2, true, 0, 20}));

TEST(ByteStatistics, FindsNoCounterInNoiseOrRest) {
  std::mt19937 random(2);
  const Watched watch(2000, [&](int, hal::RawReport& report) {
    for (std::size_t i = 0; i < 8; ++i) report.bytes[i] = static_cast<std::uint8_t>(random());
  });
  EXPECT_TRUE(watch.steady_fields().empty());
  EXPECT_EQ(changed_text(watch), "0-7");
}

TEST(ByteStatistics, BearsLostReports) {
  std::mt19937 random(3);
  std::uint64_t counter = 0;
  const Watched watch(2000, [&](int, hal::RawReport& report) {
    counter += random() % 20 == 0 ? 3U : 1U;
    put(report, 0, 4, false, counter);
  });
  EXPECT_THAT(steady_text(watch),
              testing::ElementsAre(HasSubstr("byte 0 to 3, little-endian: increases by 1")));
}

// Jitter with a known spread: +-0.1 ms about equidistant times gives intervals with a standard
// deviation of 0.2 ms where the signs alternate.
TEST(ByteStatistics, MeasuresRateAndJitter) {
  const Watched watch(1001, [](int k, hal::RawReport& report) {
    report.host_time_ns += k % 2 == 0 ? -100'000 : 100'000;
  });
  EXPECT_NEAR(watch.rate_Hz(), 500, 0.1);
  EXPECT_NEAR(watch.jitter_s(), 0.2e-3, 1e-6);
  EXPECT_THAT(rate_text(watch), HasSubstr("standard deviation 0.200 ms"));
  EXPECT_EQ(watch.intervals().largest_ns(), 2'200'000);
}

TEST(ByteStatistics, SaysWhereItIsTooEarly) {
  const Watched watch(2, [](int, hal::RawReport&) {});
  EXPECT_EQ(rate_text(watch), "too few to determine the rate");
  EXPECT_EQ(changed_text(watch), "none");
  EXPECT_EQ(ByteStatistics().rate_Hz(), 0);
}

TEST(ByteStatistics, TakesReportsOfAnySize) {
  ByteStatistics watch;
  for (const std::uint16_t size : std::initializer_list<std::uint16_t>{1, 1024, 3, 64}) {
    hal::RawReport report;
    report.size = size;
    watch.add(report);
  }
  EXPECT_EQ(watch.smallest(), 1U);
  EXPECT_EQ(watch.largest(), 1024U);
}

}  // namespace
}  // namespace condyle::host
