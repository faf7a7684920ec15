// SPDX-License-Identifier: Apache-2.0
#include "report/plane_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "report/html_text.h"

namespace condyle::host {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr std::size_t kMostPoints = 4'000;  // of a drawing

class Drawing {
 public:
  Drawing(const Analysis& analysis, const PlaneDrawing& plane)
      : analysis_(analysis), plane_(plane), sign_(plane.is_mirrored ? -1 : 1) {}

  std::string svg() {
    find_extent();
    const double width = right_ - left_, height = top_ - bottom_;
    font_mm_ = std::max(width, height) / 24;
    const double margin = 2.2 * font_mm_;
    std::string text = fmt::format(
        "<svg class=\"plane\" role=\"img\" aria-label=\"{}\" viewBox=\"{:.3f} {:.3f} {:.3f} "
        "{:.3f}\">",
        html_text(plane_.title), left_ - margin, -top_ - margin, width + 2 * margin,
        height + 2 * margin);
    text += axes();
    for (const DrawnAngle& angle : plane_.angles) text += fan(angle);
    for (const Task& task : analysis_.tasks) text += path_of(task);
    text += fmt::format(
        "<circle class=\"now\" visibility=\"hidden\" r=\"{:.3f}\" data-point=\"{}\" "
        "data-x=\"{}\" data-y=\"{}\" data-sign=\"{:.0f}\"/></svg>",
        font_mm_ / 3, plane_.point, plane_.x, plane_.y, sign_);
    return text;
  }

 private:
  double across_mm(std::size_t k) const { return sign_ * (*plane_.path_m)[k][plane_.x] * 1e3; }
  double up_mm(std::size_t k) const { return (*plane_.path_m)[k][plane_.y] * 1e3; }

  void include(double x, double y) {
    left_ = std::min(left_, x);
    right_ = std::max(right_, x);
    bottom_ = std::min(bottom_, y);
    top_ = std::max(top_, y);
  }

  void find_extent() {
    for (std::size_t k = 0; k < plane_.path_m->size(); ++k) {
      if (is_in_task(k)) include(across_mm(k), up_mm(k));
    }
    // Wide enough to be read; the same number of digits on all ticks.
    const double least = 4;
    const double x = (left_ + right_) / 2, y = (bottom_ + top_) / 2;
    include(x - least / 2, y - least / 2);
    include(x + least / 2, y + least / 2);
  }

  bool is_in_task(std::size_t k) const {
    const double t = analysis_.path.time_s[k];
    return std::any_of(analysis_.tasks.begin(), analysis_.tasks.end(),
                       [t](const Task& task) { return t >= task.begin_s && t <= task.end_s; });
  }

  std::string path_of(const Task& task) const {
    const auto& time_s = analysis_.path.time_s;
    const auto begin = std::lower_bound(time_s.begin(), time_s.end(), task.begin_s);
    const auto end = std::upper_bound(begin, time_s.end(), task.end_s);
    const auto first = static_cast<std::size_t>(begin - time_s.begin());
    const auto last = static_cast<std::size_t>(end - time_s.begin());
    const std::size_t stride = 1 + time_s.size() / kMostPoints;
    std::string points;
    for (std::size_t k = first; k < last; k += stride) {
      points += fmt::format("{:.2f},{:.2f} ", across_mm(k), -up_mm(k));
    }
    const char* const name = task.kind == TaskKind::whole ? "whole" : name_of(task.kind);
    return fmt::format("<polyline class=\"path {}\" points=\"{}\"/>", name, points);
  }

  std::string axes() const {
    const double span = std::max(right_ - left_, top_ - bottom_);
    const double tick = span > 40 ? 10 : span > 15 ? 5 : span > 6 ? 2 : 1;
    std::string text = line(left_, 0, right_, 0) + line(0, bottom_, 0, top_);
    for (double x = std::ceil(left_ / tick) * tick; x <= right_; x += tick) {
      text += label(x, 0, fmt::format("{:g}", sign_ * x + 0.0), 1.1);
    }
    for (double y = std::ceil(bottom_ / tick) * tick; y <= top_; y += tick) {
      if (y != 0) text += label(0, y, fmt::format("{:g}", y), 0.3);
    }
    text += fmt::format(
        "<text font-size=\"{0:.2f}\" x=\"{1:.2f}\" y=\"{2:.2f}\" "
        "text-anchor=\"end\">{3} (mm)</text>",
        font_mm_, right_ + 2 * font_mm_, -bottom_ + 1.9 * font_mm_, html_text(plane_.x_label));
    text += fmt::format("<text font-size=\"{0:.2f}\" x=\"{1:.2f}\" y=\"{2:.2f}\">{3} (mm)</text>",
                        font_mm_, left_ - 2 * font_mm_, -top_ - 1.2 * font_mm_,
                        html_text(plane_.y_label));
    return text;
  }

