// SPDX-License-Identifier: Apache-2.0
#include "readings/landmark_taking.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

using Eigen::Index;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t kLeastTouched = 5, kBlocks = 5;
constexpr double kMostMotion_m = 1e-3;  // of the tip or the jaw, in what should be a rest
constexpr double kMillimetre = 1e-3;

bool is_of_jaw(std::size_t landmark) {
  return landmark <= Landmarks::incisor_lower;
}

// The places in an interval.
struct Touch {
  Vector3d mean_m;
  double scatter_m = 0, moved_m = 0;
};

Touch touch_of(const std::vector<Vector3d>& places_m) {
  Touch touch{Vector3d::Zero(), 0, 0};
  const std::size_t count = places_m.size();
  for (const Vector3d& place : places_m) touch.mean_m += place / static_cast<double>(count);
  for (const Vector3d& place : places_m) {
    touch.scatter_m += (place - touch.mean_m).squaredNorm() / 3 / static_cast<double>(count);
  }
  touch.scatter_m = std::sqrt(touch.scatter_m);
  // Between the means of parts, so that noise counts little.
  std::array<Vector3d, kBlocks> means;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t begin = block * count / kBlocks, end = (block + 1) * count / kBlocks;
    means[block].setZero();
    for (std::size_t k = begin; k < end; ++k) {
      means[block] += places_m[k] / static_cast<double>(end - begin);
    }
    for (std::size_t other = 0; other < block; ++other) {
      touch.moved_m = std::max(touch.moved_m, (means[block] - means[other]).norm());
    }
  }
  return touch;
}

class LandmarkTaker {
 public:
  LandmarkTaker(const NamedPoints& points, const LandmarkPlan& plan, const std::string& name)
      : points_(points), plan_(plan), name_(name) {}

