// SPDX-License-Identifier: Apache-2.0
// MCAP files that condyle exported (exports/mcap_export.cpp). Messages of measurements with equal
// stamps are one sample.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "condyle/hal/log/mcap_reader.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/cdr.h"
#include "recordings/exported_mcap.h"
#include "recordings/mcap_topics.h"

namespace condyle::host {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostPoints = 10'000;

// What a channel holds.
enum class Role { other, point, pose, position, drive, event };

struct Channel {
  Role role = Role::other;
  std::size_t point = 0;
};

std::string_view fact(const hal::McapPairs& pairs, std::string_view key) {
  const auto found =
      std::find_if(pairs.begin(), pairs.end(), [&](const auto& pair) { return pair.first == key; });
  return found == pairs.end() ? std::string_view() : std::string_view(found->second);
}

class ExportedMcap final : public NamedPointsRecording {
 public:
  explicit ExportedMcap(std::string path) : path_(std::move(path)) {
    open();
    survey();
    info_.format = kExportedMcap;
    points_m_.setConstant(3, static_cast<Eigen::Index>(names_.size()), kMissing);
    open();
  }

  bool next(Sample& sample) override {
    begin_sample(sample);
    bool has_any = false;
    for (;;) {
      if (!is_held_ && !read_message()) break;
      is_held_ = true;
      if (has_any && held_time_ns_ != sample.time_ns) break;
      sample.time_ns = held_time_ns_;
      has_any = true;
      is_held_ = false;
      take(sample);
    }
    if (!has_any) return false;
    finish_sample(sample);
    ++samples_;
    return true;
  }

  const std::vector<std::string>& names() const override { return names_; }
  const Eigen::Matrix3Xd& points_m() const override { return points_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return fmt::format("{}: sample {}", path_, samples_); }
  double progress() const override {
    return reader_.size_bytes() == 0 ? 0
                                     : static_cast<double>(reader_.sound_bytes()) /
                                           static_cast<double>(reader_.size_bytes());
  }

 private:
  void open() {
    if (reader_.open(path_) != hal::Status::ok) damaged(reader_.problem().reason);
  }
  [[noreturn]] void damaged(const std::string& what) const {
    throw InputError(path_, what, "export the recording again");
  }

  // The next record; false at the end.
  bool read_record(hal::McapRecord& record) {
    const hal::McapRead outcome = reader_.next(record);
    if (outcome == hal::McapRead::record) return true;
    if (outcome == hal::McapRead::end) return false;
    damaged(fmt::format("is damaged at byte {}: {}", reader_.problem().byte_offset,
                        reader_.problem().reason));
  }

  // Channels, markers and counts, before anything is computed.
  void survey() {
    hal::McapRecord record;
    std::size_t samples = 0, channels = 0;
    TimeNs last_ns = std::numeric_limits<TimeNs>::min();
    while (read_record(record)) {
      if (const auto* metadata = std::get_if<hal::McapMetadata>(&record)) {
        if (metadata->name == kExportMetadata) take_facts(metadata->pairs);
      } else if (const auto* channel = std::get_if<hal::McapChannel>(&record)) {
        add_channel(*channel);
        channels += channel->topic.starts_with(kChannelTopics) ? 1U : 0U;
      } else if (const auto* message = std::get_if<hal::McapMessage>(&record)) {
        const Role role = role_of(*message).role;
        if (role == Role::event) take_marker(*message);
        if (role == Role::other || role == Role::event) continue;
        CdrReader reader(message->data);
        const TimeNs time_ns = reader.time();
        if (time_ns != last_ns) ++samples;
        last_ns = time_ns;
      }
    }
    info_.stated.maker = "condyle";
    info_.stated.unit = "m";
    info_.stated.frames = samples;
    if (channels > 0) {
      info_.notes.push_back(
          fmt::format("{} analogue channels are not read from this format", channels));
    }
  }

  void take_facts(const hal::McapPairs& pairs) {
    if (fact(pairs, "format") != kExportFormat) {
      throw InputError(path_, "was exported by another version of condyle",
                       "export the recording again");
    }
    double offset = 0;
    const std::string_view offset_text = fact(pairs, "time_offset_ns");
    if (parse_number(offset_text, offset) != NumberStatus::ok || std::abs(offset) > 9.2e18) {
      damaged("has no usable time_offset_ns");
    }
    offset_ns_ = std::strtoll(std::string(offset_text).c_str(), nullptr, 10);
    const std::string_view kind = fact(pairs, "kind");
    info_.kind = kind == kKindAxis   ? SampleKind::one_axis
                 : kind == kKindPose ? SampleKind::pose
                                     : SampleKind::three_points;
  }

  void add_channel(const hal::McapChannel& channel) {
    Channel known;
    if (channel.topic.starts_with(kPointTopics) && info_.kind == SampleKind::three_points) {
      known = {Role::point, names_.size()};
      names_.emplace_back(fact(channel.metadata, "name"));
      if (names_.size() > kMostPoints) damaged("has more than 10000 points");
    }
    if (channel.topic == kPoseTopic && info_.kind == SampleKind::pose) known.role = Role::pose;
    if (channel.topic == kPositionTopic) known.role = Role::position;
    if (channel.topic == kDriveTopic) {
      known.role = Role::drive;
      info_.has_drive = true;
    }
    if (channel.topic == kEventTopic) known.role = Role::event;
    if (channel.message_encoding != "cdr") known.role = Role::other;
    channels_.emplace(channel.id, known);
  }

