// SPDX-License-Identifier: Apache-2.0
#include "recordings/unit_watch.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "hosted/files/input_error.h"
#include "recordings/file_units.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr std::size_t kBlock = 5000, kLeast = 50;
constexpr double kLeastOfMetres_m = 2e-6, kMostOfMetres_m = 0.15e-3, kNearOrigin_m = 10e-3;
constexpr double kMostOfJaw_m = 0.5, kAbsurd_m = 5, kMostNoise = 0.1;

// What a point does in a block of samples: the axis along which it moves farthest.
struct Motion {
  double range_m = 0;   // from the 5 % to the 95 % quantile
  double step_m = 0;    // 90 % of its steps are at most this
  double middle_m = 0;  // the median of the farthest axis
};

class UnitWatch {
 public:
  void add(const double* coordinates_m, std::size_t count) {
    if (is_plausible_) return;
    axes_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (std::isfinite(coordinates_m[i])) axes_[i].push_back(coordinates_m[i]);
    }
    if (++samples_ == kBlock) judge();
  }

  /// Why the unit is in doubt.
  struct Doubt {
    std::string problem;      // empty: it is not
    bool is_certain = false;  // no jaw's positions
    bool is_refuted = false;  // and a jaw's in the other unit, mm or m
  };
  Doubt doubt(bool is_in_metres) {
    if (samples_ >= kLeast) judge();
    if (is_plausible_ || least_range_m_ == 0) return {};
    if (least_range_m_ > kMostOfJaw_m) {
      const bool is_certain = least_range_m_ > kAbsurd_m;
      return {fmt::format("the positions move by {:.3g} m, which no jaw does", least_range_m_),
              is_certain, is_certain && is_in_metres};
    }
    if (!is_smooth_ || most_range_m_ < kLeastOfMetres_m || most_range_m_ > kMostOfMetres_m ||
        farthest_m_ > kNearOrigin_m) {
      return {};
    }
    return {fmt::format("the positions move smoothly and by {:.2g} mm only, as if they were metres "
                        "read as millimetres",
                        most_range_m_ * 1e3),
            true, true};
  }

 private:
  static std::optional<Motion> motion_of(std::vector<double>* axes, std::size_t count) {
    std::optional<Motion> widest;
    double farthest_m = 0;
    for (std::size_t i = 0; i < count; ++i) {
      std::vector<double>& values = axes[i];
      if (values.size() < kLeast) continue;
      std::vector<double> steps;
      steps.reserve(values.size());
      for (std::size_t k = 1; k < values.size(); ++k) {
        steps.push_back(std::abs(values[k] - values[k - 1]));
      }
      Motion motion;
      motion.step_m = lower_quantile(steps, 0.9);
      const double low_m = lower_quantile(values, 0.05);
      motion.range_m = lower_quantile(values, 0.95) - low_m;
      farthest_m = std::max(farthest_m, std::abs(lower_quantile(values, 0.5)));
      if (!widest || motion.range_m > widest->range_m) widest = motion;
    }
    if (widest) widest->middle_m = farthest_m;
    return widest;
  }

  void judge() {
    const std::size_t each = std::min<std::size_t>(axes_.size(), 3);
    double least_m = std::numeric_limits<double>::infinity();
    for (std::size_t first = 0; first + each <= axes_.size() && each > 0; first += each) {
      const std::optional<Motion> motion = motion_of(&axes_[first], each);
      if (!motion) continue;
      least_m = std::min(least_m, motion->range_m);
      most_range_m_ = std::max(most_range_m_, motion->range_m);
      farthest_m_ = std::max(farthest_m_, motion->middle_m);
      is_smooth_ = is_smooth_ || (motion->range_m >= kLeastOfMetres_m &&
                                  motion->step_m < kMostNoise * motion->range_m);
    }
    if (std::isfinite(least_m)) least_range_m_ = std::max(least_range_m_, least_m);
    is_plausible_ = most_range_m_ > kMostOfMetres_m && least_range_m_ <= kMostOfJaw_m;
    for (std::vector<double>& values : axes_) values.clear();
    samples_ = 0;
  }

  std::vector<std::vector<double>> axes_;  // of the block, without missing values
  std::size_t samples_ = 0;                // of the block
  double most_range_m_ = 0, least_range_m_ = 0, farthest_m_ = 0;
  bool is_smooth_ = false, is_plausible_ = false;
};

const Eigen::Matrix3Xd* points_of(const Recording&) {
  return nullptr;
}
const Eigen::Matrix3Xd* points_of(const NamedPointsRecording& recording) {
  return recording.names().empty() ? nullptr : &recording.points_m();
}

template <class Base>
class WatchedBase : public Base {
 public:
  WatchedBase(std::unique_ptr<Base> recording, UnitDoubt doubt, std::string path)
      : recording_(std::move(recording)), doubt_(doubt), path_(std::move(path)) {
    info_ = recording_->info();
  }

  bool next(Sample& sample) override {
    if (!recording_->next(sample)) {
      finish();
      return false;
    }
    if (const Eigen::Matrix3Xd* const points_m = points_of(*recording_)) {
      watch_.add(points_m->data(), static_cast<std::size_t>(points_m->size()));
    } else if (sample.position_valid) {
      watch_.add(sample.coordinates,
                 sample.kind == SampleKind::pose ? 3 : coordinate_count(sample.kind));
    }
    return true;
  }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return recording_->place(); }
  double progress() const override { return recording_->progress(); }

 protected:
  std::unique_ptr<Base> recording_;

 private:
  void finish() {
    info_ = recording_->info();
    const auto unit = length_unit(info_.stated.unit);
    const auto [problem, is_certain, is_refuted] = watch_.doubt(unit && unit->per_metre == 1);
    if (problem.empty() || (doubt_ == UnitDoubt::note && !is_certain)) return;
    if (doubt_ == UnitDoubt::refuse && is_refuted) {
      throw InputError(path_, problem, "give --unit mm or --unit m, the unit that is right");
    }
    info_.notes.push_back(fmt::format("{}; --unit mm or --unit m decides", problem));
  }

  UnitDoubt doubt_;
  std::string path_;
  RecordingInfo info_;
  UnitWatch watch_;
};

class WatchedPoints final : public WatchedBase<NamedPointsRecording> {
 public:
  using WatchedBase::WatchedBase;
  const std::vector<std::string>& names() const override { return recording_->names(); }
  const Eigen::Matrix3Xd& points_m() const override { return recording_->points_m(); }
};

class Watched final : public WatchedBase<Recording> {
 public:
  using WatchedBase::WatchedBase;
};

}  // namespace

std::unique_ptr<Recording> watch_unit(std::unique_ptr<Recording> recording, UnitDoubt doubt,
                                      const std::string& path) {
  if (auto* const named = dynamic_cast<NamedPointsRecording*>(recording.get())) {
    static_cast<void>(recording.release());
    return std::make_unique<WatchedPoints>(std::unique_ptr<NamedPointsRecording>(named), doubt,
                                           path);
  }
  return std::make_unique<Watched>(std::move(recording), doubt, path);
}

}  // namespace condyle::host
