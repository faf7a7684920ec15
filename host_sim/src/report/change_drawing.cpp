// SPDX-License-Identifier: Apache-2.0
#include "report/change_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/html_table.h"
#include "report/html_text.h"

namespace condyle::host {
namespace {

constexpr double kLeft = 56, kTop = 8, kHeight = 120, kColumn = 70;  // px

// Ends of the vertical axis.
struct Span {
  double low = 1e300, high = -1e300;
  void include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double y(double value) const { return kTop + kHeight * (high - value) / (high - low); }
};

std::string shape(std::size_t session, double x, double y) {
  if (session % 2 == 0) {
    return fmt::format("<circle class=\"dot\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>", x, y);
  }
  return fmt::format(
      "<path class=\"dot open\" d=\"M{0:.1f} {2:.1f} L{3:.1f} {1:.1f} L{0:.1f} {4:.1f} L{5:.1f} "
      "{1:.1f} Z\"/>",
      x, y, y - 5, x + 5, y + 5, x - 5);
}

}  // namespace

std::string change_svg(const QuantityComparison& quantity) {
  Span span;
  for (const auto& values : quantity.values) {
    for (const double value : values) span.include(value);
  }
  double smallest = EstimateRow::kNone;
  for (const SessionChange& change : quantity.changes) {
    if (change.from == 0) smallest = std::fmax(smallest, change.smallest);
  }
  if (std::isfinite(smallest)) {
    span.include(quantity.means[0] - smallest);
    span.include(quantity.means[0] + smallest);
  }
  double margin = 0.06 * (span.high - span.low);
  // All the same: the ticks still differ.
  if (margin <= 1e-7 * std::abs(span.high)) margin = span.high == 0 ? 1 : 0.1 * std::abs(span.high);
  span.low -= margin;
  span.high += margin;
  const double width = kLeft + kColumn * static_cast<double>(quantity.values.size());
  std::string text = fmt::format(
      "<svg class=\"change\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {:.0f} {:.0f}\">",
      html_text(quantity.name), width, kTop + kHeight + 24);
  const int digits = digits_for((span.high - span.low) / 4);
  for (const double share : {0.1, 0.5, 0.9}) {
    const double value = span.low + share * (span.high - span.low);
    text += fmt::format(
        "<text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text><line class=\"axis\" "
        "x1=\"{:.0f}\" x2=\"{:.0f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
        kLeft - 6, span.y(value) + 4, rounded(value, digits), kLeft, width, span.y(value),
        span.y(value));
  }
  for (const SessionChange& change : quantity.changes) {
    if (change.from != 0 || !std::isfinite(change.smallest)) continue;
    const double high = span.y(quantity.means[0] + change.smallest);
    const double low = span.y(quantity.means[0] - change.smallest);
    text += fmt::format(
        "<rect class=\"fan\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>",
        kLeft + kColumn * (static_cast<double>(change.to) + 0.1), high, 0.8 * kColumn, low - high);
  }
  for (std::size_t i = 0; i < quantity.values.size(); ++i) {
    const double middle = kLeft + kColumn * (static_cast<double>(i) + 0.5);
    const auto& values = quantity.values[i];
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double share =
          values.size() > 1 ? static_cast<double>(k) / static_cast<double>(values.size() - 1) - 0.5
                            : 0;
      text += shape(i, middle + 0.45 * kColumn * share, span.y(values[k]));
    }
    const double y = span.y(quantity.means[i]);
    text += fmt::format(
        "<line class=\"mean\" x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text x=\"{:.1f}\" y=\"{:.0f}\" text-anchor=\"middle\">{}</text>",
        middle - 0.3 * kColumn, middle + 0.3 * kColumn, y, y, middle, kTop + kHeight + 16, i + 1);
  }
  text += fmt::format("<text x=\"2\" y=\"{:.0f}\">{}</text></svg>", kTop + kHeight + 16,
                      html_text(quantity.unit == "1" ? "" : quantity.unit));
  return text;
}

}  // namespace condyle::host
