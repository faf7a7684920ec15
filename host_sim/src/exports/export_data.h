// SPDX-License-Identifier: Apache-2.0
// What is exported of a recording: everything that was measured, by name, in SI units. A missing
// value is NaN in memory, and missing in every file.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "condyle/estimator/provenance.h"
#include "recordings/bids_names.h"
#include "recordings/recording.h"

namespace condyle::host {

class ExportEstimates;

/// A quantity of a point, a body or a channel, at the times of the samples.
struct ExportSeries {
  std::string name;                              ///< of the point, body or channel
  std::string quantity;                          ///< position, orientation, force
  std::vector<std::string> components;           ///< x, y, z; one empty text of a scalar
  std::string unit;                              ///< m, N; empty: a pure number
  Provenance provenance = Provenance::measured;  ///< of the values that are there
  std::string assumption;                        ///< of derived values
  std::vector<double> values;                    ///< `components` of each sample, in order
  bool is_computed = false;                      ///< from the recording, not part of it
  std::vector<Provenance> provenances;           ///< of each value; empty: `provenance` of all

  /// The provenance of component `i` of sample `k`.
  Provenance provenance_at(std::size_t k, std::size_t i) const {
    return provenances.empty() ? provenance : provenances[k * components.size() + i];
  }
  /// True if it is the place of a point in space.
  bool is_point() const { return quantity == "position" && components.size() == 3; }
  /// The values of sample `k`.
  const double* at(std::size_t k) const { return values.data() + k * components.size(); }
  /// True if all values of sample `k` are there.
  bool is_there(std::size_t k) const;
};

/// A channel with a rate of its own.
struct ExportChannel {
  AnalogChannel channel;
  double first_s = 0;          ///< time of its first value, on the recording's clock
  std::vector<double> values;  ///< in the channel's unit; NaN: missing
};

/// The exported content of a recording.
struct ExportData {
  std::string source;  ///< as named by the user
  RecordingInfo info;
  std::vector<TimeNs> time_ns;  ///< of the samples; rises
  std::vector<ExportSeries> series;
  std::vector<ExportChannel> channels;
  std::vector<NamedInstant> events;            ///< on the recording's clock
  std::optional<double> rate_Hz;               ///< after resampling: exact
  std::shared_ptr<ExportEstimates> estimates;  ///< null: none
  BidsLabels labels;                           ///< for formats that file recordings by them
  std::vector<std::string> notes;              ///< what the user must know

  std::size_t samples() const { return time_ns.size(); }
  std::vector<const ExportSeries*> points() const;
};

/// Reads `source`. Samples without a time, and samples not later than the one before, have no place
/// in any file: a note counts them. Throws InputError if nothing is left, or if `is_stopped`.
ExportData read_export_data(const std::string& source, const RecordingOptions& options,
                            const std::function<bool(double)>& is_stopped);

}  // namespace condyle::host