  static std::string line(double x1, double y1, double x2, double y2) {
    return fmt::format(
        "<line class=\"axis\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>", x1, -y1,
        x2, -y2);
  }

  // `below`: lines of text below the point.
  std::string label(double x, double y, const std::string& words, double below) const {
    return fmt::format("<text font-size=\"{:.2f}\" x=\"{:.2f}\" y=\"{:.2f}\">{}</text>",
                       0.8 * font_mm_, x + 0.2 * font_mm_, -y + below * font_mm_, words);
  }

  std::string fan(const DrawnAngle& angle) const {
    const auto end = [&](double deg) {
      return fmt::format("{:.3f} {:.3f}", angle.length_mm * std::cos(deg * kDegree),
                         -angle.length_mm * std::sin(deg * kDegree));
    };
    // The longest chord carries the label.
    return fmt::format(
        "<path class=\"fan\" d=\"M0 0 L{} L{} Z\"/><path class=\"chord\" d=\"M0 0 L{}\"><title>{}"
        "</title></path>",
        end(angle.low_deg), end(angle.high_deg), end(angle.value_deg), html_text(angle.label));
  }

  const Analysis& analysis_;
  const PlaneDrawing& plane_;
  double sign_;
  double left_ = 0, right_ = 0, bottom_ = 0, top_ = 0, font_mm_ = 1;
};

// The chords of the mean `reading` at 3, 5 and 10 mm of `side`'s condyle. `turn`: from the
// reading's angle (deg) to that of the drawing.
template <class Turn>
std::vector<DrawnAngle> chords(const Analysis& analysis, const std::string& reading, Side side,
                               const Turn& turn) {
  std::vector<DrawnAngle> angles;
  for (const JawReading& one : analysis.readings) {
    if (one.stroke > 0 || one.side != side || !std::isfinite(one.value)) continue;
    for (const int travel_mm : {3, 5, 10}) {
      if (one.definition->name != fmt::format("{}_{}mm_deg", reading, travel_mm)) continue;
      angles.push_back({fmt::format("{} {} mm: {:.1f} deg, {:.1f} to {:.1f}", name_of(one.task),
                                    travel_mm, one.value, one.low, one.high),
                        static_cast<double>(travel_mm), turn(one.value), turn(one.low),
                        turn(one.high)});
    }
  }
  return angles;
}

}  // namespace

std::string plane_svg(const Analysis& analysis, const PlaneDrawing& drawing) {
  return Drawing(analysis, drawing).svg();
}

std::vector<PlaneDrawing> incisor_drawings(const Analysis& analysis) {
  const bool named = analysis.has_landmarks;
  const auto* const path = &analysis.path.incisor_m;
  const auto name = [named](const char* anatomical, const char* axis) {
    return std::string(named ? anatomical : axis);
  };
  return {{name("sagittal, seen from the right", "x and z of point 1"),
           name("anterior", "x"),
           name("up", "z"),
           "incisor",
           path,
           0,
           2,
           false,
           {}},
          {name("frontal, seen from the front", "y and z of point 1"),
           name("left", "y"),
           name("up", "z"),
           "incisor",
           path,
           1,
           2,
           false,
           {}},
          {name("horizontal, seen from below", "y and x of point 1"),
           name("left", "y"),
           name("anterior", "x"),
           "incisor",
           path,
           1,
           0,
           false,
           {}}};
}

std::vector<PlaneDrawing> condyle_drawings(const Analysis& analysis) {
  if (!analysis.has_landmarks) return {};
  std::vector<PlaneDrawing> drawings;
  // Right on the left, as seen from the front; both face the middle.
  for (const Side side : {Side::right, Side::left}) {
    const bool is_left = side == Side::left;
    const auto* const path = &analysis.path.condyle_m[is_left ? 0 : 1];
    const std::string point = is_left ? "condyle_left" : "condyle_right";
    const double mirror = is_left ? -1 : 1;
    const auto in_drawing = [mirror](double deg) {  // downward positive, from anterior
      return mirror > 0 ? -deg : 180 + deg;
    };
    drawings.push_back({fmt::format("{} condyle, sagittal", name_of(side)), "anterior", "up", point,
                        path, 0, 2, is_left,
                        chords(analysis, "condylar_inclination", side, in_drawing)});
  }
  for (const Side side : {Side::right, Side::left}) {
    const bool is_left = side == Side::left;
    // Of the left condyle medial is to the right, y negative; of the right one y positive.
    const double medial = is_left ? -1 : 1;
    drawings.push_back({fmt::format("{} condyle, horizontal", name_of(side)), "left", "anterior",
                        is_left ? "condyle_left" : "condyle_right",
                        &analysis.path.condyle_m[is_left ? 0 : 1], 1, 0, false,
                        chords(analysis, "bennett_angle", side,
                               [medial](double deg) { return 90 - medial * deg; })});
  }
  return drawings;
}

}  // namespace condyle::host
