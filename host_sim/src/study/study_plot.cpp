// SPDX-License-Identifier: Apache-2.0
#include "study/study_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "report/html_text.h"

namespace condyle::host {
namespace {

constexpr double kWidth = 260, kHeight = 150, kLeft = 66, kRight = 6, kBottom = 20, kTop = 8;
constexpr const char* kColour = "#1b4f8f";

struct Point {
  std::string_view subject;
  double value;
};
// The subjects' means by session, each session in ascending order.
using Columns = std::map<std::string_view, std::vector<Point>>;

bool has_interval(const StudySession& session) {
  return std::isfinite(session.high - session.low);
}

// Between the values beside the place `share` of the way from the first to the last.
double quantile(const std::vector<Point>& sorted, double share) {
  const double place = share * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  const double part = place - static_cast<double>(below);
  return sorted[below].value + part * (sorted[above].value - sorted[below].value);
}

class Axes {
 public:
  Axes(const Columns& columns, const std::vector<StudySession>& sessions, bool is_boxes)
      : columns_(columns) {
    for (const StudySession& session : sessions) {
      if (is_boxes) {
        take(session.mean);
        continue;
      }
      for (const double value : session.values) take(value);
      if (has_interval(session)) take(session.low), take(session.high);
    }
    margin_ = high_ > low_ ? 0.05 * (high_ - low_) : 1;
    low_ -= margin_, high_ += margin_;
  }

  double column_width() const {
    return (kWidth - kLeft - kRight) / static_cast<double>(columns_.size());
  }
  double x_of(std::string_view session) const {
    const auto at = std::distance(columns_.begin(), columns_.find(session));
    return kLeft + (static_cast<double>(at) + 0.5) * column_width();
  }
  double y_of(double value) const {
    return kHeight - kBottom - (value - low_) / (high_ - low_) * (kHeight - kBottom - kTop);
  }

  std::string draw(const std::string& title) const {
    std::string svg = fmt::format(
        "<svg width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
        "aria-label=\"{2}\">\n<path d=\"M{3} {4}V{5}H{6}\" fill=\"none\" stroke=\"#888\"/>\n",
        kWidth, kHeight, html_text(title), kLeft, kTop, kHeight - kBottom, kWidth - kRight);
    for (const double value : {low_ + margin_, high_ - margin_}) {
      svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.4g}</text>\n",
                         kLeft - 4, y_of(value) + 4, value);
    }
    for (const auto& [session, points] : columns_) {
      svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                         x_of(session), kHeight - 5, session.empty() ? "all" : html_text(session));
    }
    return svg;
  }

 private:
  void take(double value) { low_ = std::min(low_, value), high_ = std::max(high_, value); }

  const Columns& columns_;
  double low_ = std::numeric_limits<double>::infinity(), high_ = -low_, margin_ = 1;
};

// The subjects stand beside each other, or their intervals would cover each other.
std::string draw_lines(const Axes& axes, const std::vector<StudySession>& sessions,
                       std::size_t subjects) {
  constexpr double kSpread = 0.8;  // of a column, over which the subjects stand
  std::string svg;
  double number = 0;
  for (auto session = sessions.begin(); session != sessions.end();) {
    const std::string_view subject = session->subject;
    std::string line, points, bars;
    const double aside =
        kSpread * axes.column_width() * ((number++ + 0.5) / static_cast<double>(subjects) - 0.5);
    for (; session != sessions.end() && session->subject == subject; ++session) {
      const double x = axes.x_of(session->session) + aside, y = axes.y_of(session->mean);
      if (has_interval(*session)) {
        bars += fmt::format("M{:.1f} {:.1f}V{:.1f}", x, axes.y_of(session->low),
                            axes.y_of(session->high));
      }
      line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", x, y);
      points += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\"/>", x, y);
    }
    svg += fmt::format(
        "<g fill=\"{0}\"><title>{1}</title><path d=\"{2}\" fill=\"none\" stroke=\"{0}\" "
        "stroke-opacity=\".2\"/><path d=\"{3}\" stroke=\"{0}\" stroke-opacity=\".6\"/>{4}</g>\n",
        kColour, html_text(subject), line, bars, points);
  }
  return svg;
}

std::string draw_boxes(const Axes& axes, const Columns& columns) {
  const double half_width = std::min(0.3 * axes.column_width(), 14.0);
  std::string svg;
  for (const auto& column : columns) {
    const std::vector<Point>& points = column.second;
    const double x = axes.x_of(column.first);
    const auto y = [&](double share) { return axes.y_of(quantile(points, share)); };
    svg += fmt::format(
        "<g stroke=\"{0}\"><path d=\"M{1:.1f} {2:.1f}V{3:.1f}\"/><rect x=\"{4:.1f}\" "
        "y=\"{5:.1f}\" width=\"{6:.1f}\" height=\"{7:.1f}\" fill=\"#d5e2f1\"/><path "
        "d=\"M{4:.1f} {8:.1f}h{6:.1f}\" stroke-width=\"2\"/></g>\n",
        kColour, x, y(0.025), y(0.975), x - half_width, y(0.75), 2 * half_width, y(0.25) - y(0.75),
        y(0.5));
    for (const Point& point : {points.front(), points.back()}) {
      svg += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2\" fill=\"{}\"><title>{}</title></circle>\n", x,
          axes.y_of(point.value), kColour, html_text(point.subject));
    }
  }
  return svg;
}

}  // namespace

std::string study_plot(const std::string& title, const std::string& unit,
                       const std::vector<StudySession>& sessions) {
  Columns columns;
  std::size_t subjects = 0;
  std::string_view subject;
  for (const StudySession& session : sessions) {
    if (subjects == 0 || session.subject != subject) ++subjects;
    subject = session.subject;
    columns[session.session].push_back({session.subject, session.mean});
  }
  for (auto& [session, points] : columns) {
    std::stable_sort(points.begin(), points.end(),
                     [](const Point& a, const Point& b) { return a.value < b.value; });
  }
  const bool is_boxes = subjects > kMostSubjectsDrawn;
  const Axes axes(columns, sessions, is_boxes);
  return fmt::format("<figure>{}{}</svg><figcaption>{}, {}</figcaption></figure>\n",
                     axes.draw(title),
                     is_boxes ? draw_boxes(axes, columns) : draw_lines(axes, sessions, subjects),
                     html_text(title), html_text(unit));
}

}  // namespace condyle::host
