// SPDX-License-Identifier: Apache-2.0
// The jaw relative to a moving head, as bodies of any number of points.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "hosted/files/input_error.h"
#include "readings/simulated_bodies.h"
#include "support/acceptance.h"
#include "support/tier.h"

namespace condyle::host {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kRestEnd_s = 0.9;  // of the first rest

JawScenario scenario_at(double rate_Hz) {
  JawScenario scenario;
  for (const JawTaskKind kind : {JawTaskKind::opening, JawTaskKind::left}) {
    scenario.tasks.push_back(default_task(kind));
  }
  scenario.facebow.rate_Hz = rate_Hz;
  return scenario;
}

// A jaw, a head and what an instrument sees of them.
struct Scene {
  KinematicJaw jaw;
  NamedPoints points;
  Landmarks landmarks;  // exact, with the head where it is at 0 s
  BodyChoice bodies;
  AnalysisChoice choice;

  Scene(double rate_Hz, int jaw_count, int head_count) : jaw(scenario_at(rate_Hz)) {
    bodies = {numbered('J', jaw_count), numbered('H', head_count)};
    points.names = bodies.jaw;
    points.names.insert(points.names.end(), bodies.head.begin(), bodies.head.end());
    const JawLandmarks& at = jaw.landmarks();
    landmarks.point_m = {at.condyle_left, at.condyle_right, at.incisor_lower,
                         at.plane_left,   at.plane_right,   at.plane_front};
    landmarks.sd_m.fill(1e-3);
    choice.bodies = bodies;
    choice.reference_s = {0, kRestEnd_s};
    for (const JawTaskSpan& span : jaw.motion().tasks()) {
      choice.tasks.push_back(
          {task_kind(span.name(), "simulation"), span.begin_s, span.end_s, false});
    }
  }

  // Sees the points `jaw_m` and `head_m` of the head frame at the reference position.
  void see(const PointColumns& jaw_m, const PointColumns& head_m, const MovingHead* head,
           double rate_Hz, double noise_m, RandomGenerator& random) {
    points.time_s.clear();
    points.points_m.clear();
    for (int k = 0; k < static_cast<int>(jaw.motion().duration_s() * rate_Hz); ++k) {
      const double time_s = k / rate_Hz;
      const JawPose pose = jaw.pose_at(time_s);
      Isometry3d moved = Isometry3d::Identity();
      moved.linear() = pose.rotation;
      moved.translation() = pose.translation_m;
      const Isometry3d at = head != nullptr ? head->at(time_s) : Isometry3d::Identity();
      PointColumns all_m(3, jaw_m.cols() + head_m.cols());
      all_m << at * (moved * jaw_m), at * head_m;
      add_noise(all_m, noise_m, random);
      points.time_s.push_back(time_s);
      points.points_m.push_back(all_m);
    }
  }

  Analysis analysis(const Landmarks& stated) const {
    PointRecording recording(points);
    return analyse(recording, "simulation", stated, choice);
  }
};

PointColumns jaw_points(int count, RandomGenerator& random) {
  return random_points(count, {0.1, 0, -0.05}, 0.025, random);
}
PointColumns head_points(int count, RandomGenerator& random) {
  return random_points(count, {0.08, 0, 0.07}, 0.04, random);
}

Landmarks moved_by(Landmarks landmarks, const Isometry3d& motion) {
  for (Vector3d& point : landmarks.point_m) point = motion * point;
  return landmarks;
}

void expect_equal(const Analysis& a, const Analysis& b, const std::string& what) {
  ASSERT_EQ(a.readings.size(), b.readings.size()) << what;
  int shown = 0;
  for (std::size_t i = 0; i < a.readings.size(); ++i) {
    const JawReading& one = a.readings[i];
    const JawReading& other = b.readings[i];
    const std::string name =
        fmt::format("{} {} {} {}", what, name_of(one.task), one.definition->name, one.stroke);
    ASSERT_EQ(one.definition, other.definition) << name;
    const bool is_withheld = one.provenance == ReadingProvenance::withheld;
    ASSERT_EQ(is_withheld, other.provenance == ReadingProvenance::withheld)
        << name << one.reason << other.reason;
    if (is_withheld) continue;
    ++shown;
    EXPECT_NEAR(one.value, other.value, 1e-6) << name;
    EXPECT_NEAR(one.low, other.low, 1e-5) << name;
    EXPECT_NEAR(one.high, other.high, 1e-5) << name;
  }
  EXPECT_GT(shown, 30) << what;
}

TEST(Bodies, AMovingHeadChangesNoReading) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    RandomGenerator random(seed, 7);
    const int jaw_count = 3 + static_cast<int>(seed % 4),
              head_count = 3 + static_cast<int>(seed % 3);
    Scene scene(60, jaw_count, head_count);
    const PointColumns jaw_m = jaw_points(jaw_count, random);
    const PointColumns head_m = head_points(head_count, random);
    scene.see(jaw_m, head_m, nullptr, 60, 0, random);
    const Analysis steady = scene.analysis(scene.landmarks);
    // One body: the head is not looked at.
    scene.choice.bodies.head.clear();
    expect_equal(steady, scene.analysis(scene.landmarks), "one body");
    scene.choice.bodies = scene.bodies;
    // Still in the reference position, where the landmarks hold.
    const MovingHead late(kRestEnd_s + 0.05, random);
    scene.see(jaw_m, head_m, &late, 60, 0, random);
    expect_equal(steady, scene.analysis(moved_by(scene.landmarks, late.at(0))), "late");
    // Never still: the landmarks hold with the head's points where they are stated.
    const MovingHead always(-10, random);
    scene.see(jaw_m, head_m, &always, 60, 0, random);
    const Isometry3d elsewhere = rigid_motion(0.3 * random_vector(random), random_vector(random));
    Landmarks stated = moved_by(scene.landmarks, elsewhere);
    stated.head = {scene.bodies.head, elsewhere * head_m};
    expect_equal(steady, scene.analysis(stated), "always");
  }
}

