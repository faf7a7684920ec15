// SPDX-License-Identifier: Apache-2.0
// The form of what commands print for people.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>

#include "hosted/files/clean_text.h"

namespace condyle::host {

/// The first line of each report.
inline std::string banner() {
  return fmt::format("condyle {}: research use only; not a diagnosis\n", CONDYLE_VERSION);
}

/// A report in lines of a label and words, all words in one column.
class ReportText {
 public:
  /// It begins with the banner. `label_width`: columns before the words.
  explicit ReportText(int label_width) : text_(banner()), label_width_(label_width) {}

  void line(std::string_view label, std::string_view words) {
    text_ += fmt::format("{:<{}}{}\n", label, label_width_, clean_line(words));
  }
  /// Lines that are complete.
  void add(std::string_view lines) { text_ += lines; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int label_width_;
};

}  // namespace condyle::host
