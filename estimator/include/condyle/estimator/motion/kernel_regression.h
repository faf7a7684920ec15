// SPDX-License-Identifier: Apache-2.0
// Regression that learns while it is used: recursive least squares on linear features and on
// kernels around places where the features have been.
//
//   f       features; the first kPlace of them say where the motion is (no unit)
//   c_i     centres, one for each kernel: features of samples far from all earlier centres
//   k_i     kernel 1 / (1 + |f - c_i|^2 / (8 h^2))^4, h = 0.7: 1 at its centre
//   phi     (f, k_1 .. k_C); w weights, a column for each output; P covariance of the weights
//   y, b    target, and its deviation that is usual (no unit)
//   r       y - w' phi
//
// Learning.  S = phi' P phi + 0.5 max(1, |r|/b) of the first output, which bounds the influence of
//            one sample; q = P phi; w += q r/S, with r of the further outputs limited to +-b;
//            P <- P - q q'/S. Old samples fade: P <- (1 - eta) P + eta I, eta = T/200 s, applied
//            once in kLeak samples.
// Centres.   If no kernel reaches 0.5, the next free kernel is centred at f. If none is free, the
//            least used is moved there, if its mean over 20 s is below 0.004. Its weights become 0
//            and P that of a new one: the old one is marginalised out.
//
// All outputs share P, since they have the same features and the same times.
#pragma once

#include <algorithm>

#include "condyle/estimator/math/arithmetic.h"

namespace condyle {

/// The regression, with two outputs. `kMostKernels`: kernels for which there is memory.
template <class Scalar, int kMostKernels>
class KernelRegression {
 public:
  static_assert(kMostKernels > 0);
  static constexpr int kPlace = 8, kLinear = 20, kOutputs = 2;
  using Features = Array<Scalar, kLinear>;
  using Outputs = Array<Scalar, kOutputs>;

  /// What is known about the outputs at one place.
  struct Prediction {
    Outputs value = {};
    Scalar nearness = 0;  ///< largest kernel, 0 to 1: has such a place been seen?
  };

  KernelRegression() { forget_covariance(); }

  /// Uses at most `kernels` of them, 0 to kMostKernels. Call it before the first `learn`.
  void limit_kernels(int kernels) { kernels_ = kernels; }

  /// The outputs at `features`, which must be finite.
  Prediction predict(const Features& features) {
    evaluate(features);
    Prediction prediction;
    for (int output = 0; output < kOutputs; ++output) {
      prediction.value[output] = dot(weights_[output], basis_, size());
    }
    prediction.nearness = nearness();
    return prediction;
  }

  /// Learns `target`, whose usual deviation is `deviation`, `T` s after the last learned sample.
  void learn(const Features& features, const Outputs& target, const Outputs& deviation, Scalar T) {
    evaluate(features);
    const Scalar fade = std::min(T / kUse_s, Scalar(1));
    for (int i = 0; i < used_; ++i) use_[i] += (basis_[kLinear + i] - use_[i]) * fade;
    if (nearness() < kNovelty) add_centre(features);
    update(target, deviation);
    waiting_leak_ += T / kMemory_s;
    if (++learned_ % kLeak == 0) leak();
  }

  /// Kernels in use.
  int used() const { return used_; }

  /// Calls `visit(name, first, count)` for each array of what was learned: to keep it, or to begin
  /// with it after `begin_with`.
  template <class Visitor>
  void visit_learned(Visitor&& visit) {
    visit("centres", &centres_[0][0], used_ * kPlace);
    visit("use", &use_[0], used_);
    visit("velocity_weights", &weights_[0][0], size());
    visit("acceleration_weights", &weights_[1][0], size());
    visit("covariance", &covariance_[0], size() * (size() + 1) / 2);
  }
  /// Takes `used` kernels, at most those of limit_kernels, into use: visit_learned must then give
  /// finite values, and a covariance with a positive diagonal.
  void begin_with(int used) { used_ = std::min(used, kernels_); }

 private:
  static constexpr int kWeights = kLinear + kMostKernels;
  static constexpr int kEntries = kWeights * (kWeights + 1) / 2;
  static constexpr int kLeak = 64;
  static constexpr Scalar kNovelty = Scalar(0.5), kSeldom = Scalar(0.004);
  static constexpr Scalar kFirstUse = Scalar(0.3), kUse_s = 20, kMemory_s = 200;
  static constexpr Scalar kNoise = Scalar(0.5);
  static constexpr Scalar kInverseWidth = Scalar(1) / (8 * Scalar(0.7) * Scalar(0.7));

  int size() const { return kLinear + used_; }
  // The row `i` of the lower triangle of P.
  Scalar* row(int i) { return &covariance_[i * (i + 1) / 2]; }

