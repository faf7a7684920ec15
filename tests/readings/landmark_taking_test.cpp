// SPDX-License-Identifier: Apache-2.0
// Tips and landmarks from a pointer, against the truth.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "hosted/files/input_error.h"
#include "readings/simulated_bodies.h"

namespace condyle::host {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kRate_Hz = 100;
constexpr double kDegree = std::numbers::pi / 180;
constexpr TimeSpan kCalibration_s = {1, 9}, kReference_s = {10, 11};

TimeSpan touched_s(std::size_t landmark) {
  return {12 + 2 * static_cast<double>(landmark), 13 + 2 * static_cast<double>(landmark)};
}

// A pointer whose tip first rests in a hole, then on each landmark in turn.
struct PointerScene {
  RandomGenerator random;
  PointColumns pointer_m, jaw_m, head_m;  // the pointer's from its tip
  Landmarks truth;
  MovingHead head;
  NamedPoints points;
  LandmarkPlan plan;

  PointerScene(std::uint64_t seed, double noise_m, double tilt_deg = 35)
      : random(seed, 9),
        pointer_m(random_points(4, {0.02, 0.01, 0.14}, 0.03, random)),
        jaw_m(random_points(4, {0.1, 0, -0.05}, 0.025, random)),
        head_m(random_points(4, {0.08, 0, 0.07}, 0.04, random)),
        head(-10, random) {
    truth.point_m = {Vector3d(0, 0.05, 0),
                     {0, -0.05, 0},
                     {0.095, 0, -0.04},
                     {-0.01, 0.055, 0.002},
                     Vector3d(-0.01, -0.055, 0.002),
                     {0.075, 0.033, 0.002}};
    plan.pointer = numbered('S', 4);
    plan.bodies = {numbered('J', 4), numbered('H', 4)};
    plan.calibration_s = kCalibration_s;
    plan.reference_s = kReference_s;
    plan.touch_sd_mm = 0;
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) plan.at_s[i] = touched_s(i);
    for (const auto* const names : {&plan.pointer, &plan.bodies.jaw, &plan.bodies.head}) {
      points.names.insert(points.names.end(), names->begin(), names->end());
    }
    points.names.emplace_back("M");  // at the tip itself
    for (int k = 0; k < 25 * kRate_Hz; ++k) {
      const double time_s = k / kRate_Hz;
      const Isometry3d at = head.at(time_s), jaw = at * jaw_at(time_s);
      Vector3d tip = Vector3d(0.3, 0.2, 0.1);
      if (time_s > kReference_s[0]) {
        const auto landmark = static_cast<std::size_t>(std::clamp((time_s - 11.5) / 2, 0.0, 5.0));
        const bool is_of_jaw = landmark <= Landmarks::incisor_lower;
        tip = (is_of_jaw ? jaw : at) * truth.point_m[landmark];
      }
      const Vector3d turn =
          tilt_deg * kDegree * Vector3d(std::sin(1.9 * time_s), std::sin(1.3 * time_s), 0);
      PointColumns all_m(3, 13);
      all_m << rigid_motion(turn, tip) * pointer_m, jaw * jaw_m, at * head_m, tip;
      add_noise(all_m, noise_m, random);
      points.time_s.push_back(time_s);
      points.points_m.push_back(all_m);
      ++points.counts.samples;
    }
  }

  // The jaw relative to the head: at rest until 11 s, then open by some degrees.
  static Isometry3d jaw_at(double time_s) {
    const double share = std::clamp(time_s - 11, 0.0, 0.9);
    return rigid_motion({0, 0.2 * share, 0}, {0.005 * share, 0, -0.004 * share});
  }

  TakenLandmarks take() { return take_landmarks(points, plan, "simulation"); }
  std::string problem() {
    try {
      take();
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }
};

// What the landmarks are carried to is the mean head of the reference: its points say where it is.
Isometry3d stated_head(const PointerScene& scene, const Landmarks& landmarks) {
  PointBody body(scene.head_m);
  const Vector3d middle_m = scene.head_m.rowwise().mean();
  const BodyFit fit = body.fit(landmarks.head.points_m);
  EXPECT_TRUE(fit.is_fitted);
  return fit.pose * Eigen::Translation3d(-middle_m);
}

TEST(Landmarks, AreExactWhileHeadAndJawMove) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    PointerScene scene(seed, 0);
    const TakenLandmarks taken = scene.take();
    const Isometry3d head = stated_head(scene, taken.landmarks);
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
      EXPECT_LT((taken.landmarks.point_m[i] - head * scene.truth.point_m[i]).norm(), 1e-8)
          << Landmarks::kNames[i] << " " << seed;
      EXPECT_LT(taken.landmarks.sd_m[i], 1e-8);
    }
    EXPECT_LT(taken.tip->residual_rms_m, 1e-9);
    EXPECT_LT(taken.tip->sd_m, 1e-9);
  }
}