// Lengths and angles of a tracked head rest on where it was when the landmarks were taken; times do
// not.
TEST(Bodies, NameWhatLandmarksWithoutAHeadAssume) {
  RandomGenerator random(61, 7);
  Scene scene(60, 4, 4);
  const PointColumns jaw_m = jaw_points(4, random), head_m = head_points(4, random);
  scene.see(jaw_m, head_m, nullptr, 60, 2e-5, random);
  Landmarks with_head = scene.landmarks;
  with_head.head = {scene.bodies.head, head_m};
  BodyChoice without_head = scene.bodies;
  without_head.head.clear();
  const std::string reference = "with the head where it is in the reference position",
                    since = "not to have moved since the landmarks were taken";
  const struct {
    const Landmarks& landmarks;
    const BodyChoice& bodies;
    std::string assumption;
  } cases[] = {{scene.landmarks, scene.bodies, reference},
               {with_head, scene.bodies, ""},
               {scene.landmarks, without_head, ""},
               {with_head, without_head, since}};
  for (const auto& [landmarks, bodies, assumption] : cases) {
    scene.choice.bodies = bodies;
    int shown = 0;
    for (const JawReading& reading : scene.analysis(landmarks).readings) {
      if (reading.provenance == ReadingProvenance::withheld) continue;
      ++shown;
      const std::string_view unit = reading.definition->unit;
      const bool is_place = unit.starts_with("mm") || unit.starts_with("deg");
      EXPECT_EQ(reading.provenance, !assumption.empty() && is_place ? ReadingProvenance::derived
                                                                    : ReadingProvenance::measured)
          << reading.definition->name << ": " << reading.reason;
      if (!is_place) continue;
      EXPECT_THAT(reading.reason, HasSubstr(assumption));
    }
    EXPECT_GT(shown, 30);
  }
}

TEST(Bodies, MissingPointsChangeNoReading) {
  RandomGenerator random(21, 7);
  Scene scene(60, 5, 6);
  const PointColumns jaw_m = jaw_points(5, random), head_m = head_points(6, random);
  const MovingHead head(kRestEnd_s + 0.05, random);
  scene.see(jaw_m, head_m, &head, 60, 0, random);
  const Landmarks landmarks = moved_by(scene.landmarks, head.at(0));
  const Analysis complete = scene.analysis(landmarks);
  for (PointColumns& all_m : scene.points.points_m) {
    all_m.col(static_cast<Eigen::Index>(random.next() % 5)).setConstant(std::nan(""));
    all_m.col(5 + static_cast<Eigen::Index>(random.next() % 6)).setConstant(std::nan(""));
  }
  const Analysis missing = scene.analysis(landmarks);
  EXPECT_EQ(missing.counts.missing, 0U);
  expect_equal(complete, missing, "missing");
  // Two points are no pose.
  for (std::size_t k = 100; k < 130; ++k)
    scene.points.points_m[k].leftCols(3).setConstant(std::nan(""));
  EXPECT_EQ(scene.analysis(landmarks).counts.missing, 30U);
}

