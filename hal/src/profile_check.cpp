// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/profile_check.h"

#include <algorithm>
#include <cmath>

#include "condyle/hal/raw_report.h"
#include "field_check.h"

namespace condyle::hal {
namespace {

constexpr const char* kSequenceName = "the sequence";
constexpr const char* kTimeName = "the device time";
constexpr const char* kChecksumName = "the checksum";

// A field, where it belongs and what it is called in messages.
struct Placed {
  const ReportField* field;
  ProfilePart part;
  std::size_t index;
  std::string name;
};

std::vector<Placed> fields_of(const DeviceProfile& profile) {
  std::vector<Placed> all;
  for (std::size_t i = 0; i < profile.coordinates.size(); ++i) {
    all.push_back(
        {&profile.coordinates[i].field, ProfilePart::coordinates, i,
         "condyle's " + std::string(coordinate_name(profile.kind, profile.coordinates[i].index))});
  }
  if (profile.sequence) {
    all.push_back({&profile.sequence->field, ProfilePart::sequence, 0, kSequenceName});
  }
  if (profile.device_time) {
    all.push_back({&profile.device_time->field, ProfilePart::device_time, 0, kTimeName});
  }
  if (profile.drive_N) all.push_back({&*profile.drive_N, ProfilePart::drive, 0, "the drive"});
  for (std::size_t i = 0; i < profile.auxiliary.size(); ++i) {
    all.push_back({&profile.auxiliary[i].field, ProfilePart::auxiliary, i,
                   "auxiliary " + profile.auxiliary[i].name});
  }
  if (profile.checksum) {
    all.push_back({&profile.checksum->field, ProfilePart::checksum, 0, kChecksumName});
  }
  return all;
}

std::optional<ProfileProblem> check_fields(const DeviceProfile& profile) {
  std::vector<Placed> all = fields_of(profile);
  for (const Placed& placed : all) {
    if (auto problem = check_field(*placed.field, profile)) {
      return ProfileProblem{placed.part, placed.index, placed.name + " " + problem->reason,
                            problem->mend};
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Placed& a, const Placed& b) {
    return a.field->offset_bits < b.field->offset_bits;
  });
  for (std::size_t i = 1; i < all.size(); ++i) {
    const ReportField& before = *all[i - 1].field;
    if (all[i].field->offset_bits < std::uint64_t{before.offset_bits} + before.width_bits) {
      return ProfileProblem{all[i].part, all[i].index,
                            all[i].name + " has bits in common with " + all[i - 1].name,
                            "each bit belongs to one field"};
    }
  }
  return {};
}

std::optional<ProfileProblem> check_coordinates(const DeviceProfile& profile) {
  const std::size_t count = coordinate_count(profile.kind);
  const auto problem = [](std::size_t index, std::string reason, std::string mend) {
    return ProfileProblem{ProfilePart::coordinates, index, std::move(reason), std::move(mend)};
  };
  if (profile.descriptor_axes) {
    if (profile.coordinates.empty()) return {};
    return problem(0, "coordinates are given, and asked of the descriptor", "do one of both");
  }
  if (profile.coordinates.empty() && (profile.drive_N || !profile.auxiliary.empty())) return {};
  std::array<bool, 9> is_given{};
  for (std::size_t i = 0; i < profile.coordinates.size(); ++i) {
    const std::size_t index = profile.coordinates[i].index;
    if (index >= count) return problem(i, "this kind of sample has no such coordinate", "");
    if (is_given[index]) {
      return problem(
          i, "condyle's " + std::string(coordinate_name(profile.kind, index)) + " is given twice",
          "give it once");
    }
    is_given[index] = true;
  }
  for (std::size_t index = 0; index < count; ++index) {
    if (is_given[index]) continue;
    return problem(profile.coordinates.size(),
                   "condyle's " + std::string(coordinate_name(profile.kind, index)) + " is missing",
                   "give every coordinate of the kind");
  }
  return {};
}

std::optional<ProfileProblem> check_auxiliary(const DeviceProfile& profile) {
  const auto& all = profile.auxiliary;
  const auto problem = [](std::size_t index, const char* reason, std::string mend) {
    return ProfileProblem{ProfilePart::auxiliary, index, reason, std::move(mend)};
  };
  if (all.size() > kMaxAuxiliary) {
    return problem(kMaxAuxiliary, "too many auxiliary fields",
                   "at most " + std::to_string(kMaxAuxiliary));
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name.empty() || all[i].unit.empty()) {
      return problem(i, "an auxiliary field has no name or unit", "give both");
    }
    const auto is_namesake = [&](const AuxiliaryField& other) { return other.name == all[i].name; };
    const auto end = all.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find_if(all.begin(), end, is_namesake) != end) {
      return problem(i, "two auxiliary fields have the same name", "name each once");
    }
  }
  return {};
}

std::optional<ProfileProblem> place(ProfilePart part, const char* name,
                                    const std::optional<FieldProblem>& found) {
  if (!found) return {};
  return ProfileProblem{part, 0, std::string(name) + " " + found->reason, found->mend};
}

std::optional<ProfileProblem> check_counts(const DeviceProfile& profile) {
  constexpr std::uint64_t fewest_counts = 4;  // with fewer, one lost report looks like none
  constexpr std::uint64_t fewest_ticks = 2;
  if (profile.sequence) {
    auto found = check_counting(*profile.sequence, fewest_counts);
    if (found) return place(ProfilePart::sequence, kSequenceName, found);
  }
  if (!profile.device_time) return {};
  auto found = check_counting(*profile.device_time, fewest_ticks);
  if (!found) found = check_clock(*profile.device_time, profile.rate_Hz);
  return place(ProfilePart::device_time, kTimeName, found);
}

}  // namespace

std::optional<ProfileProblem> find_problem(const DeviceProfile& profile) {
  if (!std::isfinite(profile.rate_Hz) || profile.rate_Hz < 0) {
    return ProfileProblem{ProfilePart::rate, 0, "the rate is negative or not finite",
                          "give reports per second, or leave it out"};
  }
  const bool needs_size = !profile.descriptor_axes;
  if (profile.minimum_size_bytes > kMaxReportSize ||
      (needs_size && profile.minimum_size_bytes == 0)) {
    return ProfileProblem{ProfilePart::minimum_size, 0,
                          "reports of " + std::to_string(profile.minimum_size_bytes) + " bytes",
                          "give 1 to " + std::to_string(kMaxReportSize)};
  }
  if (auto problem = check_coordinates(profile)) return problem;
  if (auto problem = check_auxiliary(profile)) return problem;
  if (auto problem = check_fields(profile)) return problem;
  if (auto problem = check_counts(profile)) return problem;
  if (!profile.checksum) return {};
  return place(ProfilePart::checksum, kChecksumName,
               check_checksum(*profile.checksum, profile.minimum_size_bytes));
}

const char* coordinate_name(SampleKind kind, std::size_t index) {
  constexpr const char* points[] = {"x1", "y1", "z1", "x2", "y2", "z2", "x3", "y3", "z3"};
  constexpr const char* pose[] = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  if (index >= coordinate_count(kind)) return "?";
  if (kind == SampleKind::one_axis) return "position";
  return kind == SampleKind::three_points ? points[index] : pose[index];
}

}  // namespace condyle::hal
