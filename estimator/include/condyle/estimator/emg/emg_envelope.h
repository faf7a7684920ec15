// SPDX-License-Identifier: Apache-2.0
// Turns raw EMG into the share of a muscle's maximum.
//
//   x         raw EMG, any unit
//   h         x without motion artefacts and offset: high-pass, 20 Hz
//   y         envelope: |h| after a low-pass, 6 Hz; of Gaussian EMG of standard deviation s its
//             mean is s sqrt(2 / pi)
//   y_max     envelope of a maximal voluntary contraction, of the same filters
//   excitation = y / y_max
//
// Both filters: Butterworth of second order, discrete by the bilinear transform, its cutoff
// prewarped: with k = tan(pi f / rate), D = 1 + sqrt(2) k + k^2,
//   low-pass   b = k^2 (1, 2, 1) / D,    high-pass  b = (1, -2, 1) / D,
//   both       a1 = 2 (k^2 - 1) / D,     a2 = (1 - sqrt(2) k + k^2) / D
// High-pass: 20 Hz, 12 dB per octave, as C. J. De Luca, L. D. Gilmore, M. Kuznetsov, S. H. Roy,
// J. Biomech. 43 (2010) 1573-1579. Low-pass: 3 to 10 Hz are usual for muscle forces, T. S. Buchanan
// et al., J. Appl. Biomech. 20 (2004) 367-395; 6 Hz is this file's choice.
//
// The envelope is late: a slow signal by sqrt(2) / (2 pi f), 38 ms at 6 Hz. NaN, infinite and
// saturated samples are counted and not taken; the last envelope stands in for them. After
// longest_hold_s of that the filters start anew.
#pragma once

#include <cstdint>

#include "condyle/estimator/math/elementary.h"
#include "condyle/estimator/published/parameters.h"

namespace condyle {

/// Settings of one raw EMG channel.
struct EnvelopeParameters {
  double rate_Hz = 1000;  ///< of the raw samples; above twice the high-pass
  double high_pass_Hz = 20;
  double low_pass_Hz = 6;
  double saturation = 0;        ///< |x| from which on the amplifier saturates; 0: not known
  double maximum = 1;           ///< y_max, in the unit of x
  double longest_hold_s = 0.1;  ///< longest run of dropped samples
};

/// True if the filters can be made.
constexpr bool is_valid(const EnvelopeParameters& parameters) {
  const Range positive{1e-12, 1e12};
  return positive.contains(parameters.rate_Hz) && positive.contains(parameters.high_pass_Hz) &&
         positive.contains(parameters.low_pass_Hz) && positive.contains(parameters.maximum) &&
         Range{0, 1e12}.contains(parameters.saturation) &&
         Range{0, 1e3}.contains(parameters.longest_hold_s) &&
         2.1 * parameters.high_pass_Hz < parameters.rate_Hz &&
         2.1 * parameters.low_pass_Hz < parameters.rate_Hz;
}

/// Counts of problems.
struct EnvelopeCounts {
  std::uint64_t not_finite = 0, saturated = 0;  ///< samples that were dropped
  std::uint64_t restarts = 0;                   ///< of the filters
  std::uint64_t above_maximum = 0;  ///< excitations above 1: the stated maximum was not one
};

/// Result of a sample.
template <class Scalar>
struct EnvelopeEstimate {
  Scalar envelope = 0;    ///< y, in the unit of x
  Scalar excitation = 0;  ///< share of the maximum, not limited to 1
  bool is_valid = false;  ///< false while the filters settle
};

/// One channel. Fixed size, no allocation.
template <class Scalar>
class EmgEnvelope {
 public:
  /// `parameters` must be valid.
  explicit EmgEnvelope(const EnvelopeParameters& parameters)
      : parameters_(parameters),
        high_pass_(parameters.high_pass_Hz / parameters.rate_Hz, true),
        low_pass_(parameters.low_pass_Hz / parameters.rate_Hz, false) {}

  /// Delay of a slow envelope after the excitation (s).
  static double delay_s(const EnvelopeParameters& parameters) {
    return 0.22507907903927651 / parameters.low_pass_Hz;  // sqrt(2) / (2 pi)
  }

  /// Takes the next raw sample, one sampling interval after the previous one.
  EnvelopeEstimate<Scalar> add(Scalar x) {
    const Scalar size = x < Scalar(0) ? -x : x;
    if (!(size < std::numeric_limits<Scalar>::infinity())) {
      ++counts_.not_finite;
      return hold();
    }
    if (parameters_.saturation > 0 && size >= Scalar(parameters_.saturation)) {
      ++counts_.saturated;
      return hold();
    }
    if (!is_started_) {
      high_pass_.rest_at(x);
      low_pass_.rest_at(Scalar(0));
      is_started_ = true;
      settled_s_ = 0;
    }
    held_s_ = 0;
    settled_s_ += 1 / parameters_.rate_Hz;
    const Scalar h = high_pass_.add(x);
    const Scalar y = low_pass_.add(h < Scalar(0) ? -h : h);
    last_.envelope = y > Scalar(0) ? y : Scalar(0);  // the filter overshoots a little
    last_.excitation = last_.envelope / Scalar(parameters_.maximum);
    last_.is_valid = settled_s_ > kSettlingTimes / parameters_.low_pass_Hz;
    if (last_.is_valid && last_.excitation > Scalar(1)) ++counts_.above_maximum;
    return last_;
  }

  const EnvelopeCounts& counts() const { return counts_; }

 private:
  static constexpr double kSettlingTimes = 1.5;  // of the low-pass: 1 % remains

  // Direct form II transposed.
  class Filter {
   public:
    Filter(double cutoff, bool is_high_pass) {
      const double angle = 3.141592653589793 * cutoff;
      const double k = elementary::sin(angle) / elementary::cos(angle);
      const double root = 1.4142135623730951 * k, D = 1 + root + k * k;
      b0_ = Scalar((is_high_pass ? 1 : k * k) / D);
      b1_ = Scalar(is_high_pass ? -2 : 2) * b0_;
      a1_ = Scalar(2 * (k * k - 1) / D);
      a2_ = Scalar((1 - root + k * k) / D);
    }
    // The state after a constant `x` without end.
    void rest_at(Scalar x) {
      const Scalar y = x * (b0_ + b1_ + b0_) / (Scalar(1) + a1_ + a2_);
      s2_ = b0_ * x - a2_ * y;
      s1_ = s2_ + b1_ * x - a1_ * y;
    }
    Scalar add(Scalar x) {
      const Scalar y = b0_ * x + s1_;
      s1_ = b1_ * x - a1_ * y + s2_;
      s2_ = b0_ * x - a2_ * y;
      return y;
    }

   private:
    Scalar b0_, b1_, a1_, a2_, s1_ = 0, s2_ = 0;
  };

  EnvelopeEstimate<Scalar> hold() {
    held_s_ += 1 / parameters_.rate_Hz;
    if (is_started_ && held_s_ > parameters_.longest_hold_s) {
      is_started_ = false;
      ++counts_.restarts;
      last_.is_valid = false;
    }
    return last_;
  }

  EnvelopeParameters parameters_;
  Filter high_pass_, low_pass_;
  bool is_started_ = false;
  double settled_s_ = 0, held_s_ = 0;
  EnvelopeEstimate<Scalar> last_;
  EnvelopeCounts counts_;
};

}  // namespace condyle
