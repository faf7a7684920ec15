// SPDX-License-Identifier: Apache-2.0
// The regression of a measured drive on the motion that it makes, sample by sample.
//
//   z, u      positions (m) and drive (N), each at its own times and rate
//   s_z, s_u  standard deviations of their noise, T_z, T_u their steps
//   h, w_c    half-width of the kernel (modulating_kernel.h), and the frequency that it passes
//   t_j       instants, every h / 4, at points of the positions
//
// Model:       u = m a + kv v + ks x + c, and other forces (c = -b: the constant force b acts with
//              the drive). The kernel leaves the equation unchanged:
//              u_f = m a_f + kv v_f + ks x_f + c 1_f. It needs neither derivatives of samples nor
//              common times. regression_fit.h solves it, point_conclusion.h judges the result.
// Width:       w_c = 1.2 w_0, w_0^2 = s_u sqrt(T_u) / (m_0 s_z sqrt(T_z)): at w_0 the drive's noise
//              and the position's, times m_0 w^2, are equal. The width is chosen once, after the
//              first second. Another width costs efficiency, never coverage. If positions in
//              contact are left out, w_c is at least 39 rad/s, so that a third of a second between
//              contacts suffices.
// Sign:        q_s from the velocity v_k at each sample, through a kernel of half the width:
//              v_k / sqrt(v_k^2 + v_s^2), v_s = 5 mm/s unless stated
// Noise:       from the samples (even_channel.h). The drive's stated noise is not used.
//
// An instant is used if all of h around it (1.5 h for the positions) was measured; so gaps and
// positions in contact also cost their surroundings.
#pragma once

#include "condyle/estimator/impedance/even_channel.h"
#include "condyle/estimator/impedance/impedance_parameters.h"
#include "condyle/estimator/impedance/regression_sums.h"

namespace condyle {

/// Counts of problems.
struct DriveCounts {
  std::uint64_t drive_not_in_order = 0;    ///< samples of the drive that were dropped
  std::uint64_t drive_gaps = 0;            ///< longer than the longest, either way
  std::uint64_t positions_too_early = 0;   ///< before the first drive, or within a gap
  std::uint64_t positions_in_contact = 0;  ///< teeth or food may touch there
  std::uint64_t positions_dropped = 0;     ///< too many were waiting for the drive
};

/// Settings behind the sums.
struct RegressionSetup {
  double cutoff_rad_s = 0;      ///< w_c
  double instant_s = 0;         ///< mean time between instants
  double place_m = 0;           ///< origin of x
  KernelGains position, drive;  ///< of the noise of their samples
};

/// Feeds the sums. Fixed size, no allocation, + - * / and sqrt only.
template <class Scalar>
class PointRegression {
 public:
  /// `parameters` must be valid.
  explicit PointRegression(const ImpedanceParameters& parameters)
      : parameters_(parameters),
        positions_(kLeastPositionStep_ns, kNanosecondsPerSecond),
        drive_(kLeastDriveStep_ns, nanoseconds(parameters.drive.longest_gap_s)),
        delay_ns_(nanoseconds(parameters.drive.delay_s)) {}

  /// A measured drive (N), stamped `time_ns`; its stated delay is subtracted.
  void add_drive(TimeNs time_ns, Scalar drive_N) {
    TimeNs force_time_ns = 0;
    if (__builtin_sub_overflow(time_ns, delay_ns_, &force_time_ns)) return;
    has_drive_ = true;
    drive_.add(force_time_ns, drive_N, [this] { advance(); });
    advance();
  }

  /// A measured position (m).
  void add_position(TimeNs time_ns, Scalar position_m) {
    if (position_m > Scalar(parameters_.contact_above_m) ||
        position_m < Scalar(parameters_.contact_below_m)) {
      ++counts_.positions_in_contact;
      advance();
      positions_.interrupt();
      return;
    }
    positions_.add(time_ns, position_m, [this] { advance(); });
    advance();
  }

