// SPDX-License-Identifier: Apache-2.0
// A companion read beside the facebow, on its own thread, into the same log.
#include "hosted/devices/companion.h"

#include <gmock/gmock.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "condyle/hal/log/recorded_source.h"
#include "hosted/config/device_profile_file.h"
#include "hosted/files/input_error.h"
#include "output/device_values.h"
#include "support/paths.h"
#include "support/session.h"
#include "support/shared_clock.h"
#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

using testing::HasSubstr;

constexpr const char* kBowProfile = R"(name = "bow"
vendor_id = 1
product_id = 2
[report]
minimum_size_bytes = 8
[coordinates]
kind = "one_axis"
offset_bytes = 4
width_bits = 32
type = "signed"
unit = "um"
)";

constexpr const char* kForceProfile = R"(name = "force"
vendor_id = 0x1209
product_id = 2
[report]
minimum_size_bytes = 8
[sequence]
offset_bytes = 0
width_bits = 16
[drive]
offset_bytes = 2
width_bits = 16
type = "signed"
unit = "mN"
missing = -32768
[auxiliary.emg]
offset_bytes = 4
width_bits = 32
type = "float"
unit = "mV"
)";

constexpr std::uint32_t kReports = 500;
constexpr TimeNs kStep_ns = 1'000'000;

// Sends its reports a millisecond apart; goes away and comes back after each 100; is silent after
// the last. Every tenth has no force.
class Sensor final : public hal::ReportSource {
 public:
  explicit Sensor(hal::Clock& clock) : clock_(clock) {}
  hal::Status open() override {
    attempts_ += 1;
    return attempts_ % 3 == 0 ? hal::Status::ok : hal::Status::not_found;
  }
  hal::Status read(TimeNs deadline_ns, hal::RawReport& report) override {
    if (next_ == kReports) {
      is_done_ = true;
      clock_.sleep_until(deadline_ns);
      return hal::Status::timeout;
    }
    if (next_ > 0 && next_ % 100 == 0 && !std::exchange(is_away_, true)) {
      counts_.disconnections += 1;
      return hal::Status::disconnected;
    }
    is_away_ = false;
    clock_.sleep_until(clock_.now_ns() + kStep_ns);
    const std::int16_t force =
        next_ % 10 == 0 ? std::int16_t{-32768} : static_cast<std::int16_t>(next_);
    const float emg = 0.5F * static_cast<float>(next_);
    report.host_time_ns = clock_.now_ns();
    report.size = 8;
    std::memcpy(report.bytes.data(), &next_, 2);
    std::memcpy(report.bytes.data() + 2, &force, 2);
    std::memcpy(report.bytes.data() + 4, &emg, 4);
    sent_ = ++next_;
    return hal::Status::ok;
  }
  void close() override {}
  hal::TransportCounts counts() const override { return counts_; }
  bool is_done() const { return is_done_; }
  std::uint32_t sent() const { return sent_; }

 private:
  hal::Clock& clock_;
  std::atomic<std::uint32_t> sent_ = 0;
  std::uint32_t next_ = 0, attempts_ = 0;
  bool is_away_ = false;
  std::atomic<bool> is_done_ = false;
  hal::TransportCounts counts_;
};

TEST(Companion, IsReadBesideTheFacebowIntoTheSameLog) {
  testing_support::TemporaryFolder folder;
  const std::string log_path = folder / "log.mcap";
  testing_support::SharedManualClock clock;
  hal::SessionHeader header = testing_support::make_header(2);
  header.sources[0].profile_toml = kBowProfile;
  header.sources[1].profile_toml = kForceProfile;
  hal::SessionLogWriter log;
  ASSERT_EQ(log.open(log_path, header), hal::SessionLogFailure::none);

  Sensor sensor(clock);
  hal::RecordedSource recorded(sensor, log, 1, clock);
  Companion companion(recorded, parse_device_profile("force.toml", kForceProfile), clock);
  const TimeNs begin_ns = clock.now_ns();
  companion.start();
  std::uint32_t bow = 0;
  while (!sensor.is_done()) {  // the facebow's thread, for every second report of the sensor
    if (2 * bow >= sensor.sent()) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_TRUE(log.write(0, testing_support::make_report(bow++, 8, clock.now_ns())));
  }
  companion.stop();
  const TimeNs end_ns = clock.now_ns();
  ASSERT_EQ(log.close(), hal::SessionLogFailure::none);

  EXPECT_EQ(companion.device().counts().received, kReports);
  EXPECT_EQ(companion.device().counts().lost, 0U);
  EXPECT_EQ(companion.device().transport_counts().disconnections, kReports / 100 - 1);

  std::vector<std::unique_ptr<OutputFile>> files;
  const auto notes = write_device_values(log_path, "", folder / ".", files);
  ASSERT_EQ(files.size(), 1U);
  EXPECT_THAT(notes, testing::ElementsAre(HasSubstr("500 reports received, 0 lost")));
  files[0]->commit();
  EXPECT_THAT(files[0]->path(), HasSubstr("device_1.csv"));
  std::ifstream file(files[0]->path());
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "time_s,drive_N,emg_V");
  double last_s = seconds(begin_ns);
  for (std::uint32_t i = 0; i < kReports; ++i) {
    std::getline(file, line);
    std::istringstream row(line);
    std::string time, drive, emg;
    std::getline(row, time, ',');
    std::getline(row, drive, ',');
    std::getline(row, emg, ',');
    EXPECT_GT(std::stod(time), last_s);
    last_s = std::stod(time);
    if (i % 10 == 0) {
      EXPECT_EQ(drive, "");
    } else {
      EXPECT_NEAR(std::stod(drive), 1e-3 * i, 1e-12);
    }
    EXPECT_NEAR(std::stod(emg), 0.5e-3 * i, 1e-9);
  }
  EXPECT_LE(last_s, seconds(end_ns));
  EXPECT_FALSE(std::getline(file, line));
}

TEST(Companion, StopsWhileItsDeviceIsAway) {
  class Missing final : public hal::ReportSource {
   public:
    hal::Status open() override { return hal::Status::not_found; }
    hal::Status read(TimeNs, hal::RawReport&) override { return hal::Status::not_open; }
    void close() override {}
    hal::TransportCounts counts() const override { return {}; }
  };
  testing_support::SharedManualClock clock;
  Missing missing;
  Companion companion(missing, parse_device_profile("force.toml", kForceProfile), clock);
  companion.start();
  companion.stop();
  companion.stop();
  EXPECT_EQ(companion.device().counts().received, 0U);
}

// A log after a crash may have none: its estimates are wanted all the same.
TEST(DeviceValues, NotesThatALogHasNone) {
  testing_support::TemporaryFolder folder;
  hal::SessionHeader header = testing_support::make_header(1);
  header.sources[0].profile_toml = kBowProfile;
  hal::SessionLogWriter log;
  ASSERT_EQ(log.open(folder / "log.mcap", header), hal::SessionLogFailure::none);
  ASSERT_EQ(log.close(), hal::SessionLogFailure::none);
  std::vector<std::unique_ptr<OutputFile>> files;
  EXPECT_THAT(write_device_values(folder / "log.mcap", "", folder / ".", files),
              testing::ElementsAre(HasSubstr("contains no values other than positions")));
  EXPECT_TRUE(files.empty());
  EXPECT_THROW((void)write_device_values(testing_support::source_path("/README.md"), "",
                                         folder / ".", files),
               InputError);
}

}  // namespace
}  // namespace condyle::host
