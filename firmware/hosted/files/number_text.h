// SPDX-License-Identifier: Apache-2.0
// Numbers as text, independent of the locale.
#pragma once

#include <string>
#include <string_view>

#include "condyle/estimator/sample.h"

namespace condyle::host {

/// Times are accepted up to this distance from zero, so that the difference of two fits TimeNs.
inline constexpr double kFurthestTime_s = 4.6e9;

/// Result of reading a number.
enum class NumberStatus { ok, empty, not_a_number, not_finite, overflow };

/// `text` without blanks at either end.
std::string_view trim(std::string_view text);

/// Reads all of `text` as a decimal number; blanks at the ends are ignored.
NumberStatus parse_number(std::string_view text, double& value);

/// Reads all of `text` as seconds into nanoseconds: exactly for plain decimals (rounded to the
/// nearest beyond nine places), through a double if it has an exponent.
NumberStatus parse_time_s(std::string_view text, TimeNs& time_ns);

/// Appends `value` with the fewest digits that read back as the same number. Appends nothing for
/// NaN and infinity, which mean "not computed".
void append_number(std::string& text, double value);

/// Appends nanoseconds as seconds, exactly.
void append_time_s(std::string& text, TimeNs time_ns);

/// `text` fit for a message: cut at 40 characters, unprintable bytes as \xNN.
std::string quote(std::string_view text);

}  // namespace condyle::host