// The tip's and each landmark's error along each axis, over its standard deviation: the tip's is
// the greatest of three axes, the landmarks' that of single samples. Beyond 5 of these: 6e-7 for
// each of 20 runs x 21 numbers, a false alarm in 4,000. Half of the intervals must be narrower than
// twice what the errors need, or the test shows nothing.
TEST(Landmarks, DeviateByNoMoreThanTheirStandardDeviations) {
  double squares = 0, tips = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    PointerScene scene(seed, 1e-4);
    const TakenLandmarks taken = scene.take();
    const Isometry3d head = stated_head(scene, taken.landmarks);
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
      const Vector3d error_m = taken.landmarks.point_m[i] - head * scene.truth.point_m[i];
      for (const double error : error_m) EXPECT_LT(std::abs(error), 5 * taken.landmarks.sd_m[i]);
      EXPECT_LT(taken.landmarks.sd_m[i], 2e-3);
    }
    // The true tip is the origin of pointer_m.
    const Isometry3d frame = three_point_frame(scene.pointer_m, "pointer");
    const Vector3d error_m = taken.tip->tip_m - frame.inverse(Eigen::Isometry) * Vector3d::Zero();
    // Its frame is that of the learned shape, which has errors of the noise over the root of the
    // samples, times the lever.
    for (const double error : error_m) {
      EXPECT_LT(std::abs(error), 5 * taken.tip->sd_m + 5e-5);
      squares += error * error / 3;
    }
    tips += taken.tip->sd_m * taken.tip->sd_m;
  }
  EXPECT_GT(squares, 0.02 * tips);
}

TEST(Landmarks, CalibratedTipServesAsAStatedOne) {
  PointerScene scene(3, 1e-5);
  const TakenLandmarks calibrated = scene.take();
  scene.plan.tip_m = calibrated.tip->tip_m;
  scene.plan.calibration_s.reset();
  const TakenLandmarks stated = scene.take();
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    EXPECT_LT((stated.landmarks.point_m[i] - calibrated.landmarks.point_m[i]).norm(), 1e-9);
  }
}

TEST(Landmarks, AlsoByAPointWithoutAPointer) {
  PointerScene scene(4, 0);
  scene.plan.pointer.clear();
  scene.plan.calibration_s.reset();
  scene.plan.point = scene.points.names.back();
  const TakenLandmarks taken = scene.take();
  const Isometry3d head = stated_head(scene, taken.landmarks);
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    EXPECT_LT((taken.landmarks.point_m[i] - head * scene.truth.point_m[i]).norm(), 1e-9);
  }
}

TEST(Landmarks, FileHoldsWhatWasTaken) {
  PointerScene scene(5, 5e-5);
  scene.plan.touch_sd_mm = 1;
  const TakenLandmarks taken = scene.take();
  const Landmarks read = landmarks_from(landmarks_toml(taken, "a\nb"), "l.toml");
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    EXPECT_LT((read.point_m[i] - taken.landmarks.point_m[i]).norm(), 2e-6);
    EXPECT_GE(read.sd_m[i], taken.landmarks.sd_m[i] - 1e-6);
    EXPECT_GE(read.sd_m[i], 1e-3);
  }
  EXPECT_EQ(read.head.names, scene.plan.bodies.head);
  EXPECT_LT((read.jaw.points_m - taken.landmarks.jaw.points_m).norm(), 1e-6);
  EXPECT_EQ(read.condyle_kind, "palpated");
}

TEST(Landmarks, RefuseWhatTheRecordingDoesNotShow) {
  EXPECT_THAT(PointerScene(6, 1e-5, 4).problem(),
              AllOf(HasSubstr("--tip-calibration 1 9"), HasSubstr("does not show where its tip is"),
                    HasSubstr("tilt the pointer")));
  const auto with = [](auto change) {
    PointerScene scene(6, 1e-5);
    change(scene);
    return scene.problem();
  };
  EXPECT_THAT(with([](PointerScene& s) {
                s.plan.calibration_s = {1, 20};
              }),
              HasSubstr("the tip does not stay in one place"));
  EXPECT_THAT(with([](PointerScene& s) {
                s.plan.calibration_s = {1, 1.1};
              }),
              HasSubstr("usable samples"));
  EXPECT_THAT(with([](PointerScene& s) {
                s.plan.at_s[1] = {13, 17};
              }),
              AllOf(HasSubstr("--at condyle_right 13 17: the tip moves by"), HasSubstr("still")));
  EXPECT_THAT(with([](PointerScene& s) {
                s.plan.at_s[1] = {99, 100};
              }),
              AllOf(HasSubstr("0 usable samples"), HasSubstr("lasts from 0 to 24.99 s")));
  EXPECT_THAT(with([](PointerScene& s) { s.plan.at_s[4].reset(); }),
              AllOf(HasSubstr("no time is given for plane_right"),
                    HasSubstr("--at plane_right BEGIN END")));
  EXPECT_THAT(with([](PointerScene& s) { s.plan.reference_s.reset(); }),
              HasSubstr("--reference-s"));
  EXPECT_THAT(with([](PointerScene& s) {
                s.plan.reference_s = {10.5, 12};
              }),
              HasSubstr("the jaw moves by"));
  EXPECT_THAT(with([](PointerScene& s) {
                s.plan.pointer = {"S1", "S2", "H1"};
              }),
              HasSubstr("do not keep their distances"));
  EXPECT_THAT(with([](PointerScene& s) {
                s.plan.pointer = {"S1", "S2", "s3"};
              }),
              HasSubstr("did you mean S3?"));
}

}  // namespace
}  // namespace condyle::host
