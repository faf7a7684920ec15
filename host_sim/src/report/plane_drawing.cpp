// SPDX-License-Identifier: Apache-2.0
#include "report/plane_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "readings/strokes.h"
#include "report/html_text.h"

namespace condyle::host {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLeastStep_mm = 0.05;

class Drawing {
 public:
  Drawing(const PlaneDrawing& plane, const std::vector<DrawnPath>& paths)
      : plane_(plane), paths_(paths), sign_(plane.is_mirrored ? -1 : 1) {}

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
    for (const DrawnBand& band : plane_.bands) text += area(band);
    for (const DrawnPath& path : paths_) text += line_of(path);
    text += labels();
    if (!plane_.point.empty()) {
      text += fmt::format(
          "<circle class=\"now\" visibility=\"hidden\" r=\"{:.3f}\" data-point=\"{}\" "
          "data-x=\"{}\" data-y=\"{}\" data-sign=\"{:.0f}\"/>",
          font_mm_ / 3, plane_.point, plane_.x, plane_.y, sign_);
    }
    return text + "</svg>";
  }

 private:
  double across_mm(const Eigen::Vector3d& point_m) const { return sign_ * point_m[plane_.x] * 1e3; }
  double up_mm(const Eigen::Vector3d& point_m) const { return point_m[plane_.y] * 1e3; }

  void include(double x, double y) {
    left_ = std::min(left_, x);
    right_ = std::max(right_, x);
    bottom_ = std::min(bottom_, y);
    top_ = std::max(top_, y);
  }

  void find_extent() {
    for (const DrawnPath& path : paths_) {
      for (const auto& piece : path.pieces_m) {
        for (const auto& point_m : piece) include(across_mm(point_m), up_mm(point_m));
      }
    }
    for (const DrawnBand& band : plane_.bands) {
      for (const auto& [x, y] : band.outline_mm) include(sign_ * x, y);
    }
    // Wide enough to be read; the same number of digits on all ticks.
    const double least = 4;
    const double x = (left_ + right_) / 2, y = (bottom_ + top_) / 2;
    include(x - least / 2, y - least / 2);
    include(x + least / 2, y + least / 2);
  }

  std::string area(const DrawnBand& band) const {
    std::string points;
    for (const auto& [x, y] : band.outline_mm)
      points += fmt::format("{:.2f},{:.2f} ", sign_ * x, -y);
    return fmt::format("<polygon class=\"band {}\" points=\"{}\"/>", band.kind, points);
  }

  std::string line_of(const DrawnPath& path) const {
    std::string text;
    for (const auto& piece : path.pieces_m) {
      std::string points;
      double x_mm = 1e9, y_mm = 1e9;
      for (const auto& point_m : piece) {
        const double x = across_mm(point_m), y = up_mm(point_m);
        if (std::hypot(x - x_mm, y - y_mm) < kLeastStep_mm) continue;
        points += fmt::format("{:.2f},{:.2f} ", x, -y);
        x_mm = x;
        y_mm = y;
      }
      // Round ends make a dot of a line without length.
      const bool is_dot = points.find(' ') + 1 == points.size();
      if (is_dot) points += points;
      text += fmt::format("<polyline class=\"path {}{}\" points=\"{}\"/>", path.kind,
                          is_dot ? " dot" : "", points);
    }
    return text;
  }

  std::string axes() const { return line(left_, 0, right_, 0) + line(0, bottom_, 0, top_); }

  // Above the paths, which would hide them.
  std::string labels() const {
    const double span = std::max(right_ - left_, top_ - bottom_);
    const double tick = span > 40 ? 10 : span > 15 ? 5 : span > 6 ? 2 : 1;
    std::string text;
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
    return fmt::format(
        "<path class=\"fan\" d=\"M0 0 L{} L{} Z\"/><path class=\"chord\" d=\"M0 0 L{}\"><title>{}"
        "</title></path>",
        end(angle.low_deg), end(angle.high_deg), end(angle.value_deg), html_text(angle.label));
  }

  const PlaneDrawing& plane_;
  const std::vector<DrawnPath>& paths_;
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
      angles.push_back({fmt::format("{} at {} mm {:.1f} deg, {:.1f} to {:.1f}", name_of(one.task),
                                    travel_mm, one.value, one.low, one.high),
                        static_cast<double>(travel_mm), turn(one.value), turn(one.low),
                        turn(one.high)});
    }
  }
  return angles;
}

}  // namespace

std::string plane_svg(const PlaneDrawing& drawing, const std::vector<DrawnPath>& paths) {
  return Drawing(drawing, paths).svg();
}

std::vector<PlaneDrawing> incisor_drawings(bool named) {
  const auto name = [named](const char* anatomical, const char* axis) {
    return std::string(named ? anatomical : axis);
  };
  return {{name("sagittal, seen from the right", "x and z of point 1"),
           name("anterior", "x"),
           name("up", "z"),
           "incisor",
           nullptr,
           0,
           2,
           false,
           {},
           {}},
          {name("frontal, seen from the front", "y and z of point 1"),
           name("left", "y"),
           name("up", "z"),
           "incisor",
           nullptr,
           1,
           2,
           false,
           {},
           {}},
          {name("horizontal, seen from below", "y and x of point 1"),
           name("left", "y"),
           name("anterior", "x"),
           "incisor",
           nullptr,
           1,
           0,
           false,
           {},
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
    drawings.push_back({fmt::format("{} condyle, sagittal", name_of(side)),
                        "anterior",
                        "up",
                        point,
                        path,
                        0,
                        2,
                        is_left,
                        chords(analysis, "condylar_inclination", side, in_drawing),
                        {}});
  }
  for (const Side side : {Side::right, Side::left}) {
    const bool is_left = side == Side::left;
    // Of the left condyle medial is to the right, y negative; of the right one y positive.
    const double medial = is_left ? -1 : 1;
    drawings.push_back({fmt::format("{} condyle, horizontal", name_of(side)),
                        "left",
                        "anterior",
                        is_left ? "condyle_left" : "condyle_right",
                        &analysis.path.condyle_m[is_left ? 0 : 1],
                        1,
                        0,
                        false,
                        chords(analysis, "bennett_angle", side,
                               [medial](double deg) { return 90 - medial * deg; }),
                        {}});
  }
  return drawings;
}

}  // namespace condyle::host
