// SPDX-License-Identifier: Apache-2.0
// C3D: points and analogue channels of motion capture, as the C3D file format's user guide
// describes it (https://www.c3d.org/docs/C3D_User_Guide.pdf).
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/analog_channels.h"
#include "recordings/c3d.h"
#include "recordings/c3d_layout.h"
#include "recordings/named_points.h"

namespace condyle::host {
namespace {

// The frames of a file, one after the other.
class C3dFrames {
 public:
  C3dFrames(std::unique_ptr<ByteReader> reader, FaultPolicy faults)
      : reader_(std::move(reader)),
        faults_(faults),
        layout_(read_c3d_layout(*reader_)),
        bytes_(layout_.frame_bytes(), '\0') {}

  void find_unit(std::optional<double> given_per_metre) {
    find_c3d_unit(*reader_, given_per_metre, layout_);
  }

  const C3dLayout& layout() const { return layout_; }

  bool next() {
    if (frames_ == layout_.frames || has_ended_) return false;
    for (std::size_t filled = 0; filled < bytes_.size();) {
      const std::string_view part =
          reader_->peek(std::min(bytes_.size() - filled, ByteReader::kLongestLine));
      if (part.empty()) {
        end_early();
        return false;
      }
      std::memcpy(bytes_.data() + filled, part.data(), part.size());
      filled += part.size();
      reader_->skip(part.size());
    }
    ++frames_;
    return true;
  }

  // Of the frame last read.
  const char* bytes(std::size_t number) const {
    return bytes_.data() + number * layout_.number_bytes();
  }
  std::uint64_t index() const { return frames_ - 1; }
  TimeNs time_ns(double later_s = 0) const {
    const double time_s = static_cast<double>(index()) / layout_.rate_Hz + later_s;
    if (!(time_s <= kFurthestTime_s)) {
      throw InputError(place(), fmt::format("is {:.3g} s after the first frame", time_s),
                       "check the frame rate in the header");
    }
    return nanoseconds(time_s);
  }
  std::string place() const {
    return frames_ == 0 ? reader_->path() : fmt::format("{}: frame {}", reader_->path(), frames_);
  }
  double progress() const { return reader_->progress(); }

 private:
  void end_early() {
    has_ended_ = true;
    const std::string what = fmt::format("ends after {} of {} frames", frames_, layout_.frames);
    if (faults_ == FaultPolicy::refuse) {
      throw InputError(reader_->path(), what,
                       "copy the file again, or read what is there with --faults event");
    }
    layout_.notes.push_back("it " + what);
  }

  std::unique_ptr<ByteReader> reader_;
  FaultPolicy faults_;
  C3dLayout layout_;
  std::string bytes_;         // of a frame
  std::uint64_t frames_ = 0;  // read
  bool has_ended_ = false;
};

class C3dRecording final : public NamedPointsRecording {
 public:
  C3dRecording(std::unique_ptr<ByteReader> reader, const RecordingOptions& options)
      : frames_(std::move(reader), options.faults), filled_(options.missing) {
    frames_.find_unit(options.units_per_metre);
    const C3dLayout& layout = frames_.layout();
    info_.format = "C3D";
    info_.kind = SampleKind::three_points;
    info_.nominal_step_ns = nanoseconds(1 / layout.rate_Hz);
    info_.stated = layout.stated;
    info_.notes = layout.notes;
    points_m_.setConstant(3, static_cast<Eigen::Index>(layout.names.size()),
                          std::numeric_limits<double>::quiet_NaN());
  }

  bool next(Sample& sample) override {
    const C3dLayout& layout = frames_.layout();
    if (!frames_.next()) {
      info_.notes = layout.notes;
      filled_.add_notes(info_.notes);
      return false;
    }
    sample = Sample{};
    sample.sequence = frames_.index();
    sample.time_ns = frames_.time_ns();
    for (Eigen::Index i = 0; i < points_m_.cols(); ++i) {
      const Eigen::Vector3d place_m =
          c3d_point(layout, frames_.bytes(4 * static_cast<std::size_t>(i))) /
          layout.units_per_metre;
      // Also NaN and infinity.
      const bool is_there =
          place_m.cwiseAbs().maxCoeff() <= kFarthestPosition_m && place_m.allFinite();
      points_m_.col(i) =
          is_there ? place_m : Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    }
    filled_.drop(points_m_, layout.units_per_metre, [this] { return place(); });
    return true;
  }

  const std::vector<std::string>& names() const override { return frames_.layout().names; }
  const Eigen::Matrix3Xd& points_m() const override { return points_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return frames_.place(); }
  double progress() const override { return frames_.progress(); }

 private:
  C3dFrames frames_;
  FilledNumbers filled_;
  RecordingInfo info_;
  Eigen::Matrix3Xd points_m_;
};

class C3dChannels final : public AnalogReader {
 public:
  C3dChannels(std::unique_ptr<ByteReader> reader, const std::vector<std::string>& names,
              FaultPolicy faults)
      : frames_(std::move(reader), faults), values_(names.size()) {
    const C3dLayout& layout = frames_.layout();
    numbers_ = channel_numbers(names, layout.stated.channels, frames_.place());
    for (const std::size_t number : numbers_) {
      channels_.push_back(layout.stated.channels[number]);
      if (!layout.channels[number].is_scaled) channels_.back().unit.clear();
    }
    sample_ = layout.samples;
  }

  bool next() override {
    const C3dLayout& layout = frames_.layout();
    if (++sample_ >= layout.samples) {
      if (!frames_.next()) return false;
      sample_ = 0;
    }
    const std::size_t first = 4 * layout.names.size() + sample_ * layout.channels.size();
    for (std::size_t i = 0; i < numbers_.size(); ++i) {
      const C3dChannel& channel = layout.channels[numbers_[i]];
      const char* const bytes = frames_.bytes(first + numbers_[i]);
      const double number = layout.is_unsigned && !layout.has_floats
                                ? static_cast<double>(c3d_word(layout.processor, bytes))
                                : c3d_number(layout, bytes);
      values_[i] = (number - channel.offset) * channel.scale;
      if (!std::isfinite(values_[i])) values_[i] = std::numeric_limits<double>::quiet_NaN();
    }
    return true;
  }

  TimeNs time_ns() const override {
    const C3dLayout& layout = frames_.layout();
    return frames_.time_ns(static_cast<double>(sample_) /
                           (layout.rate_Hz * static_cast<double>(layout.samples)));
  }
  const std::vector<double>& values() const override { return values_; }
  const std::vector<AnalogChannel>& channels() const override { return channels_; }
  std::string place() const override { return frames_.place(); }
  double progress() const override { return frames_.progress(); }
  const std::vector<std::string>& notes() const override { return frames_.layout().notes; }

 private:
  C3dFrames frames_;
  std::vector<std::size_t> numbers_;
  std::vector<AnalogChannel> channels_;
  std::vector<double> values_;
  std::size_t sample_ = 0;  // of the frame
};

}  // namespace

std::unique_ptr<NamedPointsRecording> open_c3d(std::unique_ptr<ByteReader> reader,
                                               const RecordingOptions& options) {
  return std::make_unique<C3dRecording>(std::move(reader), options);
}

std::unique_ptr<AnalogReader> open_c3d_analog(std::unique_ptr<ByteReader> reader,
                                              const std::vector<std::string>& names,
                                              FaultPolicy faults) {
  return std::make_unique<C3dChannels>(std::move(reader), names, faults);
}

}  // namespace condyle::host
