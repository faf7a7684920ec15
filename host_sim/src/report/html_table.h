// SPDX-License-Identifier: Apache-2.0
// Tables of a report, whose script saves them as CSV.
#pragma once

#include <initializer_list>
#include <string>

namespace condyle::host {

/// Digits after the point that an interval of `half` supports.
int digits_for(double half);
/// `value` with these digits; empty if it is not finite.
std::string rounded(double value, int digits);
/// The letter of a provenance, as HTML.
std::string provenance_mark(const char* provenance);

/// Text is escaped.
class HtmlTable {
 public:
  /// The saved file is called `prefix`_`name`.csv.
  HtmlTable(const std::string& prefix, const char* name,
            std::initializer_list<const char*> columns);
  void begin_row(const char* kind = "");
  void cell(const std::string& words);
  void number_cell(const std::string& digits);
  void html_cell(const std::string& html);
  void end_row();
  /// The table under its heading; nothing without rows.
  std::string html(const char* heading) const;

 private:
  std::string text_;
  bool has_rows_ = false;
};

}  // namespace condyle::host
