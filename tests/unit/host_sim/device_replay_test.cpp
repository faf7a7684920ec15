// SPDX-License-Identifier: Apache-2.0
// The replay of a session log is the live run again, with all that went wrong in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "condyle/firmware/run_loop.h"
#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/log/recorded_source.h"
#include "condyle/hal/report/device_facebow.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/devices/facebow_report.h"
#include "recordings/replay_facebow.h"
#include "support/paths.h"
#include "support/session.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using hal::Status;

constexpr int kReports = 2000;

// A facebow that sends reports of which some are damaged, and that goes away now and then.
class FaultySource final : public hal::ReportSource {
 public:
  explicit FaultySource(hal::ManualClock& clock) : clock_(clock) {}
  Status open() override { return Status::ok; }
  Status read(TimeNs, hal::RawReport& report) override {
    if (sent_ == kReports) return Status::end;
    clock_.sleep_until(clock_.now_ns() + 5'000'000);
    ++sent_;
    if (sent_ % 300 == 0) {
      ++counts_.disconnections;
      return Status::disconnected;
    }
    fake::ReportContent content;
    content.counter = sent_;
    content.time_us = static_cast<std::uint32_t>(clock_.now_ns() / 1000);
    content.coordinates = {0, 0, static_cast<std::int16_t>(sent_ % 50), 100, 300, 0, -100, 300, 0};
    fake::FacebowReport bytes = fake::encode(content);
    if (sent_ % 70 < 3) bytes[10] ^= 1U;
    std::copy(bytes.begin(), bytes.end(), report.bytes.begin());
    report.size = static_cast<std::uint16_t>(bytes.size());
    report.host_time_ns = clock_.now_ns();
    return Status::ok;
  }
  void close() override {}
  hal::TransportCounts counts() const override { return counts_; }

 private:
  hal::ManualClock& clock_;
  std::uint32_t sent_ = 0;
  hal::TransportCounts counts_;
};

struct NoSensor {
  struct Estimate {
    EventSet events;
  };
  Estimate process(const Sample&, EventSet events) { return {events}; }
  bool drain(Estimate&) { return false; }
};

struct Outcome {
  firmware::RunCounts counts;
  std::vector<TimeNs> times_ns;
};

Outcome run_all(hal::Facebow& facebow, hal::Clock& clock, const firmware::RunSettings& settings) {
  Outcome result;
  NoSensor sensor;
  EXPECT_EQ(firmware::run(
                facebow, clock, sensor, settings, result.counts,
                [&](const Sample& sample, const NoSensor::Estimate&) {
                  result.times_ns.push_back(sample.time_ns);
                },
                [] { return false; }),
            Status::end);
  return result;
}

TEST(DeviceReplay, CountsWhatTheLiveRunCounted) {
  const testing_support::TemporaryFolder folder;
  const std::string path = testing_support::source_path("/hal/profiles/condyle_facebow.toml");
  const hal::DeviceProfile profile = load_device_profile(path);
  hal::SessionHeader header = testing_support::make_header();
  header.parameters_toml.clear();
  header.sources[0].profile_toml = testing_support::read_file(path);
  hal::SessionLogWriter log;
  ASSERT_EQ(log.open(folder / "log.mcap", header), hal::SessionLogFailure::none);
  hal::ManualClock clock;
  FaultySource source(clock);
  hal::RecordedSource recorded(source, log, 0, clock);
  hal::DeviceFacebow facebow(recorded, hal::layout_of(profile));
  ASSERT_EQ(facebow.open(), Status::ok);
  firmware::RunSettings settings;
  settings.nominal_step_ns = profile.nominal_step_ns().value_or(0);
  settings.reopen_pause_ns = 1'000'000;
  const Outcome live = run_all(facebow, clock, settings);
  ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
  ASSERT_EQ(log.status().reports_lost + log.status().events_lost, 0U);
  EXPECT_EQ(live.counts.disconnections, 6U);
  EXPECT_GT(live.counts.bad_reports, 50U);

  ReplayFacebow replay(folder / "log.mcap", {}, 0, clock);
  for (int round = 0; round < 2; ++round) {
    ASSERT_EQ(replay.open(), Status::ok) << replay.problem();
    const Outcome replayed = run_all(replay, clock, replay.run_settings({}));
    EXPECT_EQ(replayed.times_ns, live.times_ns);
    EXPECT_EQ(replayed.counts.samples, live.counts.samples);
    EXPECT_EQ(replayed.counts.bad_reports, live.counts.bad_reports);
    EXPECT_EQ(replayed.counts.disconnections, live.counts.disconnections);
    EXPECT_EQ(replayed.counts.timeouts, 0U);
    for (std::size_t event = 0; event < kEventCount; ++event) {
      EXPECT_EQ(replayed.counts.events[static_cast<Event>(event)],
                live.counts.events[static_cast<Event>(event)]);
    }
    EXPECT_EQ(replay.progress(), 1);
  }
}

}  // namespace
}  // namespace condyle::host
