// SPDX-License-Identifier: Apache-2.0
#include "readings/convex_hull.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "condyle/estimator/pose/rotation_vector.h"
#include "statistics/random.h"

namespace condyle::host {
namespace {

using Eigen::Vector3d;

Vector3d random_vector(RandomGenerator& random) {
  return {random.normal(), random.normal(), random.normal()};
}

// Points in the faces and edges, each twice: in whatever position, they do not disturb.
TEST(ConvexHull, OfABoxFullOfPoints) {
  RandomGenerator random(3);
  for (int run = 0; run < 50; ++run) {
    const Eigen::Matrix3d turn = rotation_of<double>(random_vector(random));
    const Vector3d shift = random_vector(random);
    std::vector<Vector3d> points;
    for (int i = 0; i < 2 * 512; ++i) {
      points.emplace_back(turn * Vector3d(i / 64 % 8 * 0.01, i / 8 % 8 * 0.02, i % 8 * 0.03) +
                          shift);
    }
    const ConvexHull hull = convex_hull(points);
    EXPECT_NEAR(hull.volume, 0.07 * 0.14 * 0.21, 1e-9 * 0.07 * 0.14 * 0.21);
    EXPECT_GE(hull.corners.size(), 8U);
    EXPECT_NEAR(convex_hull(hull.corners).volume, hull.volume, 1e-9 * hull.volume);
  }
}

TEST(ConvexHull, OfPointsInAPlaneIsEmpty) {
  RandomGenerator random(5);
  const Vector3d a = random_vector(random), b = random_vector(random);
  std::vector<Vector3d> points;
  EXPECT_EQ(convex_hull(points).volume, 0);
  for (int i = 0; i < 200; ++i) {
    points.emplace_back(random.normal() * a + random.normal() * b);
    EXPECT_EQ(convex_hull(points).volume, 0);
  }
  EXPECT_EQ(convex_hull(std::vector<Vector3d>(10, a)).volume, 0);
}

// A polyhedron in a sphere whose n points are evenly spread (a Fibonacci lattice) has nearly 2 n
// equal triangles: the gap to the sphere falls with 1/n.
TEST(ConvexHull, OfASphereApproachesIt) {
  double gap = 0;
  for (const int count : {500, 2000, 8000}) {
    std::vector<Vector3d> points;
    for (int i = 0; i < count; ++i) {
      const double z = 1 - (2 * i + 1.0) / count,
                   angle = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
      points.push_back(
          {std::sqrt(1 - z * z) * std::cos(angle), std::sqrt(1 - z * z) * std::sin(angle), z});
    }
    const double now = 4 * std::numbers::pi / 3 - convex_hull(points).volume;
    EXPECT_GT(now, 0);
    if (gap > 0) {
      EXPECT_NEAR(now / gap, 0.25, 0.02);
    }
    gap = now;
  }
}

// More points never make it smaller, and the volume grows with the cube of the size.
TEST(ConvexHull, GrowsWithItsPoints) {
  RandomGenerator random(7);
  for (int run = 0; run < 20; ++run) {
    std::vector<Vector3d> points, tenfold;
    double last = 0;
    for (int i = 0; i < 60; ++i) {
      points.push_back(random_vector(random));
      tenfold.emplace_back(10 * points.back());
      const double now = convex_hull(points).volume;
      EXPECT_GE(now, last * (1 - 1e-8));
      EXPECT_NEAR(convex_hull(tenfold).volume, 1e3 * now, 1e-5 * now);
      last = now;
    }
  }
}

}  // namespace
}  // namespace condyle::host