  /// True once the kernel is chosen; from then on the blocks exist.
  bool has_begun() const { return has_begun_; }
  /// True once any drive was given.
  bool has_drive() const { return has_drive_; }
  /// True if the rate of the samples is too low for any kernel.
  bool is_too_slow() const { return is_too_slow_; }
  const RegressionBlocks<Scalar>& blocks() const { return blocks_; }
  RegressionSetup setup() const {
    RegressionSetup setup;
    setup.cutoff_rad_s = cutoff_rad_s_;
    setup.place_m = static_cast<double>(place_m_);
    setup.instant_s = static_cast<double>(stride_) * mean_step_s(position_span_);
    setup.position = position_gains_;
    setup.drive = drive_gains_;
    scale_to_rate(position_span_, static_cast<double>(positions_.step_s()), setup.position);
    scale_to_rate(drive_span_, static_cast<double>(drive_.step_s()), setup.drive);
    return setup;
  }
  DriveCounts counts() const {
    DriveCounts counts = counts_;
    counts.drive_not_in_order = drive_.counts().not_in_order;
    counts.drive_gaps = drive_.counts().gaps;
    return counts;
  }

 private:
  static constexpr TimeNs kLeastPositionStep_ns = 1'500'000, kLeastDriveStep_ns = 750'000;
  static constexpr std::size_t kPositions = 768, kDrives = 1024;
  static constexpr double kLowestCutoff_rad_s = 15, kCutoffTimesStep = 0.65;
  static constexpr double kNoContact_m = 1e3, kCutoffBesideContact_rad_s = 39;
  static constexpr double kLearning_s = 1, kFewestVariances = 24;

  // Samples and their duration, which give the true mean step.
  struct Span {
    TimeNs time_ns = 0;
    std::uint64_t steps = 0;
  };
  static double mean_step_s(const Span& span) {
    return span.steps > 0 ? seconds(span.time_ns) / static_cast<double>(span.steps) : 0;
  }
  static void scale_to_rate(const Span& span, double step_s, KernelGains& gains) {
    if (span.steps == 0) return;
    const double share = mean_step_s(span) / step_s;
    gains = {gains.G0 * share, gains.G2 * share, gains.G4 * share};
  }

  void advance() {
    if (!has_begun_ && !begin()) return;
    if (positions_.segment() != segment_) {
      segment_ = positions_.segment();
      has_center_ = false;
    }
    make_signs();
    while (take_next_instant()) continue;
  }

  // Chooses the kernel after the first second.
  bool begin() {
    if (!positions_.is_learned() || !drive_.is_learned()) return false;
    const auto& z = positions_.noise();
    const auto& u = drive_.noise();
    const double T_z = static_cast<double>(positions_.step_s()),
                 T_u = static_cast<double>(drive_.step_s()), T = T_z > T_u ? T_z : T_u;
    const double highest_rad_s = kCutoffTimesStep / T;
    is_too_slow_ = highest_rad_s < kLowestCutoff_rad_s;
    if (is_too_slow_ || static_cast<double>(z.count) < kFewestVariances ||
        static_cast<double>(u.count) < kFewestVariances ||
        static_cast<double>(z.count) * T_z < kLearning_s ||
        static_cast<double>(u.count) * T_u < kLearning_s) {
      return false;
    }
    using std::sqrt;
    const double s_z = sqrt(static_cast<double>(z.variance / z.count)),
                 s_u = sqrt(static_cast<double>(u.variance / u.count));
    const double w0 =
        sqrt(s_u * sqrt(T_u) / (parameters_.mass_kg.mean * (s_z + kLeastNoise_m) * sqrt(T_z)));
    cutoff_rad_s_ = 1.2 * w0;
    const bool has_contact =
        parameters_.contact_above_m < kNoContact_m || parameters_.contact_below_m > -kNoContact_m;
    if (has_contact && cutoff_rad_s_ < kCutoffBesideContact_rad_s) {
      cutoff_rad_s_ = kCutoffBesideContact_rad_s;
    }
    if (!(cutoff_rad_s_ < highest_rad_s)) cutoff_rad_s_ = highest_rad_s;
    if (cutoff_rad_s_ < kLowestCutoff_rad_s) cutoff_rad_s_ = kLowestCutoff_rad_s;
    const double h = sqrt(ModulatingKernel<Scalar>::kInverseVariance) / cutoff_rad_s_;
    kernel_ = ModulatingKernel<Scalar>(static_cast<Scalar>(h));
    sign_kernel_ = ModulatingKernel<Scalar>(static_cast<Scalar>(h / 2));
    position_gains_ = kernel_.gains(T_z);
    drive_gains_ = kernel_.gains(T_u);
    stride_ = static_cast<std::uint64_t>(h / 4 / T_z + 0.5);
    if (stride_ == 0) stride_ = 1;
    blocks_ = RegressionBlocks<Scalar>(static_cast<double>(stride_) * T_z);
    Scalar sum = 0;
    for (std::uint64_t k = positions_.begin(); k < positions_.end(); ++k)
      sum += positions_.value(k);
    place_m_ = sum / static_cast<Scalar>(positions_.end() - positions_.begin());
    segment_ = positions_.segment();
    has_begun_ = true;
    return true;
  }

