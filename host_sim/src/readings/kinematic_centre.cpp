// SPDX-License-Identifier: Apache-2.0
#include "readings/kinematic_centre.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "condyle/estimator/pose/rotation_vector.h"
#include "readings/path_measures.h"
#include "readings/reading_values.h"
#include "statistics/chi_square.h"

namespace condyle::host {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t kLeastPairs = 3;
constexpr double kLeastTravel_m = 6e-3, kOnset_m = 0.3e-3, kStep_m = 0.25e-3, kReach_m = 12e-3;
constexpr double kCommonShare = 0.95;  // of the opening path that a protrusive one is held against
// Steps of the search to each side, and how they get smaller, down to some 5 um; of exact paths, to
// what a double holds.
constexpr int kGrid = 4;
constexpr double kShrink = 3.5, kFinest_m = 5e-6, kFinestExact_m = 1e-10;
constexpr int kDraws = 2;  // pairs of opposite noise for each pair of strokes

// The way out of a stroke: of any point b of the jaw, in the sagittal plane, a + M b.
class WayOut {
 public:
  WayOut(const JawPath& path, std::size_t side) {
    const std::vector<double> travels = sagittal_sizes_of(path.condyle_m[side]);
    const Greatest greatest = greatest_of(path.time_s, travels, 0, travels.size(), kTopReach_s);
    travel_m_ = greatest.value;
    Vector3d last = Vector3d::Constant(1);
    for (std::size_t k = 0; k <= greatest.at; ++k) {
      // Steps of half of kStep_m are fine enough for what is measured.
      const Vector3d& now = path.condyle_m[side][k];
      const double least_m = path.is_exact ? 0 : kStep_m / 2;
      if ((now - last).norm() < least_m && k != greatest.at) continue;
      last = now;
      const Eigen::Matrix3d turn =
          rotation_of<double>(path.rotation_rad[k]) - Eigen::Matrix3d::Identity();
      const Vector3d offset = path.middle_m[k] - turn * path.middle_at_m;
      Pose pose;
      pose.turn << turn.row(0), turn.row(2);
      pose.offset_m << offset.x(), offset.z();
      poses_.push_back(pose);
    }
  }
  double travel_m() const { return travel_m_; }
  std::vector<Vector2d> of(const Vector3d& point_m) const {
    std::vector<Vector2d> way;
    way.reserve(poses_.size());
    for (const Pose& pose : poses_) way.emplace_back(pose.offset_m + pose.turn * point_m);
    return way;
  }

 private:
  struct Pose {
    Eigen::Matrix<double, 2, 3> turn;
    Vector2d offset_m;
  };
  std::vector<Pose> poses_;
  double travel_m_ = 0;
};

// Distance of `point` from the segments at the nearest corner of `line`.
double distance_m(const Vector2d& point, const std::vector<Vector2d>& line) {
  if (line.size() < 2) return 1;
  std::size_t nearest = 0;
  double least = (point - line[0]).squaredNorm();
  for (std::size_t k = 1; k < line.size(); ++k) {
    const double square = (point - line[k]).squaredNorm();
    if (!(square < least)) continue;
    least = square;
    nearest = k;
  }
  for (std::size_t k = std::max<std::size_t>(nearest, 1);
       k <= std::min(nearest + 1, line.size() - 1); ++k) {
    const Vector2d along = line[k] - line[k - 1], from = point - line[k - 1];
    const double square = along.squaredNorm();
    const double share = square > 0 ? std::clamp(from.dot(along) / square, 0.0, 1.0) : 0;
    least = std::min(least, (from - share * along).squaredNorm());
  }
  return std::sqrt(least);
}

// Mean distance of the ways of one point; 1 if it is certainly not below `least_m`.
double misfit_m(const WayOut& opening, const WayOut& protrusion, const Vector3d& point_m,
                double least_m) {
  const std::vector<Vector2d> line = opening.of(point_m), way = protrusion.of(point_m);
  double reach_m = 0, length_m = 0;
  for (const Vector2d& point : line) reach_m = std::max(reach_m, point.norm());
  for (std::size_t k = 1; k < way.size(); ++k) length_m += (way[k] - way[k - 1]).norm();
  const double most_m = least_m * (std::max(length_m - kOnset_m, 0.0) / kStep_m + 2);
  double sum_m = 0, count = 0, next_m = kOnset_m, arc_m = 0;
  for (std::size_t k = 1; k < way.size(); ++k) {
    const double step_m = (way[k] - way[k - 1]).norm();
    for (; next_m <= arc_m + step_m && step_m > 0; next_m += kStep_m) {
      const Vector2d point = way[k - 1] + (next_m - arc_m) / step_m * (way[k] - way[k - 1]);
      if (point.norm() > kCommonShare * reach_m) break;
      sum_m += distance_m(point, line);
      ++count;
    }
    if (sum_m > most_m) return 1;
    arc_m += step_m;
  }
  return count > 0 ? sum_m / count : 1;
}

}  // namespace

