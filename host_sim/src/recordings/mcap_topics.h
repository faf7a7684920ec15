// SPDX-License-Identifier: Apache-2.0
// Names in exported MCAP files, which exports write and recordings read back.
#pragma once

#include <string>
#include <string_view>

namespace condyle::host {

inline constexpr std::string_view kExportMetadata = "condyle_export";
inline constexpr std::string_view kExportFormat = "1";
/// What was measured.
inline constexpr const char* kKindAxis = "one axis";
inline constexpr const char* kKindPoints = "points";
inline constexpr const char* kKindPose = "pose";

inline constexpr const char* kPointTopics = "/points/";
inline constexpr const char* kChannelTopics = "/channels/";
inline constexpr const char* kPoseTopic = "/jaw/pose";
inline constexpr const char* kPositionTopic = "/jaw/position";
inline constexpr const char* kDriveTopic = "/jaw/drive";
inline constexpr const char* kEventTopic = "/jaw/events";

/// Who says an event.
inline constexpr const char* kMarkerName = "marker";
inline constexpr const char* kRecordingName = "recording";
inline constexpr const char* kEstimatorName = "estimator";

/// `name` with the characters that a topic may have.
inline std::string topic_word(std::string name) {
  for (char& c : name) {
    const bool is_good = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
    if (!is_good) c = '_';
  }
  return name.empty() ? "_" : name;
}

}  // namespace condyle::host