  // Calls `use(index, distance_s)` for the points of `channel` within `reach_s` of `time_ns`, from
  // index `from` on. False if the segment does not extend beyond both ends of the range.
  template <class Channel, class Use>
  static bool sweep(const Channel& channel, std::uint64_t from, TimeNs time_ns, Scalar reach_s,
                    Use&& use) {
    std::uint64_t k = from;
    if (k == channel.begin()) {
      if (difference_of(time_ns, channel.time_ns(k)) < reach_s) return false;
      ++k;
    }
    for (; k + 1 < channel.end(); ++k) {
      const Scalar distance_s = difference_of(time_ns, channel.time_ns(k));
      if (distance_s <= -reach_s) return true;
      if (distance_s < reach_s) use(k, distance_s);
    }
    return difference_of(time_ns, channel.time_ns(k)) <= -reach_s;
  }

  static Scalar difference_of(TimeNs later_ns, TimeNs earlier_ns) {
    return static_cast<Scalar>(seconds(later_ns - earlier_ns));
  }

  // The first index whose point is less than `reach_s` before `time_ns`, but for one.
  template <class Channel>
  static std::uint64_t first_within(const Channel& channel, std::uint64_t from, TimeNs time_ns,
                                    Scalar reach_s) {
    std::uint64_t k = from > channel.begin() ? from : channel.begin();
    while (k + 1 < channel.end() && difference_of(time_ns, channel.time_ns(k + 1)) >= reach_s) ++k;
    return k;
  }

  static std::size_t place_of(std::uint64_t index) {
    return static_cast<std::size_t>(index % kPositions);
  }

  // The signs of all points with half a kernel of positions on either side.
  void make_signs() {
    using std::sqrt;
    const Scalar reach_s = sign_kernel_.half_width_s();
    if (!has_center_) {
      sign_next_ = positions_.begin();
      if (positions_.end() - positions_.begin() < 3) return;
    }
    for (; sign_next_ < positions_.end(); ++sign_next_) {
      if (sign_next_ < positions_.begin()) sign_next_ = positions_.begin();
      const TimeNs time_ns = positions_.time_ns(sign_next_);
      const bool has_before =
          difference_of(time_ns, positions_.time_ns(positions_.begin())) >= reach_s;
      if (!has_before) continue;
      sign_from_ = first_within(positions_, sign_from_, time_ns, reach_s);
      Scalar v = 0;
      const bool is_whole =
          sweep(positions_, sign_from_, time_ns, reach_s, [&](std::uint64_t k, Scalar distance_s) {
            v += sign_kernel_.at(distance_s).slope * positions_.width_s(k) *
                 (positions_.value(k) - place_m_);
          });
      if (!is_whole) return;
      if (!has_center_) {
        has_center_ = true;
        sign_begin_ = sign_next_;
        center_next_ = sign_next_;
        center_from_ = positions_.begin();
        drive_from_ = 0;
      }
      const auto v_s = static_cast<Scalar>(parameters_.coulomb_velocity_m_s);
      signs_[place_of(sign_next_)] = v / sqrt(v * v + v_s * v_s);
    }
  }

