// SPDX-License-Identifier: Apache-2.0
#include "inspect/device_inspector.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/report_field.h"
#include "hosted/devices/device_text.h"
#include "inspect/descriptor_text.h"

namespace condyle::host {
namespace {

constexpr std::uint32_t kMostValues = 32;  // shown for one field

// The place of one value of a descriptor's field.
hal::ReportField value_field(const hal::DescriptorField& field, std::uint32_t index) {
  hal::ReportField value;
  value.offset_bits = field.offset_bits + index * field.width_bits;
  value.width_bits = field.width_bits;
  value.type =
      field.is_signed() ? hal::FieldType::signed_integer : hal::FieldType::unsigned_integer;
  return value;
}

struct DescribedValue {
  hal::UsageRange usage;
  double count = 0;
  std::optional<double> value_SI;
  std::string unit;
};

// The bytes of `report`, decoded by the descriptor. Vendor-defined bytes are skipped: they have no
// meaning by themselves.
std::vector<DescribedValue> described_values(const hal::ReportDescriptor& descriptor,
                                             std::uint8_t id, const hal::RawReport& report) {
  std::vector<DescribedValue> values;
  for (const hal::DescribedReport& layout : descriptor.reports) {
    if (layout.direction != hal::ReportDirection::input || layout.id.value_or(0) != id) continue;
    for (const hal::DescriptorField& field : layout.fields) {
      if (field.is_constant() || !field.is_variable() || field.width_bits > 64) continue;
      for (std::uint32_t i = 0; i < std::min(field.count, kMostValues); ++i) {
        const std::uint32_t usage = field.usage_of(i);
        const hal::ReportField position = value_field(field, i);
        if (usage >> 16U >= 0xFF00 || !hal::lies_within(position, report.size)) continue;
        DescribedValue value{
            {usage, usage}, hal::read_value(position, report.data()).value, {}, {}};
        if (field.unit.scale && !field.unit.text.empty()) {
          value.value_SI = value.count * *field.unit.scale + field.unit.offset.value_or(0);
          value.unit = field.unit.text;
        }
        values.push_back(std::move(value));
      }
    }
  }
  return values;
}

std::string bytes_text(const hal::RawReport& report) {
  constexpr std::size_t kInLine = 32;
  std::string text;
  for (std::size_t i = 0; i < report.size; ++i) {
    if (i > 0) text += i % kInLine == 0 ? "\n           " : " ";
    text += fmt::format("{:02x}", report.bytes[i]);
  }
  return text;
}

std::string size_text(const ByteStatistics& watch) {
  return watch.smallest() == watch.largest()
             ? fmt::format("{} bytes", watch.largest())
             : fmt::format("{} to {} bytes", watch.smallest(), watch.largest());
}

}  // namespace

hal::Status DeviceInspector::read(TimeNs deadline_ns, hal::RawReport& report) {
  const hal::Status status = source_.read(deadline_ns, report);
  if (status != hal::Status::ok) return status;
  const bool is_numbered =
      descriptor_ &&
      std::any_of(descriptor_->reports.begin(), descriptor_->reports.end(), [](const auto& layout) {
        return layout.direction == hal::ReportDirection::input && layout.id.has_value();
      });
  watches_[is_numbered ? report.bytes[0] : 0].add(report);
  return status;
}

std::string DeviceInspector::words() const {
  if (watches_.empty()) {
    return "no reports received; many devices send nothing until their own software starts them\n";
  }
  std::string text;
  for (const auto& [id, watch] : watches_) {
    text += id > 0 ? fmt::format("report {}", id) : "reports";
    text +=
        fmt::format(": {}, {} reports; {}\n", size_text(watch), watch.count(), rate_text(watch));
    text += fmt::format("  last     {}\n", bytes_text(watch.last()));
    text += fmt::format("  changed  {}\n", changed_text(watch));
    for (const std::string& words : steady_text(watch)) text += "  steady   " + words + '\n';
    if (!descriptor_) continue;
    for (const DescribedValue& value : described_values(*descriptor_, id, watch.last())) {
      text += fmt::format("  {:<22} {:>10}", usage_text(value.usage), value.count);
      if (value.value_SI) text += fmt::format("  {:.6g} {}", *value.value_SI, value.unit);
      text += '\n';
    }
  }
  return text;
}

nlohmann::ordered_json DeviceInspector::json() const {
  auto reports = nlohmann::ordered_json::array();
  for (const auto& [id, watch] : watches_) {
    nlohmann::ordered_json report = {{"id", id},
                                     {"count", watch.count()},
                                     {"smallest_bytes", watch.smallest()},
                                     {"largest_bytes", watch.largest()},
                                     {"rate_Hz", nullptr},
                                     {"jitter_s", nullptr},
                                     {"p99_interval_s", nullptr},
                                     {"longest_interval_s", nullptr}};
    if (watch.count() > 2) {
      report["rate_Hz"] = watch.rate_Hz();
      report["jitter_s"] = watch.jitter_s();
      report["p99_interval_s"] = seconds(watch.intervals().quantile_ns(0.99));
      report["longest_interval_s"] = seconds(watch.intervals().largest_ns());
    }
    const auto last = watch.last().data();
    report["last"] = std::vector<int>(last.begin(), last.end());
    auto changed = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < watch.largest(); ++i) {
      if (watch.has_changed(i)) changed.push_back(i);
    }
    report["changed_bytes"] = std::move(changed);
    auto steady = nlohmann::ordered_json::array();
    for (const SteadyField& field : watch.steady_fields()) {
      steady.push_back({{"byte", field.offset_bytes},
                        {"width_bytes", field.width_bytes},
                        {"is_big_endian", field.is_big_endian},
                        {"step", field.step}});
    }
    report["steady"] = std::move(steady);
    auto values = nlohmann::ordered_json::array();
    if (descriptor_) {
      for (const DescribedValue& value : described_values(*descriptor_, id, watch.last())) {
        nlohmann::ordered_json json = {{"page", value.usage.first >> 16U},
                                       {"id", value.usage.first & 0xFFFFU},
                                       {"count", value.count},
                                       {"value_SI", nullptr},
                                       {"unit_SI", value.unit}};
        if (value.value_SI) json["value_SI"] = *value.value_SI;
        values.push_back(std::move(json));
      }
    }
    report["values"] = std::move(values);
    reports.push_back(std::move(report));
  }
  return reports;
}

