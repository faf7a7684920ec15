// SPDX-License-Identifier: Apache-2.0
// Messages of exported MCAP files: those of ROS 2 that viewers show, and own ones of plain numbers.
#pragma once

#include <string>
#include <string_view>

#include "estimation/estimate_row.h"
#include "recordings/cdr.h"

namespace condyle::host {

/// Frame of all positions.
inline constexpr std::string_view kInstrumentFrame = "instrument";
inline constexpr std::string_view kJawFrame = "jaw";

/// A type of message, and its definition with those that it contains.
struct MessageType {
  std::string name, definition;
};
MessageType point_type();                   ///< geometry_msgs/msg/PointStamped
MessageType pose_type();                    ///< geometry_msgs/msg/PoseStamped
MessageType transforms_type();              ///< tf2_msgs/msg/TFMessage
MessageType log_type();                     ///< rcl_interfaces/msg/Log
MessageType value_type();                   ///< condyle_msgs/msg/Value
MessageType estimate_type(int axis_count);  ///< condyle_msgs/msg/AxisMotion, PointMotion

/// Place and direction of the jaw, as exported (m; unit quaternion w, x, y, z).
struct ExportPose {
  double position_m[3];
  double orientation[4];
};

/// Each replaces `out` by a message.
void write_point(CdrWriter& out, TimeNs time_ns, const double* position_m);
void write_pose(CdrWriter& out, TimeNs time_ns, const ExportPose& pose);
void write_value(CdrWriter& out, TimeNs time_ns, double value);
/// `is_warning`: something unusual; else information. `from`: who says it.
void write_log(CdrWriter& out, TimeNs time_ns, bool is_warning, std::string_view from,
               std::string_view text);
void write_estimate(CdrWriter& out, TimeNs time_ns, const EstimateRow& row);

/// A message with the transforms that are added.
class TransformsWriter {
 public:
  explicit TransformsWriter(CdrWriter& out) : out_(out) {}
  /// Begins a message of `count` transforms.
  void begin(std::uint32_t count);
  void add(TimeNs time_ns, std::string_view child, const ExportPose& pose);

 private:
  CdrWriter& out_;
};

}  // namespace condyle::host
