// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/session_log_reader.h"

#include <algorithm>

#include "log/session_format.h"

namespace condyle::hal {

std::string describe(const SessionLogCondition& condition) {
  const std::string where = condition.problem.reason + " (at byte " +
                            std::to_string(condition.problem.byte_offset) + "; " +
                            std::to_string(condition.lost_bytes) + " bytes are lost)";
  switch (condition.outcome) {
    case McapRead::record:
      return "not read to its end";
    case McapRead::end:
      return "complete";
    case McapRead::truncated:
      return "cut off: " + where;
    case McapRead::damaged:
      break;
  }
  return "damaged: " + where;
}

namespace {

constexpr McapLimits kLimits = {
    .record_bytes = 2 * kMaxTextBytes, .chunk_bytes = kMaxChunkBytes, .is_strict = true};

}  // namespace

SessionLogReader::SessionLogReader() : mcap_(kLimits) {}

void SessionLogReader::close() {
  mcap_.close();
}

Status SessionLogReader::open(const std::string& path) {
  header_ = {};
  condition_ = {};
  next_sequence_ = {};
  has_channel_ = {};
  const Status status = mcap_.open(path);
  if (status != Status::ok) {
    static_cast<void>(stop(McapRead::damaged, mcap_.problem().reason));
    return status;
  }
  const std::string problem = take_header();
  if (problem.empty()) return Status::ok;
  static_cast<void>(stop(McapRead::damaged, problem));
  close();
  return Status::bad_report;
}

// The records before the first chunk have a fixed order: header, facts, attachments.
std::string SessionLogReader::take_header() {
  McapRecord record;
  const auto next = [&]() -> std::string {
    const McapRead outcome = mcap_.next(record);
    if (outcome == McapRead::record) return {};
    return outcome == McapRead::end ? "it has no session"
                                    : "in its header: " + mcap_.problem().reason;
  };
  const auto attachment = [&](const std::string& name, auto& content) -> std::string {
    if (std::string problem = next(); !problem.empty()) return problem;
    const auto* found = std::get_if<McapAttachment>(&record);
    if (found == nullptr || found->name != name) return "it lacks \"" + name + "\"";
    content.assign(found->data.begin(), found->data.end());
    return {};
  };
  if (std::string problem = next(); !problem.empty()) return problem;
  if (std::string problem = next(); !problem.empty()) return problem;
  const auto* metadata = std::get_if<McapMetadata>(&record);
  if (metadata == nullptr || metadata->name != kSessionMetadata) {
    return "it is an MCAP file, but not a session log";
  }
  if (std::string problem = parse_session_pairs(metadata->pairs, header_); !problem.empty()) {
    return problem;
  }
  const bool has_begun_with =
      std::any_of(metadata->pairs.begin(), metadata->pairs.end(),
                  [](const auto& pair) { return pair.first == kBegunWithKey; });
  std::string problem = attachment(std::string(kParametersName), header_.parameters_toml);
  for (std::size_t i = 0; i < header_.sources.size() && problem.empty(); ++i) {
    problem = attachment(profile_name(i), header_.sources[i].profile_toml);
    if (problem.empty())
      problem = attachment(descriptor_name(i), header_.sources[i].report_descriptor);
  }
  if (has_begun_with && problem.empty()) {
    problem = attachment(std::string(kBegunWithName), header_.begun_with_json);
  }
  return problem.empty() ? header_problem(header_) : problem;
}

McapRead SessionLogReader::next(SessionEntry& entry) {
  if (condition_.outcome != McapRead::record) return condition_.outcome;
  McapRecord record;
  for (;;) {
    const McapRead outcome = mcap_.next(record);
    if (outcome != McapRead::record) return stop(outcome, mcap_.problem().reason);
    if (const auto* message = std::get_if<McapMessage>(&record)) {
      if (!take(*message, entry)) {
        return stop(McapRead::damaged,
                    "a message does not belong to a session log, or the one before is missing");
      }
      if (!entry.is_event) condition_.last_report_time_ns = entry.report.host_time_ns;
      return McapRead::record;
    }
    const auto* attachment = std::get_if<McapAttachment>(&record);
    if (attachment != nullptr && attachment->name == kLearnedName) continue;
    const auto* schema = std::get_if<McapSchema>(&record);
    const auto* channel = std::get_if<McapChannel>(&record);
    if ((schema == nullptr || !take(*schema)) && (channel == nullptr || !take(*channel))) {
      return stop(McapRead::damaged, "a record does not belong to a session log");
    }
  }
}

Status read_learned_text(const std::string& path, std::string& text) {
  text.clear();
  McapReader mcap(kLimits);
  const Status status = mcap.open(path);
  if (status != Status::ok) return status;
  McapRecord record;
  while (mcap.next(record) == McapRead::record) {
    const auto* attachment = std::get_if<McapAttachment>(&record);
    if (attachment == nullptr || attachment->name != kLearnedName) continue;
    text.assign(attachment->data.begin(), attachment->data.end());
  }
  return Status::ok;
}

bool SessionLogReader::take(const McapSchema& schema) {
  const bool is_report = schema.id == 1;
  return (is_report || schema.id == 2) && schema.encoding == "ros2msg" &&
         schema.name == (is_report ? kReportSchemaName : kEventSchemaName) &&
         text_of(schema.data) == (is_report ? kReportSchema : kEventSchema);
}

bool SessionLogReader::take(const McapChannel& channel) {
  const std::size_t source_index = (std::size_t{channel.id} + 1) / 2 - 1;
  if (channel.id == 0 || source_index >= header_.sources.size()) return false;
  const bool is_report = channel.id == report_channel(source_index);
  has_channel_[channel.id] = true;
  return channel.message_encoding == "cdr" && channel.schema_id == (is_report ? 1 : 2) &&
         channel.topic == (is_report ? report_topic(source_index) : event_topic(source_index));
}

bool SessionLogReader::take(const McapMessage& message, SessionEntry& entry) {
  const std::uint16_t id = message.channel_id;
  if (id >= has_channel_.size() || !has_channel_[id]) return false;
  if (message.sequence != next_sequence_[id]++) return false;
  entry.source_index = (std::size_t{id} + 1) / 2 - 1;
  entry.is_event = id == event_channel(entry.source_index);
  return entry.is_event ? decode_event(message.data, entry.event)
                        : decode_report(message.data, entry.report);
}

McapRead SessionLogReader::stop(McapRead outcome, std::string reason) {
  condition_.outcome = outcome;
  condition_.lost_bytes = mcap_.size_bytes() - mcap_.sound_bytes();
  // For a whole record the reader gives only its end.
  const McapProblem& problem = mcap_.problem();
  condition_.problem = {problem.reason.empty() ? mcap_.sound_bytes() : problem.byte_offset,
                        std::move(reason)};
  return outcome;
}

}  // namespace condyle::hal