  // False if the next instant has to wait.
  bool take_next_instant() {
    if (!has_center_) return false;
    const Scalar reach_s = kernel_.half_width_s();
    for (;; ++center_next_) {  // to the first instant with signs all around
      if (center_next_ >= sign_next_) return false;
      const bool is_cut = sign_begin_ < positions_.begin();
      const std::uint64_t first = is_cut ? positions_.begin() + 1 : sign_begin_;
      if (center_next_ > first &&
          difference_of(positions_.time_ns(center_next_), positions_.time_ns(first)) >= reach_s) {
        break;
      }
      if (is_cut) ++counts_.positions_dropped;
    }
    const TimeNs time_ns = positions_.time_ns(center_next_);
    if (difference_of(positions_.time_ns(sign_next_ - 1), time_ns) < reach_s) return false;
    if (drive_.end() - drive_.begin() < 3 ||
        difference_of(drive_.time_ns(drive_.end() - 1), time_ns) < reach_s) {
      return false;
    }
    std::array<Scalar, kRegressionColumns> y{};
    drive_from_ = first_within(drive_, drive_from_, time_ns, reach_s);
    const bool has_drive =
        sweep(drive_, drive_from_, time_ns, reach_s, [&](std::uint64_t k, Scalar distance_s) {
          const KernelWeights<Scalar> phi = kernel_.at(distance_s);
          const Scalar uT = drive_.value(k) * drive_.width_s(k);
          y[kDriveColumn] += phi.value * uT;
          y[kDriveSlopeColumn] += phi.slope * uT;
          y[kDriveCurvatureColumn] += phi.curvature * uT;
        });
    if (!has_drive) {  // it began later, or had a gap
      ++counts_.positions_too_early;
      ++center_next_;
      return true;
    }
    center_from_ = first_within(positions_, center_from_, time_ns, reach_s);
    sweep(positions_, center_from_, time_ns, reach_s, [&](std::uint64_t k, Scalar distance_s) {
      const KernelWeights<Scalar> phi = kernel_.at(distance_s);
      const Scalar T = positions_.width_s(k), z = positions_.value(k) - place_m_;
      const Scalar X = z / Scalar(kShapeUnit_m), X2 = X * X, value = phi.value * T;
      y[kAccelerationColumn] += phi.curvature * T * z;
      y[kVelocityColumn] += phi.slope * T * z;
      y[kPositionColumn] += value * z;
      y[kOneColumn] += value;
      y[kSquareColumn] += value * X2;
      y[kCubeColumn] += value * X2 * X;
      y[kFourthColumn] += value * X2 * X2;
      y[kSignColumn] += value * signs_[place_of(k)];
    });
    add_to_block(y);
    center_next_ += stride_;
    return true;
  }

  void add_to_block(const std::array<Scalar, kRegressionColumns>& y) {
    RegressionSums<Scalar>& block = blocks_.open();
    block.add_instant(y);
    block.position_noise.add(positions_.take_noise());
    block.drive_noise.add(drive_.take_noise());
    const NoiseLagSums<Scalar> colour = positions_.take_colour();
    for (std::size_t i = 0; i < kNoiseLags; ++i) block.position_colour[i] += colour[i];
    note_span(positions_, position_span_);
    note_span(drive_, drive_span_);
    blocks_.close_if_full();
  }

  // The steps in the ring: close to the mean of all, at the cost of an instant.
  template <class Channel>
  static void note_span(const Channel& channel, Span& span) {
    if (channel.end() - channel.begin() < 2) return;
    span.time_ns += channel.time_ns(channel.end() - 1) - channel.time_ns(channel.begin());
    span.steps += channel.end() - channel.begin() - 1;
  }

  static constexpr double kLeastNoise_m = 1e-9;

  ImpedanceParameters parameters_;
  EvenChannel<Scalar, kPositions> positions_;
  EvenChannel<Scalar, kDrives> drive_;
  TimeNs delay_ns_;
  bool has_drive_ = false, has_begun_ = false, is_too_slow_ = false;
  ModulatingKernel<Scalar> kernel_{Scalar(1)}, sign_kernel_{Scalar(1)};
  KernelGains position_gains_, drive_gains_;
  double cutoff_rad_s_ = 0;
  Scalar place_m_ = 0;
  std::uint64_t stride_ = 1;
  Span position_span_, drive_span_;
  std::uint64_t segment_ = 0;
  bool has_center_ = false;  ///< the segment has a sign
  std::uint64_t sign_begin_ = 0, sign_next_ = 0, sign_from_ = 0;
  std::uint64_t center_next_ = 0, center_from_ = 0, drive_from_ = 0;
  std::array<Scalar, kPositions> signs_{};
  RegressionBlocks<Scalar> blocks_{1};
  DriveCounts counts_;
};

}  // namespace condyle
