// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/report/layout_check.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "condyle/hal/report/raw_report.h"
#include "report/field_check.h"

namespace condyle::hal {
namespace {

using MaybeProblem = std::optional<LayoutProblem>;

MaybeProblem place(ProfilePart part, const std::optional<LayoutFault>& fault,
                   std::size_t index = 0) {
  if (!fault) return {};
  return LayoutProblem{.part = part, .index = index, .fault = *fault};
}

// A field and the part it belongs to.
struct Placed {
  const ReportField* field = nullptr;
  ProfilePart part = ProfilePart::coordinates;
  std::size_t index = 0;
};
// The most fields: all coordinates and auxiliary fields, and sequence, time, drive and checksum.
using AllFields = FixedList<Placed, kMaxCoordinates + kMaxAuxiliary + 4>;

AllFields fields_of(const ReportLayout& layout) {
  AllFields all;
  for (std::size_t i = 0; i < layout.coordinates.size(); ++i) {
    all.push_back({&layout.coordinates[i].field, ProfilePart::coordinates, i});
  }
  if (layout.sequence) all.push_back({&layout.sequence->field, ProfilePart::sequence, 0});
  if (layout.device_time) all.push_back({&layout.device_time->field, ProfilePart::device_time, 0});
  if (layout.drive_N) all.push_back({&*layout.drive_N, ProfilePart::drive, 0});
  for (std::size_t i = 0; i < layout.auxiliary.size(); ++i) {
    all.push_back({&layout.auxiliary[i], ProfilePart::auxiliary, i});
  }
  if (layout.checksum) all.push_back({&layout.checksum->field, ProfilePart::checksum, 0});
  return all;
}

MaybeProblem check_fields(const ReportLayout& layout, LayoutState state) {
  AllFields all = fields_of(layout);
  for (const Placed& placed : all) {
    const auto fault = check_field(*placed.field, layout, state);
    if (fault) return place(placed.part, fault, placed.index);
  }
  // Not std::stable_sort, which allocates. Fields with the same start keep their order, so that a
  // problem always names the same field first.
  for (std::size_t i = 1; i < all.size(); ++i) {
    for (std::size_t j = i; j > 0; --j) {
      if (all[j - 1].field->offset_bits <= all[j].field->offset_bits) break;
      std::swap(all[j - 1], all[j]);
    }
  }
  for (std::size_t i = 1; i < all.size(); ++i) {
    const ReportField& before = *all[i - 1].field;
    if (all[i].field->offset_bits < std::uint64_t{before.offset_bits} + before.width_bits) {
      return LayoutProblem{all[i].part, all[i].index, LayoutFault::shares_bits, all[i - 1].part,
                           all[i - 1].index};
    }
  }
  return {};
}

MaybeProblem check_coordinates(const ReportLayout& layout) {
  const std::size_t count = coordinate_count(layout.kind);
  if (layout.coordinates.empty() && (layout.drive_N || !layout.auxiliary.empty())) return {};
  std::array<bool, kMaxCoordinates> is_given{};
  for (std::size_t i = 0; i < layout.coordinates.size(); ++i) {
    const std::size_t index = layout.coordinates[i].index;
    if (index >= count) {
      return place(ProfilePart::coordinates, LayoutFault::no_such_coordinate, i);
    }
    if (is_given[index]) {
      return place(ProfilePart::coordinates, LayoutFault::coordinate_given_twice, i);
    }
    is_given[index] = true;
  }
  for (std::size_t index = 0; index < count; ++index) {
    if (is_given[index]) continue;
    return LayoutProblem{.part = ProfilePart::coordinates,
                         .index = layout.coordinates.size(),
                         .fault = LayoutFault::coordinate_missing,
                         .other_index = index};
  }
  return {};
}

MaybeProblem check_counts(const ReportLayout& layout) {
  constexpr std::uint64_t fewest_counts = 4;  // with fewer, one lost report looks like none
  constexpr std::uint64_t fewest_ticks = 2;
  if (layout.sequence) {
    const auto fault = check_counting(*layout.sequence, fewest_counts);
    if (fault) return place(ProfilePart::sequence, fault);
  }
  if (!layout.device_time) return {};
  auto fault = check_counting(*layout.device_time, fewest_ticks);
  if (!fault) fault = check_clock(*layout.device_time, layout.rate_Hz);
  return place(ProfilePart::device_time, fault);
}

}  // namespace

std::optional<LayoutProblem> find_layout_problem(const ReportLayout& layout, LayoutState state) {
  if (!std::isfinite(layout.rate_Hz) || layout.rate_Hz < 0) {
    return place(ProfilePart::rate, LayoutFault::rate_not_usable);
  }
  const bool is_complete = state == LayoutState::complete;
  if (layout.minimum_size_bytes > kMaxReportSize ||
      (is_complete && layout.minimum_size_bytes == 0)) {
    return place(ProfilePart::minimum_size, LayoutFault::size_not_usable);
  }
  if (is_complete) {
    if (const auto problem = check_coordinates(layout)) return problem;
  }
  if (const auto problem = check_fields(layout, state)) return problem;
  if (const auto problem = check_counts(layout)) return problem;
  if (!layout.checksum) return {};
  return place(ProfilePart::checksum, check_checksum(*layout.checksum, layout.minimum_size_bytes));
}

}  // namespace condyle::hal
