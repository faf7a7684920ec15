// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "condyle/hal/clock.h"
#include "fake/delivery_log.h"
#include "fake/facebow_device.h"
#include "fake/fault_script.h"
#include "fake/transport.h"
#include "statistics/random.h"

namespace condyle::host::fake {

/// The time of the next report.
enum class Pacing : std::uint8_t {
  real_time,       ///< at its time, whether or not the previous one was read
  by_consumption,  ///< when the previous one was read; pauses and unplugged time still apply
};

/// Options of a run.
struct RunOptions {
  double rate_Hz = 500;
  std::uint64_t count = 0;  ///< reports; 0: until the motion ends or the user stops it
  Pacing pacing = Pacing::real_time;
  /// Sends nothing for this time after a program starts to read: Linux drops reports of a HID
  /// device in the first 50 ms (usbhid_open in drivers/hid/usbhid/hid-core.c).
  double settle_s = 0;
  double linger_s = 1;     ///< time plugged in after the last report was read
  std::uint64_t seed = 1;  ///< of garbage
};

/// Plays the device over a transport: reports, faults, account. When plugged in, it sends nothing
/// before a program reads. A reader can count the lost reports exactly: the second report waits
/// until the first was read, the last of `count` waits until a reader is ready and has read all
/// others, and random faults spare these two.
class FakeRun {
 public:
  FakeRun(FacebowDevice& device, FaultScript& script, Transport& transport, hal::Clock& clock,
          const RunOptions& options);

  /// Runs to the end, or until `stop` returns true. It calls `stop` every few milliseconds, first
  /// when the device is plugged in. Unplugs the device at the end. InputErrors of motion and
  /// transport.
  void run(const std::function<bool()>& stop);

  /// The account so far.
  DeliveryLog delivery_log() const;
  /// Number of reports so far.
  std::uint64_t made() const { return delivery_log_.made; }

 private:
  bool serve_while(const std::function<bool()>& condition);
  bool serve_until(TimeNs time_ns);
  bool wait_until_taken();
  bool plug_and_wait();
  bool step();
  bool before_report(const Fault& fault);
  bool unplug_and_replug(const Fault& fault);
  void spoil(FacebowReport& report, const Fault& fault, Packet& packet);
  void flush();

  FacebowDevice& device_;
  FaultScript& script_;
  Transport& transport_;
  hal::Clock& clock_;
  RunOptions options_;
  RandomGenerator random_;
  std::function<bool()> stop_;
  DeliveryLog delivery_log_;      // without deliveries
  std::uint64_t failed_ = 0;      // reports in transfers that failed
  TimeNs origin_ns_ = 0;          // on clock_, of the device's time
  TimeNs due_ns_ = 0;             // of the next report, since the device was first read
  std::uint64_t burst_left_ = 0;  // reports to hold back, the next included
  std::vector<Packet> held_;
};

}  // namespace condyle::host::fake
