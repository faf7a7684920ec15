// SPDX-License-Identifier: Apache-2.0
#include "inspect/byte_statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace condyle::host {
namespace {

struct Form {
  std::size_t width_bytes;
  bool is_big_endian;
};
constexpr Form kFormsTried[] = {{4, false}, {4, true}, {2, false}, {2, true}, {1, false}};

std::uint64_t mask(std::size_t width_bytes) {
  return (std::uint64_t{1} << (8 * width_bytes)) - 1;
}

std::uint64_t read(const std::uint8_t* bytes, Form form) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < form.width_bytes; ++i) {
    value = value << 8 | bytes[form.is_big_endian ? i : form.width_bytes - 1 - i];
  }
  return value;
}

// Clocks jitter. If the jitter exceeds a part of the lowest byte, that byte does not belong to the
// field.
bool is_about(std::uint64_t step, std::uint64_t usual) {
  const std::uint64_t difference = step > usual ? step - usual : usual - step;
  return difference <= std::min<std::uint64_t>(usual / 20, 32);
}

}  // namespace

void ByteStatistics::add(const hal::RawReport& report) {
  const std::size_t size = report.size;
  if (count_ > 0) {
    for (std::size_t i = 0; i < std::min<std::size_t>(size, last_.size); ++i) {
      has_changed_[i] = has_changed_[i] || report.bytes[i] != last_.bytes[i];
    }
    const TimeNs interval_ns = report.host_time_ns - last_.host_time_ns;
    intervals_.add(interval_ns);
    const double interval = static_cast<double>(interval_ns);
    const double deviation = interval - mean_ns_;
    mean_ns_ += deviation / static_cast<double>(count_);
    square_sum_ns2_ += deviation * (interval - mean_ns_);
  } else {
    first_ns_ = report.host_time_ns;
    smallest_ = size;
  }
  watch_fields(report);
  smallest_ = std::min(smallest_, size);
  largest_ = std::max(largest_, size);
  last_ = report;
  ++count_;
}

void ByteStatistics::watch_fields(const hal::RawReport& report) {
  for (std::size_t at = 0; at < std::min<std::size_t>(report.size, kWatched); ++at) {
    for (std::size_t i = 0; i < kForms; ++i) {
      const Form form = kFormsTried[i];
      if (at + form.width_bytes > report.size) continue;
      Candidate& candidate = candidates_[at][i];
      const std::uint64_t value = read(report.bytes.data() + at, form);
      const std::uint64_t step = (value - candidate.value) & mask(form.width_bytes);
      candidate.value = value;
      if (count_ == 0) continue;
      ++candidate.steps;
      const bool is_usual = candidate.step > 0 && is_about(step, candidate.step);
      candidate.steady += is_usual ? 1 : 0;
      if (is_usual) {
        ++candidate.lead;
      } else if (candidate.lead > 0) {
        --candidate.lead;
      } else {
        candidate.step = step;
        candidate.lead = 1;
        candidate.steady = step > 0 ? 1 : 0;
        candidate.steps = 1;
      }
    }
  }
}

double ByteStatistics::rate_Hz() const {
  return count_ > 1 && mean_ns_ > 0 ? 1e9 / mean_ns_ : 0;
}

double ByteStatistics::jitter_s() const {
  return count_ > 2 ? 1e-9 * std::sqrt(square_sum_ns2_ / static_cast<double>(count_ - 2)) : 0;
}

std::vector<SteadyField> ByteStatistics::steady_fields() const {
  constexpr std::uint64_t kFewest = 20;
  struct Found {
    SteadyField field;
    std::uint64_t unsteady;
  };
  std::vector<Found> all;
  for (std::size_t i = 0; i < kForms; ++i) {
    const Form form = kFormsTried[i];
    for (std::size_t at = 0; at < kWatched; ++at) {
      const Candidate& candidate = candidates_[at][i];
      const bool is_of_bytes_above = candidate.step % 256 == 0;
      const bool goes_up = candidate.step <= mask(form.width_bytes) / 4;
      const bool is_steady =
          candidate.steps >= kFewest && candidate.steady * 10 >= candidate.steps * 9;
      if (is_of_bytes_above || !goes_up || !is_steady) continue;
      all.push_back({{at, form.width_bytes, form.is_big_endian, candidate.step},
                     candidate.steps - candidate.steady});
    }
  }
  // A field read with the wrong byte order or width is unsteady at carries. Among equally steady
  // ones prefer the widest, then the one that starts at the least significant byte.
  std::sort(all.begin(), all.end(), [](const Found& a, const Found& b) {
    return std::tuple(a.unsteady, b.field.width_bytes, b.field.step) <
           std::tuple(b.unsteady, a.field.width_bytes, a.field.step);
  });
  std::vector<SteadyField> chosen;
  for (const auto& [field, unsteady] : all) {
    const bool is_free =
        std::none_of(chosen.begin(), chosen.end(), [&field = field](const SteadyField& other) {
          return field.offset_bytes < other.offset_bytes + other.width_bytes &&
                 other.offset_bytes < field.offset_bytes + field.width_bytes;
        });
    if (is_free) chosen.push_back(field);
  }
  std::sort(chosen.begin(), chosen.end(), [](const SteadyField& a, const SteadyField& b) {
    return a.offset_bytes < b.offset_bytes;
  });
  return chosen;
}

std::string changed_text(const ByteStatistics& watch) {
  std::string text;
  for (std::size_t begin = 0; begin < watch.largest();) {
    std::size_t end = begin;
    while (end < watch.largest() && watch.has_changed(end)) ++end;
    if (end > begin) {
      text += text.empty() ? "" : ", ";
      text += end - begin == 1 ? fmt::format("{}", begin) : fmt::format("{}-{}", begin, end - 1);
    }
    begin = end + 1;
  }
  return text.empty() ? "none" : text;
}

std::string rate_text(const ByteStatistics& watch) {
  if (watch.count() < 3) return "too few to determine the rate";
  return fmt::format(
      "{:.1f} Hz: every {:.3f} ms, standard deviation {:.3f} ms; p99 {:.3f} ms, at "
      "most {:.3f} ms",
      watch.rate_Hz(), 1e3 / watch.rate_Hz(), 1e3 * watch.jitter_s(),
      1e-6 * static_cast<double>(watch.intervals().quantile_ns(0.99)),
      1e-6 * static_cast<double>(watch.intervals().largest_ns()));
}

std::vector<std::string> steady_text(const ByteStatistics& watch) {
  std::vector<std::string> words;
  for (const SteadyField& field : watch.steady_fields()) {
    std::string text = fmt::format("byte {}", field.offset_bytes);
    if (field.width_bytes > 1) {
      text += fmt::format(" to {}, {}-endian", field.offset_bytes + field.width_bytes - 1,
                          field.is_big_endian ? "big" : "little");
    }
    text += fmt::format(": increases by {} per report; a {}?", field.step,
                        field.step == 1 ? "counter" : "clock");
    words.push_back(std::move(text));
  }
  return words;
}

}  // namespace condyle::host
