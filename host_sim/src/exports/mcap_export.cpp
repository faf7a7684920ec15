// SPDX-License-Identifier: Apache-2.0
// MCAP with messages of ROS 2, which Foxglove and PlotJuggler show as they are:
//
//   /points/NAME    place of each point; not a number where it is missing
//   /jaw/pose, /tf  pose of the jaw, and points as frames; left out where missing
//   /jaw/position   one axis; /jaw/drive: force; /channels/NAME: analogue channels
//   /jaw/estimate   motion with intervals and provenance
//   /jaw/events     markers, missing poses, and events of the estimator
//
// Stamps are the recording's times, plus the offset in the metadata where those do not fit a stamp.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "condyle/hal/log/mcap_writer.h"
#include "exports/export_estimates.h"
#include "exports/export_format.h"
#include "exports/jaw_poses.h"
#include "exports/mcap_messages.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "output/event_text.h"
#include "recordings/mcap_topics.h"

namespace condyle::host {
namespace {

constexpr std::size_t kFullChunkBytes = std::size_t{256} << 10;

class McapFile {
 public:
  McapFile(const ExportData& data, OutputFile& file)
      : data_(data),
        file_(file),
        mcap_({.profile = "ros2", .library = "condyle " CONDYLE_VERSION}),
        poses_(jaw_poses(data)) {
    constexpr TimeNs kLastStamp = std::numeric_limits<std::int32_t>::max() * kNanosecondsPerSecond;
    const TimeNs first = std::min(data.time_ns.front(), first_other_ns());
    if (first < 0 || data.time_ns.back() > kLastStamp) offset_ns_ = -first;
    add_metadata();
    add_channels();
  }

  void write() {
    if (data_.estimates) {
      data_.estimates->run([this](const EstimateRow& row) { add_estimate(row); });
    }
    add_until(std::numeric_limits<TimeNs>::max());
    flush(true);
    if (!mcap_.finish([this] { return write_pending(); })) refuse();
    write_pending();
  }

 private:
  // A stream of messages that are not estimates, in the order of their times.
  struct Stream {
    std::function<TimeNs(std::size_t)> time_ns;
    std::function<void(std::size_t, TimeNs)> add;
    std::size_t count = 0, next = 0;
  };

  [[noreturn]] void refuse() const {
    throw InputError(file_.path(), "cannot be compressed", "free memory");
  }

  // Channels and markers may begin before the first sample.
  TimeNs first_other_ns() const {
    TimeNs first = data_.time_ns.front();
    for (const ExportChannel& channel : data_.channels) {
      first = std::min(first, nanoseconds(channel.first_s));
    }
    for (const NamedInstant& event : data_.events)
      first = std::min(first, nanoseconds(event.time_s));
    return first;
  }

  void add_metadata() {
    hal::McapPairs pairs = {{"format", std::string(kExportFormat)},
                            {"condyle", CONDYLE_VERSION},
                            {"read_as", clean_line(data_.info.format)},
                            {"time_offset_ns", std::to_string(offset_ns_)},
                            {"kind", kind_name()}};
    if (poses_) pairs.emplace_back("pose_provenance", provenance_name(poses_->provenance));
    if (poses_ && !poses_->assumption.empty()) {
      pairs.emplace_back("pose_assumption", poses_->assumption);
    }
    if (data_.estimates) {
      std::string mass;
      append_number(mass, data_.estimates->assumed_mass_kg());
      pairs.emplace_back("estimator", "recommended, no lag");
      pairs.emplace_back("estimated", data_.estimates->followed());
      pairs.emplace_back("assumed_mass_kg", mass);
    }
    mcap_.add_metadata({std::string_view(kExportMetadata), pairs});
  }

  // Of the measurements, for reading them back.
  const char* kind_name() const {
    if (data_.points().empty()) return kKindAxis;
    const bool is_pose =
        std::any_of(data_.series.begin(), data_.series.end(),
                    [](const ExportSeries& series) { return series.quantity == "orientation"; });
    return is_pose ? kKindPose : kKindPoints;
  }

