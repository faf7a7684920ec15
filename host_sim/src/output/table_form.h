// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace condyle::host {

/// How a table of motion is written, where its user may choose.
struct TableForm {
  bool is_in_mm = false;              ///< lengths in mm instead of m, also within units such as m_s
  bool has_decimal_comma = false;     ///< with semicolons between the fields
  std::optional<double> resample_Hz;  ///< empty: one row for each sample
  bool states_unit = false;           ///< the user chose between mm and m

  char separator() const { return has_decimal_comma ? ';' : ','; }
  double lengths_per_m() const { return is_in_mm ? 1000 : 1; }
  /// The same for a format whose usual unit is another.
  double lengths_per_m(double usual) const { return states_unit ? lengths_per_m() : usual; }
  /// `text` is the end of a row from `begin` on, a number.
  void localise(std::string& text, std::string::size_type begin) const {
    if (!has_decimal_comma) return;
    const auto point = text.find('.', begin);
    if (point != std::string::npos) text[point] = ',';
  }
};

}  // namespace condyle::host