  // Four sums side by side: one order of operations, which a processor can overlap.
  static Scalar dot(const Scalar* a, const Scalar* b, int n) {
    Scalar s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    int i = 0;
    for (; i + 4 <= n; i += 4) {
      s0 += a[i] * b[i];
      s1 += a[i + 1] * b[i + 1];
      s2 += a[i + 2] * b[i + 2];
      s3 += a[i + 3] * b[i + 3];
    }
    for (; i < n; ++i) s0 += a[i] * b[i];
    return (s0 + s1) + (s2 + s3);
  }

  void evaluate(const Features& features) {
    for (int i = 0; i < kLinear; ++i) basis_[i] = features[i];
    for (int i = 0; i < used_; ++i) {
      Scalar square = 0;
      for (int j = 0; j < kPlace; ++j) {
        const Scalar d = features[j] - centres_[i][j];
        square += d * d;
      }
      const Scalar root = Scalar(1) / (Scalar(1) + square * kInverseWidth);
      basis_[kLinear + i] = (root * root) * (root * root);
    }
  }

  Scalar nearness() const {
    Scalar largest = 0;
    for (int i = 0; i < used_; ++i) largest = std::max(largest, basis_[kLinear + i]);
    return largest;
  }

  void add_centre(const Features& features) {
    int at = used_;
    if (used_ < kernels_) {
      ++used_;
    } else {
      if (kernels_ == 0) return;
      at = 0;
      for (int i = 1; i < used_; ++i) {
        if (use_[i] < use_[at]) at = i;
      }
      if (use_[at] > kSeldom) return;
    }
    for (int j = 0; j < kPlace; ++j) centres_[at][j] = features[j];
    const int index = kLinear + at;
    for (int j = 0; j < index; ++j) row(index)[j] = 0;
    for (int i = index + 1; i < size(); ++i) row(i)[index] = 0;
    row(index)[index] = 1;
    for (auto& weights : weights_) weights[index] = 0;
    basis_[index] = 1;
    use_[at] = kFirstUse;
  }

  void update(const Outputs& target, const Outputs& deviation) {
    const int n = size();
    Outputs residual;
    for (int output = 0; output < kOutputs; ++output) {
      residual[output] = target[output] - dot(weights_[output], basis_, n);
    }
    for (int i = 0; i < n; ++i) {
      const Scalar* entries = row(i);
      const Scalar basis = basis_[i];
      gain_[i] = dot(entries, basis_, i + 1);
      for (int j = 0; j < i; ++j) gain_[j] += entries[j] * basis;
    }
    const Scalar known = dot(gain_, basis_, n);
    const Scalar S = known + kNoise * std::max(Scalar(1), std::abs(residual[0]) / deviation[0]);
    // Rounding has spoilt P, or a value is beyond the scalar's range.
    if (!(known >= Scalar(0)) || !std::isfinite(S)) {
      forget_covariance();
      return;
    }
    const Scalar inverse_S = Scalar(1) / S;
    for (int output = 0; output < kOutputs; ++output) {
      Scalar r = residual[output];
      if (output > 0) r = std::clamp(r, -deviation[output], deviation[output]);
      const Scalar step = r * inverse_S;
      for (int i = 0; i < n; ++i) weights_[output][i] += gain_[i] * step;
    }
    for (int i = 0; i < n; ++i) {
      Scalar* entries = row(i);
      const Scalar q = gain_[i] * inverse_S;
      for (int j = 0; j <= i; ++j) entries[j] -= q * gain_[j];
    }
  }

  void leak() {
    const Scalar eta = std::min(waiting_leak_, Scalar(0.5)), keep = Scalar(1) - eta;
    waiting_leak_ = 0;
    const int count = size() * (size() + 1) / 2;
    for (int i = 0; i < count; ++i) covariance_[i] *= keep;
    for (int i = 0; i < size(); ++i) row(i)[i] += eta;
  }

  void forget_covariance() {
    for (Scalar& entry : covariance_) entry = 0;
    for (int i = 0; i < kWeights; ++i) row(i)[i] = 1;
  }

  int kernels_ = kMostKernels;
  int used_ = 0;
  int learned_ = 0;
  Scalar waiting_leak_ = 0;
  Array<Array<Scalar, kPlace>, (kMostKernels)> centres_ = {};
  Array<Scalar, (kMostKernels)> use_ = {};  // mean kernel over 20 s
  Array<Scalar, kWeights> basis_ = {}, gain_ = {};
  Array<Array<Scalar, kWeights>, kOutputs> weights_ = {};
  Array<Scalar, kEntries> covariance_;  // lower triangle, row by row
};

}  // namespace condyle
