// SPDX-License-Identifier: Apache-2.0
// Compares the report sizes that parse_report_descriptor finds with those of the Linux kernel.
// usage: compare_report_sizes SIZES FOLDER
//   SIZES   what kernel_report_sizes printed
//   FOLDER  with the report descriptors
// Exits with 1 where a size differs, a report is missing on one side, or fewer than 100 descriptors
// could be compared. Descriptors that only one side takes are listed, not counted.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "condyle/hal/hid/report_descriptor.h"

namespace {

using condyle::hal::DescriptorResult;
/// Size in bits, id not counted, by direction and id (0: not numbered).
using Sizes = std::map<std::pair<std::string, unsigned>, std::uint32_t>;

struct KernelView {
  bool accepted = false;
  std::string reason;  ///< why not
  Sizes sizes;
};

std::map<std::string, KernelView> read_kernel_views(std::istream& lines) {
  std::map<std::string, KernelView> views;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name, what;
    words >> name >> what;
    KernelView& view = views[name];
    unsigned id = 0;
    std::uint32_t bits = 0;
    if (what == "accepted") {
      view.accepted = true;
    } else if (words >> id >> bits) {
      view.sizes[{what, id}] = bits;
    } else {
      view.reason = line.substr(name.size());
    }
  }
  return views;
}

Sizes own_sizes(const condyle::hal::ReportDescriptor& descriptor) {
  Sizes sizes;
  for (const auto& report : descriptor.reports) {
    sizes[{direction_name(report.direction), report.id.value_or(0)}] =
        report.size_bits - (report.id ? 8U : 0U);
  }
  return sizes;
}

std::string text_of(const Sizes& sizes) {
  std::ostringstream text;
  for (const auto& [report, bits] : sizes) {
    text << "  " << report.first << ' ' << report.second << ": " << bits;
  }
  return text.str();
}

}  // namespace

int main(int argc, char** argv) {
  std::ifstream file(argc == 3 ? argv[1] : "");
  if (!file) {
    std::cerr << "usage: compare_report_sizes SIZES FOLDER\n";
    return 2;
  }
  int compared = 0, reports = 0, different = 0, refused = 0, one_sided = 0;
  for (const auto& [name, kernel] : read_kernel_views(file)) {
    const auto path = std::filesystem::path(argv[2]) / name;
    std::ifstream stream(path, std::ios::binary);
    const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    if (!stream) {
      std::cerr << path << " cannot be read\n";
      return 2;
    }
    const DescriptorResult own = condyle::hal::parse_report_descriptor(bytes);
    if (!own.descriptor || !kernel.accepted) {
      ++(own.descriptor || kernel.accepted ? one_sided : refused);
      std::cout << name << ": kernel:" << (kernel.accepted ? " accepted" : kernel.reason)
                << "; condyle: " << (own.descriptor ? "accepted" : own.error.reason) << '\n';
      continue;
    }
    ++compared;
    const Sizes sizes = own_sizes(*own.descriptor);
    reports += static_cast<int>(sizes.size());
    if (sizes == kernel.sizes) continue;
    ++different;
    std::cout << name << " DIFFERS\n  kernel: " << text_of(kernel.sizes)
              << "\n  condyle:" << text_of(sizes) << '\n';
  }
  std::cout << compared << " descriptors compared, " << reports << " reports; " << different
            << " descriptors differ; " << one_sided << " taken by one side alone, " << refused
            << " by neither\n";
  return different == 0 && compared >= 100 ? 0 : 1;
}