std::string profile_text(const hal::DeviceProfile& profile, const hal::DeviceFacebow& facebow) {
  std::string text = fmt::format("decoded by the profile {}\n", profile.name);
  const hal::ReportCounts& counts = facebow.counts();
  text += "  " + reports_text(profile, counts, facebow.transport_counts()) + '\n';
  if (profile.device_time) text += "  " + clock_text(facebow.clock_fit()) + '\n';
  if (counts.received == 0) return text;
  const hal::DecodedReport& report = facebow.last_report();
  const std::size_t coordinates = profile.measures_position() ? coordinate_count(report.kind) : 0;
  for (std::size_t i = 0; i < coordinates; ++i) {
    const bool is_length = report.kind != SampleKind::pose || i < 3;
    text += fmt::format("  {:<22} {}\n", hal::coordinate_name(report.kind, i),
                        std::isnan(report.coordinates[i])
                            ? "not measured"
                            : fmt::format("{:.4f}{}", report.coordinates[i] * (is_length ? 1e3 : 1),
                                          is_length ? " mm" : ""));
  }
  if (report.sequence) text += fmt::format("  {:<22} {}\n", "counter", *report.sequence);
  if (report.device_time) text += fmt::format("  {:<22} {}\n", "device time", *report.device_time);
  if (report.drive_valid) text += fmt::format("  {:<22} {:.4f} N\n", "drive", report.drive_N);
  for (std::size_t i = 0; i < report.auxiliary_count; ++i) {
    const hal::MeasuredValue& value = report.auxiliary[i];
    text +=
        fmt::format("  {:<22} {}\n", profile.auxiliary[i].name,
                    value.valid ? fmt::format("{:.6g} {}", value.value, profile.auxiliary[i].unit)
                                : "not measured");
  }
  return text;
}

}  // namespace condyle::host
