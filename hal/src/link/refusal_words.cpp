// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/link/refusal_words.h"

#include <iterator>

#include "hid/layout_words.h"

namespace condyle::hal {
namespace {

constexpr const char* kOtherVersion = "load an image of this version of condyle";

// Is `value` a part of `whole`?
template <class Whole>
bool is_in(const Whole& whole, const void* value) {
  const auto* const begin = reinterpret_cast<const char*>(&whole);
  const auto* const at = static_cast<const char*>(value);
  return at >= begin && at < begin + sizeof whole;
}

template <class Whole>
bool is_in(const std::optional<Whole>& whole, const void* value) {
  return whole && is_in(*whole, value);
}

// "scale", as profiles call it.
std::string key_of(const ReportField& field, const void* value) {
  if (value == &field.offset_bits) return "offset_bits";
  if (value == &field.width_bits) return "width_bits";
  if (value == &field.type) return "type";
  if (value == &field.byte_order) return "byte_order";
  if (value == &field.scale) return "scale";
  if (value == &field.offset) return "value_offset";
  return is_in(field.missing, value) || value == &field.missing ? "missing" : "valid range";
}

std::string key_of(const CountingField& counting, const void* value) {
  return value == &counting.wraps_at ? "wraps_at" : key_of(counting.field, value);
}

std::string key_of(const Checksum& checksum, const void* value) {
  if (is_in(checksum.field, value)) return key_of(checksum.field, value);
  if (value == &checksum.width_bits) return "width_bits";
  if (value == &checksum.polynomial) return "polynomial";
  if (value == &checksum.initial) return "initial";
  if (value == &checksum.reflects_input) return "reflects_input";
  if (value == &checksum.reflects_output) return "reflects_output";
  if (value == &checksum.final_xor) return "final_xor";
  return value == &checksum.first_byte ? "first_byte" : "last_byte";
}

std::string key_of(const CoordinateField& coordinate, const void* value) {
  return is_in(coordinate.field, value) ? key_of(coordinate.field, value) : "place";
}

// The layout as a profile, whose auxiliary fields have numbers for names.
DeviceProfile profile_of(const ReportLayout& layout) {
  DeviceProfile profile;
  static_cast<ReportContent&>(profile) = layout;
  for (const ReportField& field : layout.auxiliary) {
    profile.auxiliary.push_back({std::to_string(profile.auxiliary.size() + 1), "", field});
  }
  return profile;
}

// "condyle's x1, scale,".
std::string name_of_value(const ReportLayout& layout, const void* value) {
  const DeviceProfile profile = profile_of(layout);
  const auto within = [&](ProfilePart part, std::size_t index, const auto& field) {
    return name_of(profile, part, index) + ", " + key_of(field, value) + ",";
  };
  if (value == &layout.rate_Hz) return name_of(profile, ProfilePart::rate, 0);
  if (value == &layout.minimum_size_bytes) return name_of(profile, ProfilePart::minimum_size, 0);
  if (is_in(layout.report_id, value)) return "the report id";
  if (value == &layout.kind) return "the kind of sample";
  for (std::size_t i = 0; i < layout.coordinates.size(); ++i) {
    if (!is_in(layout.coordinates[i], value)) continue;
    return within(ProfilePart::coordinates, i, layout.coordinates[i]);
  }
  for (std::size_t i = 0; i < layout.auxiliary.size(); ++i) {
    if (!is_in(layout.auxiliary[i], value)) continue;
    return within(ProfilePart::auxiliary, i, layout.auxiliary[i]);
  }
  if (is_in(layout.device_time, value)) {
    return within(ProfilePart::device_time, 0, *layout.device_time);
  }
  if (is_in(layout.sequence, value)) return within(ProfilePart::sequence, 0, *layout.sequence);
  if (is_in(layout.checksum, value)) return within(ProfilePart::checksum, 0, *layout.checksum);
  if (is_in(layout.drive_N, value)) return within(ProfilePart::drive, 0, *layout.drive_N);
  if (value == &layout.restarts_on_reconnect) return "restarts_on_reconnect";
  return "the number or presence of its fields";
}

// "[noise] memory_s".
std::string name_of_value(const StartMessage& start, const void* value) {
  if (value == &start.estimator) return "the estimator";
  if (value == &start.lag) return "the lag";
  if (value == &start.followed.point) return "the followed point";
  if (value == &start.followed.axis) return "the followed axis";
  if (value == &start.nominal_step_ns) return "the nominal step";
  std::string name = "a setting of its parameters";
  const auto look = [&](const char* section, const char* key, const double* values,
                        std::size_t count, const char*, Range) {
    for (std::size_t i = 0; i < count; ++i) {
      if (value != values + i) continue;
      name = *section == '\0' ? key : "[" + std::string(section) + "] " + key;
    }
  };
  if (start.estimator == EstimatorChoice::published) {
    visit_fields(start.published, look);
  } else {
    visit_recommended_fields(start.recommended, look);
  }
  return name;
}

// Of a value: what is wrong with it. Null where the reason is not one value's.
const char* fault_of_value(RefusalReason reason) {
  switch (reason) {
    case RefusalReason::unknown_value:
      return "has an unknown value";
    case RefusalReason::out_of_range:
      return "is out of range";
    case RefusalReason::not_finite:
      return "is not a finite number";
    default:
      return nullptr;
  }
}

std::string reason_of(RefusalReason reason) {
  constexpr const char* words[] = {"no reason",
                                   "wrong size",
                                   "unknown value",
                                   "out of range",
                                   "not a finite number",
                                   "parameters that do not fit together",
                                   "another version of the protocol",
                                   "unknown type of message",
                                   "not expected now",
                                   "unusable layout",
                                   "the layout has no such point",
                                   "a lag that is too long for its memory"};
  const auto index = static_cast<std::size_t>(reason);
  return index < std::size(words) ? words[index] : "unknown reason";
}

bool is_same(const LayoutProblem& a, const LayoutProblem& b) {
  return a.part == b.part && a.index == b.index && a.fault == b.fault &&
         a.other_part == b.other_part && a.other_index == b.other_index;
}

// In words that this side has only for what it would refuse as well.
RefusalWords words_of_problem(const LayoutProblem& problem, const ReportLayout& layout) {
  const DeviceProfile profile = profile_of(layout);
  const auto own = find_layout_problem(layout);
  if (own && is_same(*own, problem)) {
    ProfileProblem words = words_of(problem, profile, LayoutState::complete);
    return {std::move(words.reason), std::move(words.mend)};
  }
  return {name_of(profile, problem.part, problem.index) + " cannot be used by the target (fault " +
              std::to_string(static_cast<int>(problem.fault)) + ")",
          kOtherVersion};
}

template <class Message>
RefusalWords words_of_value(const Refusal& refusal, const Message& message, const auto& named) {
  const void* const value = value_at(message, refusal.index);
  const char* const fault = fault_of_value(refusal.reason);
  if (value == nullptr || fault == nullptr) return {reason_of(refusal.reason), kOtherVersion};
  return {name_of_value(named, value) + " " + fault, kOtherVersion};
}

RefusalWords words_of_lag(int longest, int asked) {
  return {"the target has no memory for a lag of " + std::to_string(asked) + " samples",
          "take a lag of at most " + std::to_string(longest) + ", or a target of more memory"};
}

}  // namespace

RefusalWords words_of(const RefusedMessage& refused, const LayoutMessage& layout,
                      const StartMessage& start) {
  RefusalWords words;
  if (refused.message == static_cast<std::uint8_t>(MessageType::layout)) {
    words = refused.layout_problem ? words_of_problem(*refused.layout_problem, layout.layout)
                                   : words_of_value(refused.refusal, layout, layout.layout);
    words.reason = "the layout: " + words.reason;
  } else if (refused.message == static_cast<std::uint8_t>(MessageType::start)) {
    words = refused.refusal.reason == RefusalReason::lag_too_long
                ? words_of_lag(refused.refusal.index, start.lag)
            : refused.refusal.reason == RefusalReason::cannot_identify
                ? RefusalWords{"the target cannot identify friction and mass",
                               "take a target of more memory, and a recording with a drive"}
                : words_of_value(refused.refusal, start, start);
    words.reason = "the start: " + words.reason;
  } else {
    words = {"message " + std::to_string(refused.message) + ": " +
                 reason_of(refused.refusal.reason) + ", at value " +
                 std::to_string(refused.refusal.index),
             kOtherVersion};
  }
  if (words.mend.empty()) words.mend = kOtherVersion;
  return words;
}

}  // namespace condyle::hal
