// SPDX-License-Identifier: Apache-2.0
// Slopes of the raw path of a point: those of cubics of least squares through samples on both sides
// of one. A width counts the samples on one side.
//
// What slopes of several widths at one sample say of the speed there:
//   burst     a narrow window's slope differs from a wide one's by more than noise
//   abrupt    from one width to the next narrower one (1.6 times) the slopes change no less than
//             from the width before: they do not converge. On a smooth path the changes fall with
//             the fourth power of the width; on a step they grow. The slope of the narrowest window
//             is taken to be as far away as equal changes lead. Windows that reach beyond 0.4 s
//             are not judged
//   overshoot beside an abrupt change of the speed, as where teeth stop the jaw, the slope of a
//             cubic exceeds the speed by up to 9 % of the change, however narrow the window
#pragma once

#include <limits>
#include <map>
#include <utility>

#include "readings/slope_noise.h"
#include "readings/strokes.h"
#include "readings/uncertainty.h"

namespace condyle::host {

/// The points whose slopes are read; `middle`: that of the instrument's points on the jaw.
enum class SpeedPoint { incisor, condyle_left, condyle_right, middle };

/// From one width to the narrower one that is compared with it.
inline constexpr double kNarrower = 1.6;
/// The fewest samples of a window on one side.
inline constexpr int kNarrowest = 2;
/// The speed where there are too few samples.
inline constexpr double kNowhere = -1e300;

/// The raw paths of these points around some samples of a motion, and their slopes. Samples count
/// from first(). `way`: 0 any direction; 1 or -1 up or down.
class WindowSlopes {
 public:
  /// For slopes in `run`. `part`: all, or the incisor only.
  WindowSlopes(const ReferredMotion& motion, SampleRun run, const PoseNoise& noise,
               const SharedErrors& errors, PathPart part);

  std::size_t first() const { return first_; }
  /// The usual time between samples (s); 0: there are too few.
  double step_s() const { return step_s_; }
  const std::vector<double>& time_s() const { return path_.time_s; }
  const Places& places_of(SpeedPoint point) const;
  /// The same with another geometry, of the samples `begin` to `end` (without).
  Places places_of(const ReadingGeometry& geometry, SpeedPoint point, std::size_t begin,
                   std::size_t end) const;
  /// Noise of the point at sample `k`, where it moves with `velocity` (m/s).
  PointNoise noise_of(SpeedPoint point, std::size_t k, const Eigen::Vector3d& velocity) const;

  /// At sample `k`; without weights if there are too few samples.
  Slope slope_at(std::size_t k, int width) const;
  /// The speed of that slope (m/s) of `places`, which must be one of places_of; kNowhere if there
  /// are too few samples. All ways share the velocities.
  double speed_at(const Places& places, std::size_t k, int width, int way);

  /// The velocity (m/s), as in speed_at; its x is kNowhere if there are too few samples.
  const Eigen::Vector3d& velocity_at(const Places& places, std::size_t k, int width);

  /// About the least standard deviation of the difference of two slopes (m/s), in any direction.
  /// 0: not known.
  double least_sd_of_difference(int narrow_width, int width, const PointNoise& noise) const;
  /// Whether at sample `k` the slope of a narrow window exceeds that of one of `width` by more than
  /// `threshold` standard deviations of noise. A change of direction counts, too.
  bool passes_over(const Places& places, std::size_t k, int narrow_width, int width, int way,
                   const PointNoise& noise, double threshold) const;
  /// False if it cannot, as the slopes differ by less than `least_m_s`.
  bool may_pass_over(const Places& places, std::size_t k, int narrow_width, int width,
                     double least_m_s);
  /// How much faster (m/s) the point may be at sample `k` than the slope of `width`, because the
  /// slopes do not converge; 0: they do, or their windows reach too far to tell.
  double abrupt_change_at(const Places& places, std::size_t k, int width, int way,
                          const PointNoise& noise) const;
  /// How far (m/s) the slope at sample `k` may overshoot if the speed changes abruptly less than
  /// `width` samples away.
  double overshoot_at(const Places& places, std::size_t k, int width, int way);

 private:
  SampleRun window_at(std::size_t k, double half_s) const;
  Eigen::Vector3d read_velocity(const Places& places, std::size_t k, int width) const;
  Eigen::Matrix3d noise_of(SpeedPoint point, std::size_t k, const Matrix6& root) const;

  const ReferredMotion& motion_;
  const PoseNoise& noise_;
  const SharedErrors& errors_;
  PathPart part_;
  std::size_t first_ = 0, last_ = 0;  // samples of the paths, last without
  double step_s_ = 0;
  JawPath path_;
  // By places, width and sample.
  std::map<std::pair<const Places*, int>, Places> velocities_;
};

}  // namespace condyle::host
