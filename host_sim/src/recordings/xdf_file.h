// SPDX-License-Identifier: Apache-2.0
// XDF files, as LabRecorder writes them: streams of the Lab Streaming Layer in one file. The format
// is described at https://github.com/sccn/xdf/wiki/Specifications.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hosted/files/byte_reader.h"

namespace condyle::host {

/// The bytes of the values of a stream.
enum class XdfFormat { float32, double64, int8, int16, int32, int64, text };

/// A channel of a stream, as its header describes it; texts may be empty.
struct XdfChannel {
  std::string label, unit, type, marker;
};

/// A measurement of a stream's clock.
struct XdfOffset {
  double time_s = 0;    ///< on the clock of the stream
  double offset_s = 0;  ///< to be added for the clock of the recording computer
};

/// What the header of a stream states.
struct XdfStream {
  std::uint32_t id = 0;
  std::string name, type;
  XdfFormat format = XdfFormat::float32;
  std::size_t channels = 0;
  double rate_Hz = 0;  ///< 0: irregular
  std::vector<XdfChannel> described;
  std::vector<XdfOffset> offsets;
  std::uint64_t samples = 0;
};

/// A sample of a stream.
struct XdfSample {
  std::size_t stream = 0;  ///< index in XdfReader::streams()
  double time_s = 0;       ///< on the clock of the stream
  std::vector<double> values;
  std::string text;  ///< first channel of a stream of texts
};

/// Reads a file front to back. Throws InputError for what is not XDF.
class XdfReader {
 public:
  explicit XdfReader(const std::string& path);

  /// Next sample of any stream; false at the end, and where the file is cut.
  bool next(XdfSample& sample);
  /// What was read so far: headers, and offsets of clocks, which come between samples.
  const std::vector<XdfStream>& streams() const { return streams_; }
  /// The last chunk is not whole.
  bool is_cut() const { return is_cut_; }
  double progress() const { return reader_.progress(); }

 private:
  bool begin_chunk();
  void read_header(std::string_view xml);
  bool take(void* target, std::size_t count);
  bool take_length(std::uint64_t& length);
  bool take_text(std::string& text, std::size_t most);
  bool pass(std::uint64_t count);
  std::size_t stream_of(std::uint32_t id) const;
  [[noreturn]] void fail(const std::string& problem) const;
  bool read_value(XdfFormat format, double& value);

  ByteReader reader_;
  std::vector<XdfStream> streams_;
  std::vector<double> last_time_s_;  // of each stream; NaN: none
  std::uint64_t left_ = 0;           // bytes of the chunk
  std::uint64_t samples_left_ = 0;   // of the chunk
  std::size_t stream_ = 0;           // of the chunk
  bool is_cut_ = false;
};

/// Adds to the times of a stream what the measurements of its clock say: a line through them, on
/// which single ones that were late have little weight.
class XdfClock {
 public:
  explicit XdfClock(const std::vector<XdfOffset>& offsets);
  double corrected_s(double time_s) const {
    return time_s + at_middle_s_ + drift_ * (time_s - middle_s_);
  }
  /// The clock was set back, or jumped by more than a second.
  bool was_reset() const { return was_reset_; }

 private:
  double middle_s_ = 0, at_middle_s_ = 0, drift_ = 0;
  bool was_reset_ = false;
};

}  // namespace condyle::host
