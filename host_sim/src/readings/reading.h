// SPDX-License-Identifier: Apache-2.0
// A reading: one number about a jaw's motion, with its interval, definition and provenance, or the
// reason why it is withheld.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace condyle::host {

/// The kinds of tasks that have readings.
/// `whole`: the whole recording, if its tasks are not known.
enum class TaskKind { opening, protrusion, left, right, chewing, border, rest, whole };
/// Number of kinds that have a name.
inline constexpr std::size_t kTaskKinds = 7;
/// Its name, as in files and options; empty for the whole recording.
const char* name_of(TaskKind kind);
/// All names.
std::vector<std::string_view> task_names();

/// A side of the jaw; of a condylar reading, that of the condyle.
enum class Side { none, left, right };
/// "", "left" or "right".
const char* name_of(Side side);

/// What a reading rests on.
enum class ReadingProvenance {
  measured,  ///< follows from positions and measured landmarks
  derived,   ///< also from a named assumption
  withheld,  ///< not known
};
/// As a word.
const char* name_of(ReadingProvenance provenance);

/// The definition of a reading.
struct ReadingDefinition {
  std::string_view name;
  std::string_view unit;
  std::string_view definition;
  /// Half 95 % interval from which on the reading is withheld, in `unit`.
  double largest_half_interval;
  bool needs_rotation;
  bool needs_plane;  ///< the angle or direction refers to the reference plane
};

/// The definition called `name`, which must exist.
const ReadingDefinition& definition_of(std::string_view name);
/// All of them.
const std::vector<ReadingDefinition>& reading_definitions();

/// The publication that defines the reading, or from which its limit follows; empty: none.
std::string_view reference_of(const ReadingDefinition& definition);

/// A reading of a task (`stroke` 0) or of one stroke of it. Values in the definition's unit.
struct JawReading {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  const ReadingDefinition* definition = nullptr;
  TaskKind task = TaskKind::opening;
  Side side = Side::none;
  int stroke = 0;
  double value = kNone, low = kNone, high = kNone;
  ReadingProvenance provenance = ReadingProvenance::withheld;
  std::string reason;  ///< why it is withheld, or what a derived one assumes
};

/// 95 % of a normal distribution lie within this many standard deviations.
inline constexpr double kHalf95 = 1.959964;

/// An estimate before it is judged: value and the parts of its uncertainty, in the unit of the
/// definition.
struct UncertainValue {
  double value = JawReading::kNone;
  double noise_sd = 0;  ///< of the instrument's noise during the stroke
  double doubt = 0;     ///< what the definition leaves open
  /// With sign, what may be left of what smoothing changed, and of what noise added.
  std::array<double, 2> corrections{};
  /// With sign, what the samples show of smoothing beyond what was corrected, and its standard
  /// deviation by noise: what exceeds the noise is in the interval.
  double contradiction = 0, contradiction_sd = 0;
  /// What repeated values show of it together (share_contradictions).
  double shared_contradiction = 0;
  std::vector<double> fixed;  ///< change per standard deviation of each error that strokes share
  int repetitions = 0;        ///< strokes or cycles that were averaged; 0: a single value
  std::string missing;        ///< the reason if the value is NaN
  /// The value exists but is not known: a mean without it may be biased.
  bool is_hidden = false;

  /// Half the 95 % interval.
  double half_interval() const;
  /// Its part that is neither noise nor an error that strokes share.
  double systematic() const;
  /// Its part by `contradiction`.
  double of_contradiction() const;
  void scale_corrections(double factor);
  void scale_systematic(double factor);
  /// Makes `half` that interval, without parts.
  void set_half_interval(double half);
};

/// The mean of the values of several strokes. Strokes without a value do not count. Corrections
/// that differ in sign cancel as what is left of them does, at most like independent errors. A
/// hidden value may differ from the others: it may lie twice as far from the mean as the farthest
/// known value, and the interval contains this. If more than one value in ten is hidden, the mean
/// has no value.
UncertainValue mean_of(const std::vector<UncertainValue>& strokes);

/// `value` - `other`, whose noise is independent; the rest of their uncertainty adds up, but for
/// errors that both share.
UncertainValue difference_of(UncertainValue value, const UncertainValue& other);

/// Where the contradictions of the `repeated` values together exceed their noise, their root mean
/// square counts for each: in a single value noise hides it.
void share_contradictions(const std::vector<UncertainValue*>& repeated);

/// What would narrow the interval of `value` to +-`limit`, as words: more repetitions, less noise,
/// more exact landmarks, or a higher rate. `repeated`: "strokes" or "cycles".
std::string what_narrows(const UncertainValue& value, double limit, std::string_view repeated);

/// The reading with `value`, withheld if it has none or its interval is too wide. `repeated` as in
/// what_narrows.
JawReading judged(const ReadingDefinition& definition, const UncertainValue& value,
                  std::string_view repeated);

}  // namespace condyle::host
