// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <string>

#include "condyle/estimator/parameters.h"
#include "number_text.h"

namespace condyle::host {

/// Check of a command-line number: in `range`, and a number (CLI11's own lets NaN pass).
inline CLI::Validator number_in(Range range) {
  return {[range](const std::string& text) {
            double value = 0;
            const bool good =
                parse_number(text, value) == NumberStatus::ok && range.contains(value);
            std::string from, to;
            append_number(from, range.lowest);
            append_number(to, range.highest);
            return good ? "" : quote(text) + " is no number from " + from + " to " + to;
          },
          "NUMBER"};
}

}  // namespace condyle::host
