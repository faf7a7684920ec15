// SPDX-License-Identifier: Apache-2.0
// The layout of the text that commands print.
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

/// A report with one label and text on each line, the texts in one column.
class ReportText {
 public:
  /// Starts with the banner. `label_width`: columns before the texts.
  explicit ReportText(int label_width) : text_(banner()), label_width_(label_width) {}

  void line(std::string_view label, std::string_view words) {
    text_ += fmt::format("{:<{}}{}\n", label, label_width_, clean_line(words));
  }
  /// Adds complete lines.
  void add(std::string_view lines) { text_ += lines; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int label_width_;
};

}  // namespace condyle::host
