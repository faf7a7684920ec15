// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/hid/descriptor_profile.h"

#include <array>

#include "condyle/hal/hid/profile_check.h"

namespace condyle::hal {
namespace {

constexpr std::uint32_t kUsageX = 0x0001'0030;  // Y and Z follow
constexpr const char* kAxisNames[] = {"X", "Y", "Z"};

struct Candidate {
  const DescribedReport* report = nullptr;
  const DescriptorField* field = nullptr;
  std::uint32_t index = 0;  // in the field
};
using Candidates = std::array<std::vector<Candidate>, 3>;

Candidates find_candidates(const ReportDescriptor& descriptor,
                           std::optional<std::uint8_t> report_id) {
  Candidates found;
  for (const DescribedReport& report : descriptor.reports) {
    if (report.direction != ReportDirection::input) continue;
    if (report_id && report.id != report_id) continue;
    for (const DescriptorField& field : report.fields) {
      if (field.is_constant() || !field.is_variable()) continue;
      for (std::uint32_t i = 0; i < field.count; ++i) {
        const std::uint32_t usage = field.usage_of(i);
        if (usage < kUsageX || usage > kUsageX + 2) continue;
        found[usage - kUsageX].push_back({&report, &field, i});
      }
    }
  }
  return found;
}

// "" if the candidates are one position in metres.
std::string find_fault(const Candidates& found) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string name = kAxisNames[axis];
    if (found[axis].empty()) {
      return "the device describes no " + name +
             ": give the places of the coordinates in the profile";
    }
    if (found[axis].size() > 1) {
      return "the device describes " + std::to_string(found[axis].size()) + " fields as " + name +
             ": choose a report with [report] id, or give the places of the coordinates";
    }
    const DescriptorField& field = *found[axis][0].field;
    if (field.is_relative()) return name + " is relative to the previous report, not a position";
    if (field.unit.code == 0) {
      return name + " has no unit: give the places and the unit of the coordinates";
    }
    if (!field.unit.scale || field.unit.text != "m") {
      return name + " is not a length (unit " +
             (field.unit.text.empty() ? "not known" : field.unit.text) + ")";
    }
    if (found[axis][0].report != found[0][0].report) {
      return name + " is in another report than X: a sample needs both in one report";
    }
  }
  return {};
}

ReportField field_of(const Candidate& candidate, bool is_reversed) {
  const DescriptorField& described = *candidate.field;
  const double sign = is_reversed ? -1 : 1;
  ReportField field;
  field.offset_bits = described.offset_bits + candidate.index * described.width_bits;
  field.width_bits = described.width_bits;
  field.type = described.is_signed() ? FieldType::signed_integer : FieldType::unsigned_integer;
  field.scale = sign * described.unit.scale.value_or(0);
  field.offset = sign * described.unit.offset.value_or(0);
  // As in Linux, an invalid range is ignored.
  if (described.logical_minimum < described.logical_maximum) {
    field.range = {described.logical_minimum, described.logical_maximum};
  }
  return field;
}

}  // namespace

DescriptorProfile complete_from_descriptor(const DeviceProfile& base,
                                           const ReportDescriptor& descriptor) {
  const Candidates found = find_candidates(descriptor, base.report_id);
  if (std::string fault = find_fault(found); !fault.empty()) return {{}, fault};
  const DescribedReport& report = *found[0][0].report;
  DeviceProfile profile = base;
  profile.kind = SampleKind::one_point;
  profile.report_id = report.id;
  if (profile.minimum_size_bytes == 0) profile.minimum_size_bytes = (report.size_bits + 7) / 8;
  const AxisConvention axes = base.descriptor_axes.value_or(kSameAxes);
  profile.descriptor_axes.reset();
  profile.coordinates.clear();
  for (std::size_t i = 0; i < 3; ++i) {
    const Candidate& candidate = found[static_cast<std::size_t>(axes[i].axis)][0];
    profile.coordinates.push_back({field_of(candidate, axes[i].is_reversed), i});
  }
  if (const auto problem = find_problem(profile)) {
    return {{}, problem->reason + "; " + problem->mend};
  }
  return {profile, {}};
}

}  // namespace condyle::hal
