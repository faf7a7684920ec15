// SPDX-License-Identifier: Apache-2.0
// Carstens AG501 and AG500 positions (.pos) with a header: a line "AG50xDATA_V003", a line with the
// size of the header in bytes, lines KEY=VALUE with NumberOfChannels and SamplingFrequencyHz, then
// frames of seven 32-bit floats (Intel order) a channel: x, y, z (mm), two angles, the residual and
// a spare value. A channel whose values are all zero was not measured.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "hosted/files/input_error.h"
#include "recordings/file_units.h"
#include "recordings/named_points.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

constexpr std::size_t kValues = 7, kValueSize = 4, kMostChannels = 64, kLargestHeader = 65536;

class CarstensRecording final : public NamedPointsRecording {
 public:
  CarstensRecording(std::unique_ptr<ByteReader> reader, const RecordingOptions& options)
      : reader_(std::move(reader)), filled_(options.missing) {
    info_.format = "Carstens AG50x positions";
    info_.kind = SampleKind::one_point;
    info_.stated.maker = "Carstens";
    info_.stated.unit = "mm";
    use_given_unit(options.units_per_metre, info_);
    units_per_metre_ = options.units_per_metre.value_or(1000);
    read_header();
    info_.stated.rate_Hz = rate_Hz_;
    info_.nominal_step_ns = nanoseconds(1 / rate_Hz_);
    for (std::size_t channel = 1; channel <= channels_; ++channel) {
      names_.push_back(fmt::format("ch{}", channel));
    }
    points_m_.resize(3, static_cast<Eigen::Index>(channels_));
  }

  bool next(Sample& sample) override {
    const std::size_t size = channels_ * kValues * kValueSize;
    const std::string_view record = reader_->peek(size);
    if (record.empty()) {
      if (!has_ended_) filled_.add_notes(info_.notes);
      has_ended_ = true;
      return false;
    }
    if (record.size() < size) {
      throw InputError(
          place(),
          fmt::format("the file ends inside the next frame: {} of {} bytes", record.size(), size),
          "copy the file again");
    }
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_++;
    sample.time_ns = regular_time_ns(0, sample.sequence, 1 / rate_Hz_, reader_->path());
    for (std::size_t channel = 0; channel < channels_; ++channel) {
      const char* const values = record.data() + channel * kValues * kValueSize;
      Eigen::Vector3d point_m;
      for (int axis = 0; axis < 3; ++axis) {
        point_m[axis] =
            value(values + static_cast<std::size_t>(axis) * kValueSize) / units_per_metre_;
      }
      const bool is_seen = point_m.allFinite() && !point_m.isZero(0) &&
                           point_m.cwiseAbs().maxCoeff() <= kFarthestPosition_m;
      if (!is_seen) point_m.setConstant(std::numeric_limits<double>::quiet_NaN());
      points_m_.col(static_cast<Eigen::Index>(channel)) = point_m;
    }
    filled_.drop(points_m_, units_per_metre_, [this] { return place(); });
    sample.position_valid = false;  // until a channel is chosen
    reader_->skip(size);
    return true;
  }

  const std::vector<std::string>& names() const override { return names_; }
  const Eigen::Matrix3Xd& points_m() const override { return points_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override {
    return fmt::format("{}: frame {} at byte {}", reader_->path(), sequence_, reader_->offset());
  }
  double progress() const override { return reader_->progress(); }

 private:
  static double value(const char* bytes) {
    std::uint32_t bits = 0;
    for (std::size_t i = kValueSize; i-- > 0;) {
      bits = bits << 8U | static_cast<unsigned char>(bytes[i]);
    }
    return static_cast<double>(std::bit_cast<float>(bits));
  }

  [[noreturn]] void refuse(const std::string& problem) const {
    throw InputError(fmt::format("{}:{}", reader_->path(), reader_->line_number()), problem,
                     "check that this is a .pos file of an AG500 or AG501 with its header");
  }

  void read_header() {
    std::string_view line;
    double size = 0, channels = 0;
    if (!reader_->next_line(line) || !reader_->next_line(line) ||
        parse_number(line, size) != NumberStatus::ok || !(size >= 1 && size <= kLargestHeader)) {
      refuse("its second line is not the size of the header");
    }
    while (static_cast<double>(reader_->offset()) < size) {
      const std::uint64_t left = static_cast<std::uint64_t>(size) - reader_->offset();
      const std::string_view rest = reader_->peek(static_cast<std::size_t>(left));
      // The last lines may be zeros, which fill the header.
      if (rest.find('\n') == std::string_view::npos) {
        if (rest.size() < left) refuse("the file ends inside its header");
        reader_->skip(rest.size());
        break;
      }
      if (!reader_->next_line(line)) refuse("the file ends inside its header");
      const std::size_t equals = line.find('=');
      const std::string_view key = line.substr(0, equals);
      if (equals == std::string_view::npos) continue;
      const std::string_view text = line.substr(equals + 1);
      if (key == "NumberOfChannels" && parse_number(text, channels) != NumberStatus::ok) {
        refuse(fmt::format("NumberOfChannels {} is not a number", quote(text)));
      }
      if (key == "SamplingFrequencyHz" && parse_number(text, rate_Hz_) != NumberStatus::ok) {
        refuse(fmt::format("SamplingFrequencyHz {} is not a number", quote(text)));
      }
    }
    if (!(channels >= 1 && channels <= kMostChannels) || channels != std::floor(channels)) {
      refuse("the header lacks a usable NumberOfChannels");
    }
    if (!(rate_Hz_ >= 1e-3 && rate_Hz_ <= 1e6)) {
      refuse("the header lacks a usable SamplingFrequencyHz");
    }
    channels_ = static_cast<std::size_t>(channels);
  }

  std::unique_ptr<ByteReader> reader_;
  RecordingInfo info_;
  std::vector<std::string> names_;
  Eigen::Matrix3Xd points_m_;
  std::size_t channels_ = 0;
  double rate_Hz_ = 0, units_per_metre_ = 1000;
  FilledNumbers filled_;
  std::uint64_t sequence_ = 0;
  bool has_ended_ = false;
};

}  // namespace

std::unique_ptr<NamedPointsRecording> open_carstens(std::unique_ptr<ByteReader> reader,
                                                    const RecordingOptions& options) {
  return std::make_unique<CarstensRecording>(std::move(reader), options);
}

}  // namespace condyle::host