  std::uint16_t channel(const std::string& topic, const MessageType& type, hal::McapPairs facts) {
    auto [known, is_new] = schemas_.emplace(type.name, 0);
    if (is_new) {
      const auto* text = reinterpret_cast<const std::uint8_t*>(type.definition.data());
      known->second = mcap_.add_schema(
          {.name = type.name, .encoding = "ros2msg", .data = {text, type.definition.size()}});
    }
    return mcap_.add_channel({.schema_id = known->second,
                              .topic = topic,
                              .message_encoding = "cdr",
                              .metadata = std::move(facts)});
  }

  void add_channels() {
    const auto facts = [](const ExportSeries& series) {
      hal::McapPairs pairs = {{"name", series.name},
                              {"provenance", provenance_name(series.provenance)},
                              {"unit", series.unit}};
      if (!series.assumption.empty()) pairs.emplace_back("assumption", series.assumption);
      return pairs;
    };
    const bool is_pose = kind_name() == std::string_view(kKindPose);
    for (const ExportSeries& series : data_.series) {
      if (is_pose && (series.is_point() || series.quantity == "orientation")) continue;
      if (series.is_point()) {
        points_.emplace_back(
            &series, channel(topic_of(kPointTopics, series.name), point_type(), facts(series)));
      } else if (series.components.size() == 1) {
        const bool is_drive = series.quantity == "force";
        values_.emplace_back(
            &series, channel(is_drive ? kDriveTopic : kPositionTopic, value_type(), facts(series)));
      }
    }
    if (poses_) pose_ = channel(kPoseTopic, pose_type(), {});
    if (poses_ || !points_.empty()) transforms_ = channel("/tf", transforms_type(), {});
    log_ = channel(kEventTopic, log_type(), {});
    if (data_.estimates) {
      estimate_ = channel("/jaw/estimate", estimate_type(data_.estimates->axis_count()),
                          {{"estimated", data_.estimates->followed()}});
    }
    streams_.push_back({[this](std::size_t k) { return data_.time_ns[k]; },
                        [this](std::size_t k, TimeNs time_ns) { add_sample(k, time_ns); },
                        data_.samples()});
    for (const ExportChannel& one : data_.channels) {
      const std::uint16_t id = channel(topic_of(kChannelTopics, one.channel.name), value_type(),
                                       {{"unit", one.channel.unit}, {"provenance", "measured"}});
      streams_.push_back({[&one](std::size_t k) {
                            return nanoseconds(one.first_s +
                                               static_cast<double>(k) / one.channel.rate_Hz);
                          },
                          [this, id, &one](std::size_t k, TimeNs time_ns) {
                            write_value(message_, stamp(time_ns), one.values[k]);
                            add(id, time_ns);
                          },
                          one.values.size()});
    }
    events_ = data_.events;
    std::stable_sort(
        events_.begin(), events_.end(),
        [](const NamedInstant& a, const NamedInstant& b) { return a.time_s < b.time_s; });
    streams_.push_back({[this](std::size_t k) { return nanoseconds(events_[k].time_s); },
                        [this](std::size_t k, TimeNs time_ns) {
                          write_log(message_, stamp(time_ns), false, kMarkerName, events_[k].name);
                          add(log_, time_ns);
                        },
                        events_.size()});
  }

  // Two names may give one topic, since topics have fewer characters.
  std::string topic_of(std::string_view folder, const std::string& name) {
    const std::string base = std::string(folder) + topic_word(name);
    std::string topic = base;
    for (int n = 2; ++topics_[topic] > 1; ++n) topic = fmt::format("{}_{}", base, n);
    return topic;
  }

