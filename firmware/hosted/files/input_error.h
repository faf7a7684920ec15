// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

#include "hosted/files/clean_text.h"

namespace condyle::host {

/// Input from the user that cannot be used: states place, problem and remedy. The command prints it
/// and exits with 2.
class InputError : public std::runtime_error {
 public:
  /// A complete message.
  explicit InputError(const std::string& message) : std::runtime_error(clean_line(message)) {}
  /// `where`: "FILE", "FILE:LINE" or "FILE:LINE: column NAME". Control characters, which may come
  /// from the input itself, are shown as \xNN.
  InputError(const std::string& where, const std::string& problem, const std::string& mend)
      : std::runtime_error(clean_line(where + ": " + problem + (mend.empty() ? "" : "; " + mend))) {
  }
};

}  // namespace condyle::host
