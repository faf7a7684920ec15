// SPDX-License-Identifier: Apache-2.0
// A hum in the noise of a recording: mains, a vibration, a tremor of the jaw. From a rest.
//
//   x    samples of a component at the rest, less their mean
//   P(f) |sum h_k x_k exp(-2 pi i f t_k)|^2, h Hann's window, f = 1/T, 2/T, ... up to half the
//        rate, T the time of the rest
//   line where P exceeds 100 times the median of its 20 neighbours, without the two nearest on each
//        side. Of 800 rests without a hum, none showed a line
//   hum  x = c cos 2 pi f t + s sin 2 pi f t + polynomial of third degree, by least squares, with f
//        near the line, where the residuals of all components, each over its variance, are least
// A hum of less than eight periods in the rest, or of less than 1e-3 of each component's variance,
// is not found.
#pragma once

#include <vector>

#include "readings/pose_track.h"
#include "readings/sample_run.h"

namespace condyle::host {

/// c and s, of the motion's components at its times.
struct Hum {
  double frequency_Hz = 0;
  Vector6 cosine = Vector6::Zero(), sine = Vector6::Zero();  ///< m, rad

  Vector6 variances() const { return (cosine.cwiseAbs2() + sine.cwiseAbs2()) / 2; }
};

/// The part of a rest for which a hum has one frequency and one phase: at most 2,048 samples.
SampleRun middle_of_rest(SampleRun rest);

/// The hums at the rest from `begin` to `end` (without) of `motion`, the strongest line first. At
/// most four.
std::vector<Hum> hums_of(const ReferredMotion& motion, std::size_t begin, std::size_t end);

/// The samples from `begin` to `end` without the `hums`.
ReferredMotion without(const std::vector<Hum>& hums, const ReferredMotion& motion,
                       std::size_t begin, std::size_t end);

}  // namespace condyle::host