// 95 % intervals with noise, a moving head and uncertain landmarks. A reading fails if so few are
// covered that a true 90 % had a probability of 1e-4; with some 30 readings in each of two cells
// the false-alarm probability is below 1 %, and the seeds are fixed.
TEST(Bodies, IntervalsContainTheTruth) {
  const int runs = testing_support::runs(8, 12, 1000);
  const auto truth = true_readings(Scene(100, 4, 5).jaw);
  for (const double noise_m : {5e-5, 2e-4}) {
    Coverages coverages;
    for (int run = 0; run < runs; ++run) {
      RandomGenerator random(500 + static_cast<std::uint64_t>(run), 7);
      Scene scene(100, 4, 5);
      const PointColumns jaw_m = jaw_points(4, random), head_m = head_points(5, random);
      const MovingHead head(kRestEnd_s + 0.05, random);
      scene.see(jaw_m, head_m, &head, 100, noise_m, random);
      for (PointColumns& all_m : scene.points.points_m) {
        if (random.uniform() < 0.05) all_m.col(1).setConstant(std::nan(""));
      }
      Landmarks stated = scene.landmarks;
      for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
        stated.point_m[i] += stated.sd_m[i] * random_vector(random);
      }
      compare_means(scene.analysis(moved_by(stated, head.at(0))), truth, coverages);
    }
    int judged = 0;
    for (const auto& [key, coverage] : coverages) {
      if (key.ends_with("/displacement_mm") || key.ends_with("/rotation_deg")) continue;
      if (coverage.shown == 0) continue;
      ++judged;
      EXPECT_GE(
          static_cast<std::uint64_t>(coverage.covered),
          testing_support::fewest_hits(static_cast<std::uint64_t>(coverage.shown), 0.90, 1e-4))
          << key << " of " << coverage.shown << " at noise " << noise_m;
    }
    EXPECT_GT(judged, 15);
    EXPECT_EQ(coverages.at("opening//opening_mm").shown, runs);
  }
}

// While one point is gone, the interval is that of the points that are left.
TEST(Bodies, FewerPointsWidenTheIntervals) {
  double half[2];
  for (const bool lacks : {false, true}) {
    RandomGenerator random(31, 7);
    Scene scene(60, 4, 3);
    const PointColumns jaw_m = jaw_points(4, random), head_m = head_points(3, random);
    scene.landmarks.sd_m.fill(0);
    scene.see(jaw_m, head_m, nullptr, 60, 2e-4, random);
    const Task& opening = scene.choice.tasks[0];
    for (std::size_t k = 0; lacks && k < scene.points.time_s.size(); ++k) {
      const double time_s = scene.points.time_s[k];
      if (time_s < opening.begin_s || time_s > opening.end_s) continue;
      scene.points.points_m[k].col(0).setConstant(std::nan(""));
    }
    const Analysis analysis = scene.analysis(scene.landmarks);
    for (const JawReading& reading : analysis.readings) {
      if (reading.definition->name == "opening_mm" && reading.stroke == 0) {
        half[lacks ? 1 : 0] = (reading.high - reading.low) / 2;
      }
    }
  }
  EXPECT_GT(half[1], 1.05 * half[0]);
}

TEST(Bodies, ASlippedMarkerWithholdsEverything) {
  for (const bool on_head : {false, true}) {
    RandomGenerator random(41, 7);
    Scene scene(60, 4, 4);
    scene.see(jaw_points(4, random), head_points(4, random), nullptr, 60, 2e-5, random);
    for (std::size_t k = scene.points.time_s.size() / 2; k < scene.points.time_s.size(); ++k) {
      scene.points.points_m[k].col(on_head ? 6 : 2) += Vector3d(0.002, 0.001, -0.002);
    }
    const Analysis analysis = scene.analysis(scene.landmarks);
    EXPECT_THAT(analysis.unusable, AllOf(HasSubstr(on_head ? "the head" : "the jaw"),
                                         HasSubstr("do not keep their distances")));
    for (const JawReading& reading : analysis.readings) {
      EXPECT_EQ(reading.provenance, ReadingProvenance::withheld);
    }
  }
}

