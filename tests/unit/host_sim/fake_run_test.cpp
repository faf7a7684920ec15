// SPDX-License-Identifier: Apache-2.0
#include "fake/fake_run.h"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "fake/fake_setup.h"
#include "fake/report_queue.h"
#include "support/received_reports.h"

namespace condyle::host::fake {
namespace {

// A host that takes every report at once and notes when.
class NotingTransport final : public Transport {
 public:
  struct Note {
    TimeNs time_ns = 0;
    Packet packet;
  };

  explicit NotingTransport(hal::ManualClock& clock) : clock_(clock) {}
  std::string name() const override { return "noting"; }
  void plug() override {
    is_plugged_ = true;
    plugged_ns.push_back(clock_.now_ns());
  }
  void unplug() override {
    if (is_plugged_) unplugged_ns.push_back(clock_.now_ns());
    is_plugged_ = false;
  }
  void send(const Packet& packet) override {
    notes.push_back({clock_.now_ns(), packet});
    queue_.count_delivered(packet);
  }
  bool can_fail() const override { return can_fail_transfers; }
  bool knows_taken() const override { return true; }
  void serve(TimeNs deadline_ns) override { clock_.sleep_until(deadline_ns); }
  bool is_read() override { return is_plugged_; }
  bool is_taken() override { return true; }
  Deliveries deliveries() override { return queue_.deliveries(); }

  void forget() {
    notes.clear();
    queue_ = ReportQueue();
  }

  std::vector<Note> notes;
  std::vector<TimeNs> plugged_ns, unplugged_ns;
  bool can_fail_transfers = true;

 private:
  hal::ManualClock& clock_;
  ReportQueue queue_;
  bool is_plugged_ = false;
};

class FakeRunTest : public testing::Test {
 protected:
  DeliveryLog play(FakeOptions options) {
    options.rate_Hz = 100;
    if (options.run.count == 0 && !options.stops_at_end) options.run.count = 20;
    FakeSetup setup = set_up(options);
    transport_.forget();
    FakeRun run(setup.device, setup.script, transport_, clock_, setup.run);
    run.run([] { return false; });
    const DeliveryLog delivery_log = run.delivery_log();
    EXPECT_TRUE(delivery_log.balances()) << delivery_log_json(delivery_log);
    return delivery_log;
  }
  TimeNs sent_ms(std::size_t index) const { return transport_.notes[index].time_ns / 1'000'000; }
  hil::ReceivedReport received(std::size_t index) const {
    const Packet& packet = transport_.notes[index].packet;
    return hil::decode(packet.bytes.data(), packet.size).value();
  }
  bool is_readable(std::size_t index) const {
    const Packet& packet = transport_.notes[index].packet;
    return hil::decode(packet.bytes.data(), packet.size).has_value();
  }

