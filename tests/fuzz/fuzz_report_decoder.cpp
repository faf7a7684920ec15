// SPDX-License-Identifier: Apache-2.0
// Any bytes as reports, of the shipped profile or of any usable one: decoded, followed and counted,
// or refused and counted.
#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>
#include <cstdlib>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/report_tracker.h"
#include "hosted/config/device_profile_file.h"

namespace {

using namespace condyle;
using namespace condyle::hal;

// Fields one after the other, so that many profiles are usable.
class ProfileMaker {
 public:
  explicit ProfileMaker(FuzzedDataProvider& data) : data_(data) {}

  DeviceProfile make() {
    DeviceProfile profile;
    profile.rate_Hz = data_.ConsumeBool() ? 500 : 0;
    profile.restarts_on_reconnect = data_.ConsumeBool();
    if (data_.ConsumeBool()) profile.report_id = data_.ConsumeIntegral<std::uint8_t>();
    end_bits_ = profile.report_id ? 8 : 0;
    profile.kind = static_cast<SampleKind>(data_.ConsumeIntegralInRange(0, 3));
    for (std::size_t i = 0; i < coordinate_count(profile.kind); ++i) {
      profile.coordinates.push_back({next_field(), i});
    }
    if (data_.ConsumeBool()) profile.sequence = next_count();
    if (data_.ConsumeBool()) profile.device_time = next_count();
    if (data_.ConsumeBool()) profile.drive_N = next_field();
    for (int i = data_.ConsumeIntegralInRange(0, 3); i > 0; --i) {
      profile.auxiliary.push_back({std::to_string(i), "V", next_field()});
    }
    if (data_.ConsumeBool()) profile.checksum = checksum_after();
    profile.minimum_size_bytes = (end_bits_ + 7) / 8 + data_.ConsumeIntegralInRange(0U, 3U);
    return profile;
  }

 private:
  ReportField next_field() {
    ReportField field;
    field.type = static_cast<FieldType>(data_.ConsumeIntegralInRange(0, 2));
    field.byte_order = data_.ConsumeBool() ? ByteOrder::big : ByteOrder::little;
    field.offset_bits = end_bits_ + data_.ConsumeIntegralInRange(0U, 9U);
    field.width_bits = data_.ConsumeIntegralInRange(1U, 64U);
    if (field.type == FieldType::floating_point) field.width_bits = data_.ConsumeBool() ? 32 : 64;
    if (field.byte_order == ByteOrder::big) {
      field.offset_bits = (field.offset_bits + 7) / 8 * 8;
      field.width_bits = (field.width_bits + 7) / 8 * 8;
    }
    if (data_.ConsumeBool()) field.missing = data_.ConsumeIntegral<std::int16_t>();
    if (data_.ConsumeBool()) field.scale = data_.ConsumeFloatingPoint<double>();
    end_bits_ = field.offset_bits + field.width_bits;
    return field;
  }

  CountingField next_count() {
    CountingField count{next_field(), 0};
    count.field.type = FieldType::unsigned_integer;
    if (data_.ConsumeBool()) count.wraps_at = data_.ConsumeIntegral<std::uint64_t>();
    return count;
  }

  Checksum checksum_after() {
    Checksum checksum;
    checksum.width_bits = data_.ConsumeBool() ? 8 : 16;
    checksum.polynomial = data_.ConsumeIntegral<std::uint8_t>();
    checksum.reflects_input = data_.ConsumeBool();
    checksum.reflects_output = data_.ConsumeBool();
    checksum.end_byte = (end_bits_ + 7) / 8;
    checksum.field.offset_bits = static_cast<std::uint32_t>(checksum.end_byte) * 8;
    checksum.field.width_bits = checksum.width_bits;
    checksum.field.type = FieldType::unsigned_integer;
    end_bits_ = checksum.field.offset_bits + checksum.width_bits;
    return checksum;
  }

  FuzzedDataProvider& data_;
  std::uint32_t end_bits_ = 0;
};

void check(const DecodedReport& report) {
  for (std::size_t i = 0; i < coordinate_count(report.kind); ++i) {
    if (report.position_valid && !std::isfinite(report.coordinates[i])) std::abort();
  }
  if (report.drive_valid && !std::isfinite(report.drive_N)) std::abort();
  for (std::size_t i = 0; i < report.auxiliary_count; ++i) {
    if (report.auxiliary[i].valid != std::isfinite(report.auxiliary[i].value)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const DeviceProfile shipped =
      host::load_device_profile(CONDYLE_SOURCE_DIR "/hal/profiles/condyle_facebow.toml");
  FuzzedDataProvider data(bytes, size);
  const DeviceProfile profile = data.ConsumeBool() ? shipped : ProfileMaker(data).make();
  const bool is_usable = !find_problem(profile);
  const ReportDecoder decoder(layout_of(profile));
  ReportTracker tracker(profile);
  TrackedReport last;
  std::uint64_t reports = 0;
  while (data.remaining_bytes() > 0) {
    if (data.ConsumeIntegralInRange(0, 15) == 0) tracker.reconnect();
    const auto host_time_ns = data.ConsumeIntegral<TimeNs>();
    // In a block of its own size, so that the sanitizer sees a byte too far.
    const std::size_t length = data.ConsumeIntegralInRange<std::size_t>(0, 80);
    const auto report = data.ConsumeBytes<std::uint8_t>(length);
    DecodedReport decoded;
    const ReportFault fault = decoder.decode(report, decoded);
    if ((fault == ReportFault::unusable_profile) == is_usable) std::abort();
    ++reports;
    if (fault != ReportFault::none) {
      tracker.refuse(fault);
      continue;
    }
    check(decoded);
    const TrackedReport now = tracker.accept(decoded, host_time_ns);
    const bool has_last = now.sequence.outcome != SequenceOutcome::first;
    if (has_last && now.sequence.sequence < last.sequence.sequence) std::abort();
    if (has_last && profile.device_time && now.clock.time_ns < last.clock.time_ns) std::abort();
    last = now;
  }
  const ReportCounts& c = tracker.counts();
  if (c.received + c.duplicated + c.other_reports + c.too_short + c.wrong_checksum +
          c.counter_out_of_range + c.unusable_profile !=
      reports) {
    std::abort();
  }
  return 0;
}
