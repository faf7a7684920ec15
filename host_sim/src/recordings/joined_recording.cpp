// SPDX-License-Identifier: Apache-2.0
// Three recordings of one point each, read row by row as one recording of three points. Row k of
// each must have the same time; nothing is resampled.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>

#include "hosted/files/input_error.h"
#include "recordings/recording_files.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

constexpr std::size_t kParts = 3;
constexpr TimeNs kSameTime_ns = 1000;

std::string kind_text(SampleKind kind) {
  switch (kind) {
    case SampleKind::one_axis:
      return "one axis";
    case SampleKind::one_point:
      return "one point";
    case SampleKind::three_points:
      return "three points";
    case SampleKind::pose:
      return "a pose";
  }
  return "another kind of position";
}

struct Part {
  std::string path;
  std::unique_ptr<Recording> recording;
};

class JoinedRecording final : public Recording {
 public:
  explicit JoinedRecording(std::vector<Part> parts) : parts_(std::move(parts)) {
    for (std::size_t i = 0; i < kParts; ++i) check(i);
    const RecordingInfo& first = part_info(0);
    info_.kind = SampleKind::three_points;
    for (std::size_t i = 0; i < kParts; ++i) {
      if (!part_info(i).has_drive) continue;
      if (drive_part_) {
        throw InputError(parts_[i].path,
                         fmt::format("has a drive, as {} has", parts_[*drive_part_].path),
                         "take the drive out of one of the two files");
      }
      drive_part_ = i;
    }
    info_.has_drive = drive_part_.has_value();
    const auto all = [&](auto member) {
      return std::all_of(parts_.begin(), parts_.end(), [&](const Part& part) {
        return part.recording->info().*member == first.*member;
      });
    };
    if (all(&RecordingInfo::nominal_step_ns)) info_.nominal_step_ns = first.nominal_step_ns;
    info_.format =
        all(&RecordingInfo::format)
            ? fmt::format("{} x {}", kParts, first.format)
            : fmt::format("{} + {} + {}", first.format, part_info(1).format, part_info(2).format);
    collect_notes();
  }

  bool next(Sample& sample) override {
    std::array<Sample, kParts> rows;
    std::array<bool, kParts> has_row{};
    for (std::size_t i = 0; i < kParts; ++i) has_row[i] = parts_[i].recording->next(rows[i]);
    const auto ended = std::find(has_row.begin(), has_row.end(), false);
    if (ended != has_row.end()) {
      const auto longer = std::find(has_row.begin(), has_row.end(), true);
      if (longer != has_row.end()) {
        refuse_lengths(static_cast<std::size_t>(ended - has_row.begin()),
                       static_cast<std::size_t>(longer - has_row.begin()));
      }
      collect_notes();  // some notes are known at the end only
      return false;
    }
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_++;
    sample.time_ns = rows[0].time_ns;
    for (std::size_t i = 0; i < kParts; ++i) {
      check_time(i, rows);
      sample.time_valid = sample.time_valid && rows[i].time_valid;
      sample.position_valid = sample.position_valid && rows[i].position_valid;
      std::copy_n(rows[i].coordinates, 3, sample.coordinates + 3 * i);
    }
    if (drive_part_) {
      sample.drive_N = rows[*drive_part_].drive_N;
      sample.drive_valid = rows[*drive_part_].drive_valid;
    }
    return true;
  }

  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return parts_[0].recording->place(); }
  double progress() const override { return parts_[0].recording->progress(); }

 private:
  const RecordingInfo& part_info(std::size_t part) const { return parts_[part].recording->info(); }

  void check(std::size_t part) const {
    const RecordingInfo& info = part_info(part);
    if (info.is_of_device) {
      throw InputError(parts_[part].path, "is a recording of a device, which cannot be joined",
                       "replay it by itself");
    }
    if (info.kind != SampleKind::one_point) {
      throw InputError(parts_[part].path,
                       fmt::format("part {} of the joined recording has {}, not one point",
                                   part + 1, kind_text(info.kind)),
                       info.kind == SampleKind::one_axis
                           ? "give x, y and z of one point in each file"
                           : "give this file by itself, or three files with one point each");
    }
  }

  void check_time(std::size_t part, const std::array<Sample, kParts>& rows) const {
    for (std::size_t other = 0; other < part; ++other) {
      if (!rows[part].time_valid || !rows[other].time_valid ||
          std::abs(rows[part].time_ns - rows[other].time_ns) <= kSameTime_ns) {
        continue;
      }
      throw InputError(
          parts_[part].recording->place(),
          fmt::format("row {} is at {:.9g} s, in {} at {:.9g} s", sequence_,
                      seconds(rows[part].time_ns), parts_[other].path,
                      seconds(rows[other].time_ns)),
          "join files of one take with the same times; condyle does not resample them");
    }
  }

  void refuse_lengths(std::size_t shorter, std::size_t longer) const {
    throw InputError(parts_[shorter].path,
                     fmt::format("ends after {} rows, before {}", sequence_, parts_[longer].path),
                     fmt::format("export the three again, or cut each after {} rows", sequence_));
  }

  // Notes of the parts. A note that several parts share appears once and names all of them.
  void collect_notes() {
    std::vector<std::pair<std::string, std::string>> files_of_notes;
    for (const Part& part : parts_) {
      for (const std::string& note : part.recording->info().notes) {
        const auto same = std::find_if(files_of_notes.begin(), files_of_notes.end(),
                                       [&](const auto& known) { return known.second == note; });
        if (same == files_of_notes.end()) {
          files_of_notes.emplace_back(part.path, note);
        } else {
          same->first += ", " + part.path;
        }
      }
    }
    info_.notes.clear();
    for (const auto& [files, note] : files_of_notes) info_.notes.push_back(files + ": " + note);
  }

  std::vector<Part> parts_;
  std::optional<std::size_t> drive_part_;
  RecordingInfo info_;
  std::uint64_t sequence_ = 0;  // rows given
};

}  // namespace

std::unique_ptr<Recording> open_joined(const std::string& source, RecordingOptions options) {
  const std::vector<std::string> files = recording_files(source);
  if (options.reads_drive_alone) {
    throw InputError(source, "is several files", "give the drive in one file");
  }
  if (files.size() != kParts) {
    throw InputError(
        source,
        fmt::format("names no file, and {} files joined by '+', not {}", files.size(), kParts),
        "check the name, or join three files with one point each: A+B+C");
  }
  options.may_lack_ignored = true;  // a column to ignore may be in one part only
  std::vector<Part> parts;
  for (const std::string& file : files) {
    if (file.empty()) {
      throw InputError(source, "one of the joined files has no name",
                       "join three files with one point each: A+B+C");
    }
    for (const Part& known : parts) {
      std::error_code missing;
      if (known.path == file || std::filesystem::equivalent(known.path, file, missing)) {
        throw InputError(source, fmt::format("joins {} twice", file), "give each file once");
      }
    }
    parts.push_back({file, open_recording_file(file, options)});
  }
  return std::make_unique<JoinedRecording>(std::move(parts));
}

}  // namespace condyle::host
