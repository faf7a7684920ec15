// SPDX-License-Identifier: Apache-2.0
// Recordings of any number of points with names, as motion capture calls them: markers.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "hosted/files/byte_reader.h"
#include "recordings/recording.h"

namespace condyle::host {

/// A recording whose points have names. Until `with_markers` chooses among them, its samples need
/// no coordinates, and its kind is three_points for any number of points.
class NamedPointsRecording : public Recording {
 public:
  /// In the order of `points_m`; as in the file, so that two may be equal and one empty.
  virtual const std::vector<std::string>& names() const = 0;
  /// Places in the sample last returned, in the instrument's frame (m), one a column; NaN for a
  /// point that is missing or farther than kFarthestPosition_m.
  virtual const Eigen::Matrix3Xd& points_m() const = 0;
};

/// How many points the reader of a recording can use.
enum class PointCount {
  one_or_three,  ///< one point, or three
  any,           ///< also more than three
};

/// The points `markers` of `recording`, or all of them if `markers` is empty, as samples. Throws an
/// InputError that names `path` for an unknown or repeated name, and for a number of points that
/// `count` does not allow.
std::unique_ptr<NamedPointsRecording> with_markers(std::unique_ptr<NamedPointsRecording> recording,
                                                   const std::vector<std::string>& markers,
                                                   PointCount count, const std::string& path);

/// Opens a CSV recording of any number of points, or of one axis.
std::unique_ptr<NamedPointsRecording> open_csv_points(std::unique_ptr<ByteReader> reader,
                                                      const RecordingOptions& options);

/// Carstens AG500 and AG501 positions with their header; the points are the channels.
std::unique_ptr<NamedPointsRecording> open_carstens(std::unique_ptr<ByteReader> reader,
                                                    const RecordingOptions& options);

/// As open_recording, but a recording may have any number of points with names, and is then a
/// NamedPointsRecording.
std::unique_ptr<Recording> open_with_all_points(const std::string& source,
                                                const RecordingOptions& options);

/// As open_with_all_points, for a description: a recording of points with names may also have none,
/// or two, and its samples then have no coordinates.
std::unique_ptr<Recording> open_to_describe(const std::string& source,
                                            const RecordingOptions& options);

}  // namespace condyle::host