std::optional<Vector2d> centre_of_pair_m(const JawPath& opened, const JawPath& protruded,
                                         std::size_t side) {
  const WayOut opening(opened, side), protrusion(protruded, side);
  const Vector3d& condyle = opened.condyle_at_m[side];
  Vector2d best = Vector2d::Zero();
  const double widest_m = kReach_m / kGrid;
  const double finest_m = opened.is_exact ? kFinestExact_m : kFinest_m;
  for (double step_m = widest_m; step_m > finest_m; step_m /= kShrink) {
    const Vector2d middle = best;
    double least_m = 1;
    for (int x = -kGrid; x <= kGrid; ++x) {
      for (int z = -kGrid; z <= kGrid; ++z) {
        const Vector2d shift = middle + step_m * Vector2d(x, z);
        const double misfit =
            misfit_m(opening, protrusion, condyle + Vector3d(shift.x(), 0, shift.y()), least_m);
        if (misfit >= least_m) continue;
        least_m = misfit;
        best = shift;
      }
    }
    if (step_m == widest_m && best.cwiseAbs().maxCoeff() > kReach_m - step_m / 2)
      return std::nullopt;
  }
  return best;
}

namespace {

// A stroke whose noise is drawn anew.
class DrawnStroke {
 public:
  DrawnStroke(const ReferredMotion& motion, SampleRun run, const SharedErrors& errors)
      : fit_(motion.time_s, run.begin, run.end), first_(fit_.used().begin), errors_(errors) {
    const auto time = motion.time_s.begin();
    time_s_.assign(time + static_cast<std::ptrdiff_t>(run.begin),
                   time + static_cast<std::ptrdiff_t>(run.end));
    used_time_s_.assign(time + static_cast<std::ptrdiff_t>(first_),
                        time + static_cast<std::ptrdiff_t>(fit_.used().end));
    measured_ = fitted(motion.motion, 0);
    const LocalFit wide(motion.time_s, first_, fit_.used().end);
    std::vector<Vector6> slopes;
    wide.apply(motion.motion, 0, smoothed_, slopes);
    samples_ = smoothed_;
    once_ = fitted(samples_, first_);
  }
  const JawPath& measured() const { return measured_; }
  /// Smoothed twice, without noise of its own.
  const JawPath& once() const { return once_; }
  /// The same with noise; `sign`: of the noise drawn last.
  void draw(const PoseNoise& noise, RandomGenerator& random) {
    errors_drawn_.clear();
    for (std::size_t k = 0; k < smoothed_.size(); ++k) {
      Vector6 normal;
      for (double& number : normal) number = random.normal();
      errors_drawn_.emplace_back(noise.white_root() * normal);
    }
    add_shared_noise(noise.shared, used_time_s_, random, errors_drawn_);
  }
  JawPath drawn(int sign) {
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      samples_[k] = smoothed_[k] + sign * errors_drawn_[k];
    }
    return fitted(samples_, first_);
  }

 private:
  // Of the `samples` from number `first` on, smoothed.
  JawPath fitted(const std::vector<Vector6>& samples, std::size_t first) const {
    SmoothMotion smooth{time_s_, {}, {}};
    fit_.apply(samples, first, smooth.value, smooth.slope);
    JawPath path;
    paths_of(smooth, errors_.geometry, path);
    return path;
  }

  LocalFit fit_;
  std::size_t first_;  // of the samples that it uses
  const SharedErrors& errors_;
  std::vector<double> time_s_, used_time_s_;
  std::vector<Vector6> smoothed_, samples_, errors_drawn_;
  JawPath measured_, once_;
};

