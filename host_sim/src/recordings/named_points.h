// SPDX-License-Identifier: Apache-2.0
// Recordings of any number of points with names: CSV files.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "hosted/files/byte_reader.h"
#include "recordings/recording.h"

namespace condyle::host {

/// A recording whose points have names. Its samples hold the first three points; if there are
/// fewer, they are as without names.
class NamedPointsRecording : public Recording {
 public:
  /// In the order of `points_m`.
  virtual const std::vector<std::string>& names() const = 0;
  /// Places in the sample last returned, in the instrument's frame (m), one a column; NaN for a
  /// point that is missing or farther than kFarthestPosition_m.
  virtual const Eigen::Matrix3Xd& points_m() const = 0;
};

/// Opens a CSV recording of any number of points, or of one axis.
std::unique_ptr<NamedPointsRecording> open_csv_points(std::unique_ptr<ByteReader> reader,
                                                      const RecordingOptions& options);

/// As open_recording, but a CSV file may have any number of points, and is then a
/// NamedPointsRecording.
std::unique_ptr<Recording> open_with_all_points(const std::string& source,
                                                const RecordingOptions& options);

}  // namespace condyle::host