  TakenLandmarks take() {
    check_plan();
    fit_bodies();
    find_tip();
    find_reference();
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) take_one(i);
    result_.landmarks.condyle_kind = plan_.kind;
    result_.landmarks.plane = plan_.plane;
    return std::move(result_);
  }

 private:
  void check_plan() const {
    std::vector<std::string> lacking;
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
      if (!plan_.at_s[i]) lacking.emplace_back(Landmarks::kNames[i]);
    }
    if (!lacking.empty()) {
      throw InputError(name_, fmt::format("no time is given for {}", fmt::join(lacking, ", ")),
                       fmt::format("add --at {} BEGIN END", lacking[0]));
    }
    if (plan_.bodies.is_given() && !plan_.reference_s) {
      throw InputError("--reference-s", "is not given",
                       "with --jaw or --head state BEGIN END of a rest in the reference position");
    }
  }

  BodyPoses body_of(const std::vector<std::string>& names, const char* what, const char* option) {
    BodyPoses body = fit_body(points_, names, what, option, name_);
    if (!body.problem.empty()) {
      throw InputError(fmt::format("{}: {}", name_, option), body.problem,
                       "name points of one rigid body");
    }
    result_.notes.push_back(fmt::format("{}: {} misfit by {:.3f} mm in 90 % of samples", what,
                                        fmt::join(names, ", "),
                                        body.body.residual_m / kMillimetre));
    return body;
  }

  void fit_bodies() {
    if (!plan_.pointer.empty()) pointer_ = body_of(plan_.pointer, "pointer", "--pointer");
    if (!plan_.bodies.jaw.empty()) jaw_ = body_of(plan_.bodies.jaw, "jaw", "--jaw");
    if (!plan_.bodies.head.empty()) head_ = body_of(plan_.bodies.head, "head", "--head");
    if (!jaw_) {
      result_.notes.emplace_back(
          "the jaw is not tracked: condyles and incisor hold if it was in the reference position "
          "when they were touched");
    }
    if (!head_) {
      result_.notes.emplace_back(
          "the head is not tracked: the landmarks hold as long as it stays where it was");
    }
  }

  void find_tip() {
    if (!pointer_) {
      point_ = points_by_name({plan_.point}, points_.names, "--point")[0];
      return;
    }
    const Isometry3d frame = three_point_frame(pointer_->body.shape_m, "--pointer");
    if (plan_.tip_m) {
      tip_m_ = frame * *plan_.tip_m;
      result_.notes.emplace_back("the tip is taken as stated");
      return;
    }
    std::vector<double> time_s;
    std::vector<Isometry3d> poses;
    for (const std::size_t k : samples_in(*plan_.calibration_s)) {
      if (!pointer_->fits[k].is_fitted) continue;
      time_s.push_back(points_.time_s[k]);
      poses.push_back(pointer_->fits[k].pose);
    }
    const auto [begin_s, end_s] = *plan_.calibration_s;
    PointerTip tip = calibrate_tip(
        time_s, poses, fmt::format("{}: --tip-calibration {:g} {:g}", name_, begin_s, end_s));
    tip_m_ = tip.tip_m;
    tip_sd_m_ = tip.sd_m;
    tip.tip_m = frame.inverse(Eigen::Isometry) * tip.tip_m;
    result_.tip = tip;
  }

  std::vector<std::size_t> samples_in(const TimeSpan& interval_s) const {
    std::vector<std::size_t> samples;
    for (std::size_t k = 0; k < points_.time_s.size(); ++k) {
      if (points_.time_s[k] >= interval_s[0] - 1e-9 && points_.time_s[k] <= interval_s[1] + 1e-9) {
        samples.push_back(k);
      }
    }
    return samples;
  }

  void refuse_if_few(std::size_t count, const std::string& what, const TimeSpan& interval_s) const {
    if (count >= kLeastTouched) return;
    throw InputError(name_,
                     fmt::format("{} {:g} {:g}: it has {} usable samples there", what,
                                 interval_s[0], interval_s[1], count),
                     fmt::format("give an interval with {} or more; the recording lasts from {:g} "
                                 "to {:g} s",
                                 kLeastTouched, points_.time_s.front(), points_.time_s.back()));
  }

  void find_reference() {
    if (!plan_.reference_s) return;
    std::vector<Isometry3d> jaw, head;
    std::vector<std::size_t> used;
    for (const std::size_t k : samples_in(*plan_.reference_s)) {
      if ((jaw_ && !jaw_->fits[k].is_fitted) || (head_ && !head_->fits[k].is_fitted)) continue;
      used.push_back(k);
    }
    refuse_if_few(used.size(), "--reference-s", *plan_.reference_s);
    for (const std::size_t k : used) {
      if (head_) head.push_back(head_->fits[k].pose);
    }
    if (head_) {
      head_at_ = mean_pose(head, 0, head.size());
      state_body(*head_, head_at_, result_.landmarks.head);
    }
    if (!jaw_) return;
    std::vector<Vector3d> places_m;
    for (const std::size_t k : used) {
      const Isometry3d carried =
          head_ ? Isometry3d(head_at_ * head_->fits[k].pose.inverse(Eigen::Isometry))
                : Isometry3d::Identity();
      jaw.push_back(carried * jaw_->fits[k].pose);
      places_m.emplace_back(jaw.back().translation());
    }
    if (const double moved_m = touch_of(places_m).moved_m; moved_m > kMostMotion_m) {
      throw InputError(
          name_,
          fmt::format("the jaw moves by {:.1f} mm during --reference-s", moved_m / kMillimetre),
          "give an interval in which it rests");
    }
    jaw_at_ = mean_pose(jaw, 0, jaw.size());
    state_body(*jaw_, jaw_at_, result_.landmarks.jaw);
  }

  static void state_body(const BodyPoses& body, const Isometry3d& pose, StatedBody& stated) {
    stated.names = body.body.names;
    stated.points_m = pose * body.body.shape_m;
  }

  // The touched place in sample `k`, in the reference position; none if a body is not there.
  std::optional<Vector3d> place_in(std::size_t k, std::size_t landmark) const {
    if (pointer_ && !pointer_->fits[k].is_fitted) return std::nullopt;
    const Vector3d touched_m = pointer_ ? Vector3d(pointer_->fits[k].pose * tip_m_)
                                        : Vector3d(points_.points_m[k].col(point_));
    if (!touched_m.allFinite()) return std::nullopt;
    const bool by_jaw = jaw_ && is_of_jaw(landmark);
    if (!by_jaw && !head_) return touched_m;
    const BodyFit& fit = by_jaw ? jaw_->fits[k] : head_->fits[k];
    if (!fit.is_fitted) return std::nullopt;
    return (by_jaw ? jaw_at_ : head_at_) * (fit.pose.inverse(Eigen::Isometry) * touched_m);
  }

  void take_one(std::size_t landmark) {
    const char* const key = Landmarks::kNames[landmark];
    const TimeSpan& at_s = *plan_.at_s[landmark];
    std::vector<Vector3d> places_m;
    for (const std::size_t k : samples_in(at_s)) {
      if (const auto place = place_in(k, landmark)) places_m.push_back(*place);
    }
    refuse_if_few(places_m.size(), fmt::format("--at {}", key), at_s);
    const Touch touch = touch_of(places_m);
    // What noise alone moves the means of parts by, with 1 in 10,000.
    const double by_noise_m =
        touch.scatter_m * 6 / std::sqrt(static_cast<double>(places_m.size()) / kBlocks);
    if (touch.moved_m > kMostMotion_m && touch.moved_m > std::min(by_noise_m, 3 * kMostMotion_m)) {
      throw InputError(
          name_,
          fmt::format("--at {} {:g} {:g}: the {} moves by {:.1f} mm there", key, at_s[0], at_s[1],
                      pointer_ ? "tip" : "point", touch.moved_m / kMillimetre),
          "give an interval in which it is held still on the landmark");
    }
    result_.landmarks.point_m[landmark] = touch.mean_m;
    // Not divided by the number of samples: a trembling hand is not white noise.
    result_.landmarks.sd_m[landmark] =
        std::hypot(plan_.touch_sd_mm * kMillimetre, touch.scatter_m, tip_sd_m_);
    result_.taken[landmark] = {touch.scatter_m, places_m.size(), at_s[0], at_s[1]};
  }

  const NamedPoints& points_;
  const LandmarkPlan& plan_;
  const std::string& name_;
  std::optional<BodyPoses> pointer_, jaw_, head_;
  Index point_ = 0;
  Vector3d tip_m_ = Vector3d::Zero();
  double tip_sd_m_ = 0;
  Isometry3d jaw_at_ = Isometry3d::Identity(), head_at_ = Isometry3d::Identity();
  TakenLandmarks result_;
};