struct Sum {
  double count = 0;
  Eigen::Array2d sum = Eigen::Array2d::Zero(), squares = Eigen::Array2d::Zero();
  void add(const Vector2d& value_m) {
    ++count;
    sum += value_m.array();
    squares += value_m.array().square();
  }
  Eigen::Array2d mean() const { return sum / count; }
  Eigen::Array2d variance() const {
    return ((squares - sum.square() / count) / (count - 1)).max(0.0);
  }
};

bool travels_far(const DrawnStroke& stroke, std::size_t side) {
  return WayOut(stroke.measured(), side).travel_m() >= kLeastTravel_m;
}

}  // namespace

std::array<UncertainValue, 2> kinematic_centre(const ReferredMotion& motion, const PoseNoise& noise,
                                               const SharedErrors& errors,
                                               const std::vector<SampleRun>& openings,
                                               const std::vector<SampleRun>& protrusions,
                                               std::size_t side, RandomGenerator& random) {
  std::array<UncertainValue, 2> centre;
  const auto strokes_of = [&](const std::vector<SampleRun>& runs) {
    std::vector<DrawnStroke> strokes;
    for (const SampleRun& run : runs) {
      DrawnStroke stroke(motion, run, errors);
      if (travels_far(stroke, side)) strokes.push_back(std::move(stroke));
    }
    return strokes;
  };
  std::vector<DrawnStroke> opening = strokes_of(openings), protrusion = strokes_of(protrusions);
  const std::size_t pairs = std::min(opening.size(), protrusion.size());
  const auto withhold = [&centre](const std::string& reason) {
    for (UncertainValue& value : centre) value.missing = reason;
    return centre;
  };
  if (pairs < kLeastPairs) {
    return withhold(
        fmt::format("{} pairs of an opening and a protrusion in which the condyle travels 6 mm, "
                    "at least {} are needed, better 6",
                    pairs, kLeastPairs));
  }
  Sum measured, drawn;
  for (std::size_t i = 0; i < pairs; ++i) {
    const auto here = centre_of_pair_m(opening[i].measured(), protrusion[i].measured(), side);
    const auto once = centre_of_pair_m(opening[i].once(), protrusion[i].once(), side);
    if (!here || !once) return withhold("it lies more than 12 mm from the condylar point");
    measured.add(*here);
    for (int k = 0; k < kDraws; ++k) {
      opening[i].draw(noise, random);
      protrusion[i].draw(noise, random);
      for (const int sign : {1, -1}) {
        const auto again =
            centre_of_pair_m(opening[i].drawn(sign), protrusion[i].drawn(sign), side);
        if (!again) return withhold("noise moves it more than 12 mm from the condylar point");
        drawn.add(*again - *once);
      }
    }
  }
  const double count = static_cast<double>(pairs);
  const double t = student_t_quantile(0.975, count - 1) / kHalf95;
  const Eigen::Array2d between = t * t * measured.variance() / count;
  const Eigen::Array2d noise_variance = drawn.variance() / count;
  for (int i = 0; i < 2; ++i) {
    UncertainValue& value = centre[static_cast<std::size_t>(i)];
    const double bias_m = drawn.mean()[i];
    value.value = 1e3 * (measured.mean()[i] - bias_m);
    value.doubt = 1e3 * std::abs(bias_m);
    value.noise_sd = 1e3 * std::sqrt(std::max(between[i], noise_variance[i]));
    // The centre stays where it is when the condylar point is elsewhere.
    const int axis = 2 * i;
    for (const ReadingGeometry& moved : errors.off_by_one_sd) {
      const auto relative_mm = [&](const ReadingGeometry& geometry) {
        const Vector3d& condyle = errors.geometry.condyle_m[side];
        const Vector3d at = condyle + errors.geometry.head.linear() *
                                          Vector3d(measured.mean()[0], 0, measured.mean()[1]);
        return 1e3 * (geometry.head.linear().transpose() * (at - geometry.condyle_m[side]))[axis];
      };
      value.fixed.push_back(relative_mm(moved) - relative_mm(errors.geometry));
    }
  }
  return centre;
}

}  // namespace condyle::host
