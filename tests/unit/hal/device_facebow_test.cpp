// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/device_facebow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>

namespace condyle::hal {
namespace {

constexpr TimeNs kMs = 1'000'000, kS = 1000 * kMs;

// A device of 100 reports a second whose clock, 32 bits of microseconds, starts anew at each plug.
class PluggedSource final : public ReportSource {
 public:
  static ReportLayout layout() {
    ReportLayout layout;
    layout.rate_Hz = 100;
    layout.minimum_size_bytes = kSize;
    layout.device_time.emplace();
    layout.device_time->field = {
        .width_bits = 32, .type = FieldType::unsigned_integer, .scale = 1e-6};
    for (const std::uint32_t axis : {0U, 1U, 2U}) {
      CoordinateField coordinate;
      coordinate.field.offset_bits = 32 + 16 * axis;
      coordinate.field.width_bits = 16;
      coordinate.index = axis;
      layout.coordinates.push_back(coordinate);
    }
    layout.restarts_on_reconnect = true;
    return layout;
  }

  Status open() override {
    plugged_ns_ = measured_ns;
    return Status::ok;
  }
  Status read(TimeNs, RawReport& report) override {
    if (is_unplugged) return Status::disconnected;
    measured_ns += 10 * kMs;
    const auto ticks = static_cast<std::uint32_t>((measured_ns - plugged_ns_) / 1000);
    for (std::size_t i = 0; i < 4; ++i) {
      report.bytes[i] = static_cast<std::uint8_t>(ticks >> (8 * i));
    }
    report.size = kSize;
    report.host_time_ns = measured_ns + delay_ns;
    return Status::ok;
  }
  void close() override {}
  TransportCounts counts() const override { return {}; }

  TimeNs measured_ns = kS, delay_ns = 0;
  bool is_unplugged = false;

 private:
  static constexpr std::uint16_t kSize = 10;
  TimeNs plugged_ns_ = 0;
};

// Late reports before a device is unplugged do not shift the times after it is back.
TEST(DeviceFacebow, TimesOfADeviceThatIsBackAreNotThoseOfItsLastArrivals) {
  std::mt19937_64 random(7);
  for (int run = 0; run < 200; ++run) {
    PluggedSource source;
    DeviceFacebow facebow(source, PluggedSource::layout());
    const auto up_to = [&](TimeNs most) {
      return static_cast<TimeNs>(random() % static_cast<std::uint64_t>(most));
    };
    Sample sample;
    for (int plug = 0; plug < 4; ++plug) {
      ASSERT_EQ(facebow.open(), Status::ok);
      source.is_unplugged = false;
      const int reports = 200 + static_cast<int>(up_to(2000));
      for (int i = 0; i < reports; ++i) {
        source.delay_ns = up_to(kMs);
        ASSERT_EQ(facebow.read(0, sample), Status::ok);
        ASSERT_LE(std::abs(sample.time_ns - source.measured_ns), kMs)
            << run << ' ' << plug << ' ' << i;
      }
      source.delay_ns = up_to(90 * kMs);  // less than what the fit takes for a step of a clock
      ASSERT_EQ(facebow.read(0, sample), Status::ok);
      source.is_unplugged = true;
      ASSERT_EQ(facebow.read(0, sample), Status::disconnected);
      source.measured_ns += kS + up_to(20 * kS);
    }
  }
}

}  // namespace
}  // namespace condyle::hal