  TimeNs stamp(TimeNs time_ns) const { return time_ns + offset_ns_; }
  void add(std::uint16_t id, TimeNs time_ns) {
    const std::uint64_t log_time = static_cast<std::uint64_t>(stamp(time_ns));
    mcap_.add_message(id, log_time, message_.bytes());
    flush(false);
  }
  void flush(bool all) {
    if (!all && mcap_.chunk_size() < kFullChunkBytes) return;
    if (!mcap_.finish_chunk()) refuse();
    write_pending();
  }
  bool write_pending() {
    const auto bytes = mcap_.pending();
    file_.write({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    mcap_.discard_pending();
    return true;
  }

  void add_sample(std::size_t k, TimeNs time_ns) {
    for (const auto& [series, id] : points_) {
      write_point(message_, stamp(time_ns), series->at(k));
      add(id, time_ns);
    }
    for (const auto& [series, id] : values_) {
      write_value(message_, stamp(time_ns), series->at(k)[0]);
      add(id, time_ns);
    }
    const std::optional<ExportPose>* const pose = poses_ ? &poses_->of_sample[k] : nullptr;
    if (pose != nullptr && *pose) {
      write_pose(message_, stamp(time_ns), **pose);
      add(pose_, time_ns);
    } else if (pose != nullptr && points_.empty()) {
      write_log(message_, stamp(time_ns), true, kRecordingName,
                event_name(Event::position_missing));
      add(log_, time_ns);
    }
    add_transforms(k, pose, time_ns);
  }

  void add_transforms(std::size_t k, const std::optional<ExportPose>* pose, TimeNs time_ns) {
    std::uint32_t count = pose != nullptr && *pose ? 1U : 0U;
    for (const auto& point : points_) count += point.first->is_there(k) ? 1U : 0U;
    if (count == 0) return;
    TransformsWriter transforms(message_);
    transforms.begin(count);
    if (pose != nullptr && *pose) transforms.add(stamp(time_ns), kJawFrame, **pose);
    for (const auto& [series, id] : points_) {
      if (!series->is_there(k)) continue;
      ExportPose place{{}, {1, 0, 0, 0}};
      std::copy_n(series->at(k), 3, place.position_m);
      transforms.add(stamp(time_ns), "point/" + topic_word(series->name), place);
    }
    add(transforms_, time_ns);
  }

  // Everything up to `time_ns`, and at it.
  void add_until(TimeNs time_ns) {
    for (;;) {
      Stream* first = nullptr;
      for (Stream& stream : streams_) {
        if (stream.next == stream.count || stream.time_ns(stream.next) > time_ns) continue;
        if (first == nullptr || stream.time_ns(stream.next) < first->time_ns(first->next)) {
          first = &stream;
        }
      }
      if (first == nullptr) return;
      first->add(first->next, first->time_ns(first->next));
      ++first->next;
    }
  }

  void add_estimate(const EstimateRow& row) {
    const bool is_in_order = row.time_ns && !row.events.has(Event::time_reversed) &&
                             *row.time_ns > last_estimate_ns_ &&
                             *row.time_ns <= data_.time_ns.back();
    const TimeNs time_ns =
        is_in_order ? *row.time_ns : std::max(last_estimate_ns_, data_.time_ns.front());
    if (is_in_order) {
      last_estimate_ns_ = time_ns;
      add_until(time_ns);
      write_estimate(message_, stamp(time_ns), row);
      add(estimate_, time_ns);
    }
    if (row.events.empty()) return;
    std::string text;
    append_events(text, row.events);
    write_log(message_, stamp(time_ns), true, kEstimatorName, text);
    add(log_, time_ns);
  }

  const ExportData& data_;
  OutputFile& file_;
  hal::McapWriter mcap_;
  std::optional<JawPoses> poses_;
  TimeNs offset_ns_ = 0, last_estimate_ns_ = std::numeric_limits<TimeNs>::min();
  std::map<std::string, std::uint16_t> schemas_;
  std::map<std::string, int> topics_;
  std::vector<std::pair<const ExportSeries*, std::uint16_t>> points_, values_;
  std::uint16_t pose_ = 0, transforms_ = 0, log_ = 0, estimate_ = 0;
  std::vector<NamedInstant> events_;
  std::vector<Stream> streams_;
  CdrWriter message_;
};

}  // namespace

Exported export_mcap(const ExportData& data, const TableForm& form, const std::string& out) {
  if (form.is_in_mm) {
    throw InputError("--out-unit mm", "is given, and messages of ROS 2 are in metres",
                     "leave it out");
  }
  Exported result;
  result.files.push_back(std::make_unique<OutputFile>(out));
  McapFile(data, *result.files.back()).write();
  result.files.back()->close();
  return result;
}

}  // namespace condyle::host
