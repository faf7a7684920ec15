// SPDX-License-Identifier: Apache-2.0
// Where a movement is more abrupt than the usual smoothing shows: where a narrower one differs from
// it by more than noise does.
//
//   d_k   difference of the two smoothings at sample k (position and rotation)
//   C     covariance of d, from draws of the noise
//   k is abrupt if  d_k' C^-1 d_k > 48: of noise alone, one sample in 10^8 would be if C were
//   exact; it rests on few draws
// What smoothing does to an abrupt sample reaches over its window, so that the samples around it
// count too.
#pragma once

#include <vector>

#include "readings/local_fit.h"

namespace condyle::host {

/// The abrupt samples of a part of a motion.
class AbruptParts {
 public:
  /// Adds a draw of noise, smoothed in both ways.
  void add_noise(const std::vector<Vector6>& narrow, const std::vector<Vector6>& wide);

  /// Whether each sample of `wide` is abrupt; empty if none is, or if no noise was added.
  std::vector<bool> of(const SmoothMotion& narrow, const SmoothMotion& wide) const;

 private:
  Matrix6 sum_ = Matrix6::Zero();
  double count_ = 0;
};

/// `wide`, and `narrow` where `is_narrow`.
SmoothMotion narrowed_where(const std::vector<bool>& is_narrow, const SmoothMotion& narrow,
                            SmoothMotion wide);

}  // namespace condyle::host