std::string body_toml(const char* key, const StatedBody& body) {
  if (body.names.empty()) return "";
  std::string numbers;
  for (const double value_m : body.points_m.reshaped()) {
    numbers += fmt::format("{}{:.4f}", numbers.empty() ? "" : ", ", value_m / kMillimetre);
  }
  return fmt::format("{0} = \"{1}\"\n{0}_mm = [{2}]\n", key, fmt::join(body.names, ","), numbers);
}

}  // namespace

TakenLandmarks take_landmarks(const NamedPoints& points, const LandmarkPlan& plan,
                              const std::string& name) {
  refuse_if_short(points.time_s.size(), points.counts, name);
  return LandmarkTaker(points, plan, name).take();
}

std::string landmarks_toml(const TakenLandmarks& taken, const std::string& name) {
  const Landmarks& landmarks = taken.landmarks;
  std::string text = fmt::format("# Taken from {}, in the instrument's frame (mm)\n[landmarks]\n",
                                 clean_line(name));
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    const Vector3d mm = landmarks.point_m[i] / kMillimetre;
    const TakenLandmark& one = taken.taken[i];
    text += fmt::format(
        "{} = [{:.3f}, {:.3f}, {:.3f}]  # {} samples from {:g} to {:g} s, scatter {:.3f} mm\n",
        Landmarks::kNames[i], mm.x(), mm.y(), mm.z(), one.samples, one.begin_s, one.end_s,
        one.scatter_m / kMillimetre);
  }
  const auto greatest = [&](std::size_t begin, std::size_t end) {
    return *std::max_element(landmarks.sd_m.begin() + static_cast<std::ptrdiff_t>(begin),
                             landmarks.sd_m.begin() + static_cast<std::ptrdiff_t>(end)) /
           kMillimetre;
  };
  text += fmt::format("condyle_sd_mm = {:.3f}\nincisor_sd_mm = {:.3f}\nplane_sd_mm = {:.3f}\n",
                      greatest(0, 2), greatest(2, 3), greatest(3, Landmarks::kPoints));
  text += fmt::format("kind = \"{}\"\nplane = \"{}\"\n", landmarks.condyle_kind, landmarks.plane);
  return text + body_toml("jaw_points", landmarks.jaw) + body_toml("head_points", landmarks.head);
}

}  // namespace condyle::host