  Channel role_of(const hal::McapMessage& message) const {
    const auto known = channels_.find(message.channel_id);
    return known == channels_.end() ? Channel{} : known->second;
  }

  struct Event {
    TimeNs time_ns = 0;
    std::string_view from, text;
  };
  Event event_of(const hal::McapMessage& message) const {
    CdrReader reader(message.data);
    Event event;
    event.time_ns = reader.time() - offset_ns_;
    reader.number8();
    event.from = reader.text();
    event.text = reader.text();
    if (!reader.ok()) damaged("has an event that cannot be read");
    return event;
  }
  void take_marker(const hal::McapMessage& message) {
    const Event event = event_of(message);
    if (event.from != kMarkerName) return;
    info_.stated.events.push_back({seconds(event.time_ns), std::string(event.text)});
  }

  // Reads on to a message of a sample.
  bool read_message() {
    hal::McapRecord record;
    while (read_record(record)) {
      const auto* message = std::get_if<hal::McapMessage>(&record);
      if (message == nullptr) continue;
      held_ = role_of(*message);
      if (held_.role == Role::other) continue;
      if (held_.role == Role::event) {
        const Event event = event_of(*message);
        if (event.from != kRecordingName) continue;
        held_time_ns_ = event.time_ns;
        return true;
      }
      CdrReader reader(message->data);
      held_time_ns_ = reader.time() - offset_ns_;
      reader.text();
      const int count = held_.role == Role::pose ? 7 : held_.role == Role::point ? 3 : 1;
      for (int i = 0; i < count; ++i) values_[i] = reader.number64();
      if (!reader.ok())
        damaged(fmt::format("has a message that cannot be read, after sample {}", samples_));
      return true;
    }
    return false;
  }

  void begin_sample(Sample& sample) {
    sample = Sample{};
    sample.sequence = samples_;
    sample.kind = info_.kind;
    sample.position_valid = false;
    points_m_.setConstant(kMissing);
    std::fill(std::begin(sample.coordinates), std::end(sample.coordinates), kMissing);
  }

  void take(Sample& sample) {
    switch (held_.role) {
      case Role::point: {
        const Eigen::Vector3d place_m(values_[0], values_[1], values_[2]);
        if (place_m.allFinite() && place_m.cwiseAbs().maxCoeff() <= kFarthestPosition_m) {
          points_m_.col(static_cast<Eigen::Index>(held_.point)) = place_m;
        }
        return;
      }
      case Role::pose:
        std::copy_n(values_, 3, sample.coordinates);
        sample.coordinates[3] = values_[6];
        std::copy_n(values_ + 3, 3, sample.coordinates + 4);
        return;
      case Role::position:
        sample.coordinates[0] = values_[0];
        return;
      case Role::drive:
        sample.drive_N = values_[0];
        sample.drive_valid = std::isfinite(values_[0]);
        return;
      case Role::event:
      case Role::other:
        return;
    }
  }

  void finish_sample(Sample& sample) const {
    if (info_.kind == SampleKind::three_points) return;  // with_markers fills it
    const auto count = static_cast<std::ptrdiff_t>(coordinate_count(info_.kind));
    sample.position_valid = std::all_of(sample.coordinates, sample.coordinates + count,
                                        [](double value) { return std::isfinite(value); }) &&
                            !is_out_of_range(info_.kind, sample.coordinates);
  }

  std::string path_;
  hal::McapReader reader_{
      {.record_bytes = std::size_t{1} << 20, .chunk_bytes = std::size_t{4} << 20}};
  RecordingInfo info_;
  std::vector<std::string> names_;
  std::map<std::uint16_t, Channel> channels_;
  TimeNs offset_ns_ = 0;
  Eigen::Matrix3Xd points_m_;
  // The message read last.
  bool is_held_ = false;
  Channel held_;
  TimeNs held_time_ns_ = 0;
  double values_[7] = {};
  std::uint64_t samples_ = 0;
};

}  // namespace

bool is_exported_mcap(const std::string& path) {
  hal::McapReader reader(
      {.record_bytes = std::size_t{1} << 20, .chunk_bytes = std::size_t{4} << 20});
  if (reader.open(path) != hal::Status::ok) return false;
  hal::McapRecord record;
  while (reader.next(record) == hal::McapRead::record) {
    if (std::holds_alternative<hal::McapMessage>(record)) return false;
    const auto* metadata = std::get_if<hal::McapMetadata>(&record);
    if (metadata != nullptr) return metadata->name == kExportMetadata;
  }
  return false;
}

std::unique_ptr<NamedPointsRecording> open_exported_mcap(const std::string& path) {
  return std::make_unique<ExportedMcap>(path);
}

}  // namespace condyle::host