std::string problem_of(const Scene& scene, const Landmarks& landmarks) {
  try {
    scene.analysis(landmarks);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(Bodies, SayWhatIsWrong) {
  RandomGenerator random(51, 7);
  Scene scene(60, 4, 4);
  const PointColumns jaw_m = jaw_points(4, random), head_m = head_points(4, random);
  const MovingHead head(-10, random);
  scene.see(jaw_m, head_m, &head, 60, 2e-5, random);
  Landmarks landmarks = moved_by(scene.landmarks, head.at(0));
  EXPECT_THAT(problem_of(scene, landmarks), AllOf(HasSubstr("the head moves the landmarks"),
                                                  HasSubstr("condyle landmarks --head")));
  scene.choice.bodies = {};
  EXPECT_THAT(problem_of(scene, landmarks),
              AllOf(HasSubstr("not one rigid body"), HasSubstr("--jaw A,B,C")));
  scene.choice.bodies = {{"J1", "J2", "J4", "H1"}, {"H2", "H3", "H44"}};
  EXPECT_THAT(problem_of(scene, landmarks),
              AllOf(HasSubstr("--head: the recording has no point H44; did you mean H4?"),
                    HasSubstr("J1, J2, J3, J4, H1, H2, H3, H4")));
  scene.choice.bodies = {{"J1", "J2", "J3"}, {"J3", "H3", "H4"}};
  EXPECT_THAT(problem_of(scene, landmarks), HasSubstr("the point J3 is also one of --jaw"));
  scene.choice.bodies = scene.bodies;
  landmarks.head = {{"H1", "H2", "X"}, head_m.leftCols(3)};
  EXPECT_THAT(problem_of(scene, landmarks), HasSubstr("head_points has 2 of the points"));
  landmarks.head = {{"H1", "H2", "H3"}, 1.2 * head_m.leftCols(3)};
  EXPECT_THAT(problem_of(scene, landmarks), HasSubstr("take the landmarks again"));
  // The jaw was elsewhere when the landmarks were taken.
  landmarks = scene.landmarks;
  landmarks.head = {scene.bodies.head, head_m};
  landmarks.jaw = {scene.bodies.jaw, rigid_motion({0, 0.1, 0}, {0, 0, -0.003}) * jaw_m};
  EXPECT_THAT(problem_of(scene, landmarks), HasSubstr("state the rest in intercuspation"));
  landmarks.jaw.points_m = jaw_m;
  EXPECT_EQ(problem_of(scene, landmarks), "none");
}

// For points of equal noise the variance of any point of the body grows by at most `growth`. Each
// ratio of two variances of 4000 draws has a standard deviation of 3 %; beyond 15 % is 5 of these.
TEST(PointBody, MissingPointsAddTheStatedNoise) {
  RandomGenerator random(61, 7);
  constexpr int kDraws = 4000;
  for (int body = 0; body < 20; ++body) {
    const int count = 4 + static_cast<int>(random.next() % 4);
    const PointColumns shape_m = random_points(count, {0, 0, 0}, 0.03, random);
    const PointBody known(shape_m);
    const Vector3d lever_m = 0.1 * random_vector(random);
    double squares[2] = {0, 0}, growth = 1;
    for (int draw = 0; draw < kDraws; ++draw) {
      PointColumns noisy_m = shape_m;
      add_noise(noisy_m, 1e-5, random);
      for (int k = 0; k < 2; ++k) {
        if (k == 1) noisy_m.col(0).setConstant(std::nan(""));
        const BodyFit fit = known.fit(noisy_m);
        ASSERT_TRUE(fit.is_fitted);
        const Vector3d middle_m = shape_m.rowwise().mean();
        squares[k] += (fit.pose * (lever_m - middle_m) - lever_m)[0] *
                      (fit.pose * (lever_m - middle_m) - lever_m)[0];
        growth = fit.growth;
      }
    }
    EXPECT_LT(squares[1] / squares[0], growth * 1.15);
    EXPECT_GT(growth, 1);
  }
}

TEST(PointBody, FindsAnyPoseExactly) {
  RandomGenerator random(71, 7);
  for (int run = 0; run < 300; ++run) {
    const int count = 3 + static_cast<int>(random.next() % 6);
    const PointColumns shape_m = random_points(count, random_vector(random), 0.03, random);
    const Isometry3d moved = rigid_motion(3 * random_vector(random), random_vector(random));
    const BodyFit fit = PointBody(shape_m).fit(moved * shape_m);
    ASSERT_TRUE(fit.is_fitted);
    EXPECT_LT(fit.residual_rms_m, 1e-12);
    EXPECT_LT((fit.pose.linear() - moved.linear()).norm(), 1e-11);
    EXPECT_NEAR(fit.pose.linear().determinant(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace condyle::host
