// SPDX-License-Identifier: Apache-2.0
#include "hid/layout_text.h"

#include <string>

#include "condyle/hal/report/raw_report.h"

namespace condyle::hal {
namespace {

struct Words {
  std::string reason, mend;
};

const ReportField& field_of(const DeviceProfile& profile, const LayoutProblem& problem) {
  switch (problem.part) {
    case ProfilePart::device_time:
      return profile.device_time->field;
    case ProfilePart::sequence:
      return profile.sequence->field;
    case ProfilePart::checksum:
      return profile.checksum->field;
    case ProfilePart::drive:
      return *profile.drive_N;
    case ProfilePart::auxiliary:
      return profile.auxiliary[problem.index].field;
    case ProfilePart::coordinates:
    case ProfilePart::rate:
    case ProfilePart::minimum_size:
      break;
  }
  return profile.coordinates[problem.index].field;
}

// Words for a problem of a single field; "" for other problems.
Words field_text(LayoutFault fault, const ReportField& field, std::size_t size_bytes) {
  const std::string width = std::to_string(field.width_bits);
  const auto possible = [&] {
    const RawRange range = possible_values(field);
    return std::to_string(range.lowest) + " to " + std::to_string(range.highest);
  };
  switch (fault) {
    case LayoutFault::width_not_usable:
      return {"is " + width + " bits wide", "give 1 to 64"};
    case LayoutFault::floating_width_not_usable:
      return {"is a floating-point number of " + width + " bits", "give 32 or 64"};
    case LayoutFault::big_endian_of_broken_bytes:
      return {"is big-endian, but not of whole bytes",
              "make offset and width multiples of 8, or the byte order little"};
    case LayoutFault::on_report_id:
      return {"overlaps the report id, which is byte 0", "start at byte 1 or later"};
    case LayoutFault::beyond_report:
      return {"reaches beyond the report's " + std::to_string(size_bytes) + " bytes",
              "raise the minimum size, or move the field"};
    case LayoutFault::scale_not_usable:
      return {"has a scale that is zero or not finite", "give the value of one raw unit"};
    case LayoutFault::offset_not_finite:
      return {"has an offset that is not finite", ""};
    case LayoutFault::missing_value_impossible:
      return {"cannot hold the value " + std::to_string(*field.missing) + " (missing)",
              "give a value from " + possible()};
    case LayoutFault::range_impossible:
      return {"has a valid range that its bits cannot hold", "give limits from " + possible()};
    default:
      return {};
  }
}

Words count_text(LayoutFault fault, const CountingField& counting) {
  switch (fault) {
    case LayoutFault::count_not_unsigned:
      return {"is not an unsigned integer", "make it unsigned"};
    case LayoutFault::wraps_beyond_width:
      return {"wraps at more than its bits hold", "leave out wraps_at, or widen the field"};
    case LayoutFault::wraps_too_soon: {
      const std::uint64_t values = counting.wraps_at != 0
                                       ? counting.wraps_at
                                       : std::uint64_t{1} << counting.field.width_bits;
      return {"wraps after " + std::to_string(values) + " values, too few to be useful",
              "leave it out"};
    }
    case LayoutFault::tick_not_usable:
      return {"has ticks shorter than a nanosecond or longer than an hour",
              "correct scale and unit"};
    case LayoutFault::clock_wraps_too_soon:
      return {"wraps before the second report: it cannot give the time",
              "leave it out, or correct unit, width or rate"};
    default:
      return {};
  }
}

Words checksum_text(LayoutFault fault, const Checksum& checksum, std::size_t size_bytes) {
  switch (fault) {
    case LayoutFault::checksum_width_not_usable:
      return {"is " + std::to_string(checksum.width_bits) + " bits wide", "give 8 or 16"};
    case LayoutFault::checksum_field_differs:
      return {"has a field of another width or type", "make it unsigned, as wide as the sum"};
    case LayoutFault::checksum_parameters_too_wide:
      return {"has a polynomial of zero, or a parameter wider than the sum",
              "give them without the polynomial's top bit, at most " +
                  std::to_string((std::uint32_t{1} << checksum.width_bits) - 1)};
    case LayoutFault::checksum_covers_nothing:
      return {"covers no bytes", "give the first and the last byte that it covers"};
    case LayoutFault::checksum_beyond_report:
      return {"covers bytes beyond the report's " + std::to_string(size_bytes),
              "raise the minimum size, or end earlier"};
    case LayoutFault::checksum_covers_itself:
      return {"covers its own bytes", "end before them, or start after"};
    default:
      return {};
  }
}

// "condyle's x1", "the sequence".
std::string name_of(const DeviceProfile& profile, ProfilePart part, std::size_t index) {
  switch (part) {
    case ProfilePart::rate:
      return "the rate";
    case ProfilePart::minimum_size:
      return "the minimum size";
    case ProfilePart::coordinates:
      if (index >= profile.coordinates.size()) return "the coordinates";
      return "condyle's " +
             std::string(coordinate_name(profile.kind, profile.coordinates[index].index));
    case ProfilePart::device_time:
      return "the device time";
    case ProfilePart::sequence:
      return "the sequence";
    case ProfilePart::checksum:
      return "the checksum";
    case ProfilePart::drive:
      return "the drive";
    case ProfilePart::auxiliary:
      if (index >= profile.auxiliary.size()) return "the auxiliary fields";
      return "auxiliary " + profile.auxiliary[index].name;
  }
  return "";
}

Words part_text(const LayoutProblem& problem, const DeviceProfile& profile,
                std::size_t size_bytes) {
  Words words = field_text(problem.fault, field_of(profile, problem), size_bytes);
  if (words.reason.empty() && problem.part == ProfilePart::sequence) {
    words = count_text(problem.fault, *profile.sequence);
  }
  if (words.reason.empty() && problem.part == ProfilePart::device_time) {
    words = count_text(problem.fault, *profile.device_time);
  }
  if (words.reason.empty() && problem.part == ProfilePart::checksum) {
    words = checksum_text(problem.fault, *profile.checksum, size_bytes);
  }
  return {name_of(profile, problem.part, problem.index) + " " + words.reason, words.mend};
}

}  // namespace

ProfileProblem words_of(const LayoutProblem& problem, const DeviceProfile& profile,
                        LayoutState state) {
  const auto with = [&](std::string reason, std::string mend) {
    return ProfileProblem{problem.part, problem.index, std::move(reason), std::move(mend)};
  };
  switch (problem.fault) {
    case LayoutFault::rate_not_usable:
      return with("the rate is negative or not finite", "give reports per second, or leave it out");
    case LayoutFault::size_not_usable:
      return with("reports of " + std::to_string(profile.minimum_size_bytes) + " bytes",
                  "give 1 to " + std::to_string(kMaxReportSize));
    case LayoutFault::no_such_coordinate:
      return with("this kind of sample has no such coordinate", "");
    case LayoutFault::coordinate_given_twice:
      return with(name_of(profile, problem.part, problem.index) + " is given twice",
                  "give it once");
    case LayoutFault::coordinate_missing:
      return with("condyle's " + std::string(coordinate_name(profile.kind, problem.other_index)) +
                      " is missing",
                  "give every coordinate of the kind");
    case LayoutFault::shares_bits:
      return with(name_of(profile, problem.part, problem.index) + " has bits in common with " +
                      name_of(profile, problem.other_part, problem.other_index),
                  "give each bit to one field");
    default:
      break;
  }
  Words words = part_text(problem, profile, size_to_lie_in(profile, state));
  return with(std::move(words.reason), std::move(words.mend));
}

}  // namespace condyle::hal
