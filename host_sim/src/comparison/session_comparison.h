// SPDX-License-Identifier: Apache-2.0
// Sessions of one subject, each with repeat recordings: what changes, and how large a change must
// be to exceed the scatter of repeats.
//
//   x_ij   value of recording j of session i, n_i of them
//   s_w    within-session standard deviation, pooled: s_w^2 = sum (x_ij - mean_i)^2 / dof,
//          dof = sum (n_i - 1). It is the standard error of measurement.
//   smallest detectable change, at 95 %, t = t_{0.975, dof}:
//          of two single recordings            t sqrt(2) s_w
//          of the means of two sessions        t s_w sqrt(1/n_1 + 1/n_2)
//
// J. M. Bland and D. G. Altman, Statistics Notes: Measurement error, BMJ 312 (1996) 1654; J. P.
// Weir, J. Strength Cond. Res. 19 (2005) 231-240, with Student's t in place of 1.96, because s_w is
// estimated. Without any change, one comparison in 20 exceeds it by chance; so each also has Holm's
// adjusted probability (S. Holm, Scand. J. Stat. 6 (1979) 65-70), which allows one false finding in
// 20 such tables. The repeats are assumed independent, normal and equally scattered in all
// sessions. A quantity is not compared if successive repeats are alike (repeat_order.h), or if it
// depends on the duration or the instrument's noise and these differ. A difference between sessions
// that does not vary within one (mounting of the instrument, the day) is part of the change.
//
// Friction and mass have their own standard deviation, which includes the stated error of the drive
// that is common to all repeats. This error may differ in the other session: sd_1^2 + sd_2^2 of
// these is added to the variance of the difference, whose degrees of freedom follow from its parts
// (F. E. Satterthwaite, Biometrics Bull. 2 (1946) 110-114).
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "comparison/compared_recording.h"
#include "statistics/chi_square.h"

namespace condyle::host {

/// How repeats scatter within their sessions. Unit: the values'.
struct Repeatability {
  std::size_t degrees_of_freedom = 0;
  double within_sd = 0;  ///< NaN without degrees of freedom
  Interval interval;     ///< 95 % of within_sd, by chi-square
  /// False without repeats, or if they do not differ at all: nothing is then known.
  bool is_known() const { return degrees_of_freedom > 0 && within_sd > 0; }
  /// Smallest detectable change of the difference of means of `n_1` and `n_2` recordings; NaN
  /// unless it is known.
  /// `stated_variance` is added to that of the difference.
  double smallest_change(std::size_t n_1, std::size_t n_2, double stated_variance = 0) const;
  /// Probability that repeats alone, with the stated variance, differ by `change` or more; NaN
  /// unless it is known.
  double probability(double change, std::size_t n_1, std::size_t n_2,
                     double stated_variance = 0) const;
};

/// From the values of each session.
Repeatability repeatability(const std::vector<std::vector<double>>& sessions);

/// Holm's adjusted probabilities, in the order given; NaN stays and is not counted.
std::vector<double> holm_adjusted(const std::vector<double>& probabilities);

/// Recordings of one session.
struct Session {
  std::string name;
  std::vector<RecordingReport> recordings;
};

/// From one session to a later one. Unit: the quantity's.
struct SessionChange {
  std::size_t from = 0, to = 0;  ///< index of the sessions
  double change = 0;             ///< difference of their means
  double smallest = 0;           ///< smallest detectable change of it; NaN: not known
  double of_drive = 0;           ///< what the stated drive alone can cause; within `smallest`
  double probability = 0, adjusted_probability = 0;  ///< NaN: not known
  bool exceeds() const { return probability < 0.05; }
  bool exceeds_adjusted() const { return adjusted_probability < 0.05; }
};

/// One quantity in all sessions.
struct QuantityComparison {
  std::string name, column, unit;
  std::string withheld;                     ///< why it is not compared; empty if it is
  std::vector<std::vector<double>> values;  ///< of each session's recordings
  std::vector<double> means;                ///< of each session
  Repeatability repeats;
  double smallest_single = 0;  ///< smallest change of one recording to another; NaN: not known
  std::vector<SessionChange> changes;  ///< of each pair of sessions
};

/// All of them.
struct SessionComparison {
  std::vector<QuantityComparison> quantities;
  /// Comparisons whose smallest change is known.
  std::size_t tests() const;
};

/// What a quantity depends on in addition to the subject.
enum DependsOn : unsigned { kNothing = 0, kDuration = 1, kNoise = 2 };

/// Why a quantity that depends on `depends_on` is not compared between `sessions`; empty if it is.
std::string differing_conditions(const std::vector<Session>& sessions, unsigned depends_on);

/// Compares the `values` of `quantity`, one for each recording of each session, and fills its other
/// fields but for the adjusted probabilities. `stated_variances`: of each session, not visible in
/// its repeats.
void compare_values(const std::vector<double>& stated_variances, QuantityComparison& quantity);

/// Fills the adjusted probabilities of all changes.
void adjust_probabilities(SessionComparison& comparison);

/// Compares the sessions, at least two, by the first estimator of their recordings. Throws
/// InputError if recordings cannot be compared: different rates or kinds, or copies of each other.
SessionComparison compare_sessions(const std::vector<Session>& sessions);

}  // namespace condyle::host