  hal::ManualClock clock_;
  NotingTransport transport_{clock_};
};

TEST_F(FakeRunTest, SendsEachReportAtItsTime) {
  const DeliveryLog delivery_log = play({});
  EXPECT_EQ(delivery_log.made, 20U);
  EXPECT_EQ(delivery_log.ended, "all reports were sent");
  ASSERT_EQ(transport_.notes.size(), 20U);
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_EQ(sent_ms(k), 10 * static_cast<TimeNs>(k));
    EXPECT_EQ(received(k).counter, k);
    EXPECT_EQ(received(k).time_us, 10'000 * k);
  }
}

TEST_F(FakeRunTest, PauseMovesAllThatFollows) {
  play({.faults = {"pause@5=0.5"}});
  EXPECT_EQ(sent_ms(4), 40);
  EXPECT_EQ(sent_ms(5), 550);
  EXPECT_EQ(received(5).counter, 5U);
  EXPECT_EQ(received(5).time_us, 550'000U);
  EXPECT_EQ(sent_ms(6), 560);
}

TEST_F(FakeRunTest, BurstArrivesAtOnceButWasMeasuredInTime) {
  const DeliveryLog delivery_log = play({.faults = {"burst@5=4"}});
  for (std::size_t k = 5; k < 9; ++k) {
    EXPECT_EQ(sent_ms(k), 80) << k;
    EXPECT_EQ(received(k).time_us, 10'000 * k);
  }
  EXPECT_EQ(sent_ms(9), 90);
  EXPECT_EQ(delivery_log.deliveries.intact, 20U);
}

TEST_F(FakeRunTest, BurstBeyondTheEndIsSent) {
  EXPECT_EQ(play({.faults = {"burst@18=50"}}).deliveries.intact, 20U);
}

TEST_F(FakeRunTest, UnplugsAtAnyMoment) {
  const DeliveryLog delivery_log = play({.faults = {"unplug@0.0437s=0.1"}});
  EXPECT_THAT(transport_.unplugged_ns, testing::Contains(43'700'000));
  ASSERT_EQ(transport_.plugged_ns.size(), 2U);
  EXPECT_EQ(transport_.plugged_ns[1], 143'700'000);
  EXPECT_EQ(delivery_log.plugged_in, 2U);
  EXPECT_EQ(received(5).counter, 5U);  // it runs on, and nothing was made meanwhile
  EXPECT_EQ(transport_.notes[5].time_ns, 143'700'000);
}

TEST_F(FakeRunTest, RestartsWhenToldTo) {
  play({.faults = {"unplug@5"}, .device = {.restarts_on_reconnect = true}});
  EXPECT_EQ(received(4).counter, 4U);
  EXPECT_EQ(received(5).counter, 0U);
  EXPECT_EQ(received(5).time_us, 0U);
}

TEST_F(FakeRunTest, JumpsStay) {
  const DeliveryLog delivery_log = play({.faults = {"counter_jump@5=-3", "clock_jump@7=2.5"}});
  EXPECT_EQ(received(5).counter, 2U);
  EXPECT_EQ(received(6).counter, 3U);
  EXPECT_EQ(received(6).time_us, 60'000U);
  EXPECT_EQ(received(7).time_us, 2'570'000U);
  EXPECT_EQ(delivery_log.counter_jumped, -3);
}

TEST_F(FakeRunTest, SpoilsTheReportsItSays) {
  const DeliveryLog delivery_log =
      play({.faults = {"truncated@3=7", "garbage@5", "wrong_checksum@7", "wrong_id@9"}});
  for (std::size_t k = 0; k < 20; ++k) {
    EXPECT_EQ(is_readable(k), k != 3 && k != 5 && k != 7 && k != 9) << k;
  }
  EXPECT_EQ(transport_.notes[3].packet.size, 7U);
  EXPECT_EQ(transport_.notes[9].packet.bytes[0], 2U);
  EXPECT_EQ(delivery_log.deliveries.altered, 4U);
  EXPECT_EQ(delivery_log.deliveries.intact, 16U);
}

TEST_F(FakeRunTest, OneReportIsSpoiltOnce) {
  const DeliveryLog delivery_log = play({.faults = {"stall@3", "garbage@3"}});
  EXPECT_EQ(delivery_log.deliveries.lost_failed, 1U);
  EXPECT_EQ(delivery_log.not_done[static_cast<std::size_t>(FaultKind::garbage)], 1U);
}

TEST_F(FakeRunTest, SaysWhatTheTransportCannotDo) {
  transport_.can_fail_transfers = false;
  const DeliveryLog delivery_log = play({.faults = {"stall@3", "transfer_error@4"}});
  EXPECT_EQ(delivery_log.deliveries.intact, 20U);
  EXPECT_EQ(delivery_log.not_done[static_cast<std::size_t>(FaultKind::stall)], 1U);
  EXPECT_EQ(delivery_log.not_done[static_cast<std::size_t>(FaultKind::transfer_error)], 1U);
}

TEST_F(FakeRunTest, ChanceSparesFirstAndLast) {
  const DeliveryLog delivery_log = play({.faults = {"garbage~1"}});
  EXPECT_TRUE(is_readable(0));
  EXPECT_TRUE(is_readable(19));
  EXPECT_EQ(delivery_log.deliveries.altered, 18U);
}

TEST_F(FakeRunTest, SameSeedSameReports) {
  const auto bytes = [this](std::uint64_t seed) {
    play({.faults = {"garbage~0.5"}, .seed = seed});
    std::vector<std::array<std::uint8_t, kLargestPacket>> all;
    for (const auto& note : transport_.notes) all.push_back(note.packet.bytes);
    return all;
  };
  const auto first = bytes(4);
  EXPECT_EQ(first, bytes(4));
  EXPECT_NE(first, bytes(5));
}

TEST_F(FakeRunTest, AccountIsJson) {
  const auto json = nlohmann::json::parse(delivery_log_json(play({.faults = {"garbage@3"}})));
  EXPECT_EQ(json["made"], 20);
  EXPECT_EQ(json["delivered_altered"], 1);
  EXPECT_EQ(json["faults"], nlohmann::json({{"garbage", 1}}));
  EXPECT_EQ(json["balances"], true);
}

}  // namespace
}  // namespace condyle::host::fake
