// SPDX-License-Identifier: Apache-2.0
// Prints which reports the Linux kernel finds in HID report descriptors, and how long they are.
// Runs as root where the modules uhid and hid-generic are loaded and debugfs is mounted.
// usage: kernel_report_sizes FILE...
// Prints for each file one line a report, "NAME DIRECTION ID BITS" (id 0: not numbered; the id not
// counted), and one line "NAME accepted" or "NAME refused REASON".
//
// Source: drivers/hid/hid-debug.c prints each field's offset, but no report's length, and no
// padding. So each descriptor is given to the kernel twice, the second time with one more field in
// each report: that field's offset is the report's length.
#include <fcntl.h>
#include <linux/input.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::array<const char*, 3> kDirections{"INPUT", "OUTPUT", "FEATURE"};
constexpr std::array<const char*, 3> kNames{"input", "output", "feature"};
constexpr std::array<std::uint8_t, 3> kMainItems{0x81, 0x91, 0xb1};

struct Report {
  std::size_t direction = 0;
  unsigned id = 0;
  unsigned fields = 0;
  unsigned last_offset_bits = 0;
};

struct Decoded {
  std::string refusal;
  std::vector<Report> reports;
};

[[noreturn]] void fail(const std::string& what) {
  std::fprintf(stderr, "kernel_report_sizes: %s: %s\n", what.c_str(), std::strerror(errno));
  std::exit(1);
}

// An open file descriptor.
class File {
 public:
  File(const char* path, int flags) : fd_(open(path, flags | O_CLOEXEC)) {
    if (fd_ < 0) fail(path);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { close(fd_); }
  int fd() const { return fd_; }

 private:
  int fd_;
};

// The text of the kernel's messages since the last call. A record is "priority,number,...;text".
std::vector<std::string> new_messages(const File& log) {
  std::vector<std::string> messages;
  std::array<char, 8192> record;
  for (;;) {
    const ssize_t size = read(log.fd(), record.data(), record.size());
    if (size < 0 && errno == EPIPE) continue;  // some were overwritten
    if (size <= 0) return messages;
    const std::string text(record.data(), static_cast<std::size_t>(size));
    const auto begin = text.find(';');
    if (begin == std::string::npos) continue;
    messages.push_back(text.substr(begin + 1, text.find('\n') - begin - 1));
  }
}

// The reports in the text of /sys/kernel/debug/hid/DEVICE/rdesc.
std::vector<Report> reports_in(std::istream& text) {
  std::vector<Report> reports;
  for (std::string line; std::getline(text, line);) {
    line.erase(0, line.find_first_not_of(" \t"));
    for (std::size_t direction = 0; direction < kDirections.size(); ++direction) {
      const std::string name = kDirections[direction];
      if (!line.starts_with(name) || !line.ends_with("[" + name + "]")) continue;
      Report& report = reports.emplace_back();
      report.direction = direction;
      if (line[name.size()] == '(')
        report.id = static_cast<unsigned>(std::stoul(line.substr(name.size() + 1)));
    }
    if (reports.empty()) continue;
    if (line.starts_with("Field(")) {
      ++reports.back().fields;
      reports.back().last_offset_bits = 0;  // an offset of 0 is not printed
    }
    constexpr const char* offset = "Report Offset(";
    if (line.starts_with(offset)) {
      reports.back().last_offset_bits =
          static_cast<unsigned>(std::stoul(line.substr(std::strlen(offset))));
    }
  }
  return reports;
}

// Answers what the kernel asks of the device behind `device`: there is nothing to be had.
void refuse_requests(const File& device) {
  uhid_event event{};
  while (read(device.fd(), &event, sizeof event) > 0) {
    uhid_event reply{};
    if (event.type == UHID_GET_REPORT) {
      reply.type = UHID_GET_REPORT_REPLY;
      reply.u.get_report_reply.id = event.u.get_report.id;
      reply.u.get_report_reply.err = EIO;
    } else if (event.type == UHID_SET_REPORT) {
      reply.type = UHID_SET_REPORT_REPLY;
      reply.u.set_report_reply.id = event.u.set_report.id;
      reply.u.set_report_reply.err = EIO;
    } else {
      continue;
    }
    if (write(device.fd(), &reply, sizeof reply) < 0) fail("/dev/uhid");
  }
}

// Waits until the kernel has taken the device behind `device` (returns "") or refused it: it says
// so.
std::string refusal_of(const File& device, const File& log) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  std::string reason;
  while (std::chrono::steady_clock::now() < deadline) {
    pollfd readable{device.fd(), POLLIN, 0};
    poll(&readable, 1, 1);
    refuse_requests(device);
    for (const std::string& message : new_messages(log)) {
      if (!message.starts_with("hid-generic")) continue;
      if (message.find("hidraw") != std::string::npos) return "";
      if (message.find("probe of") != std::string::npos) return reason.empty() ? message : reason;
      if (reason.empty()) reason = message.substr(message.find(": ") + 2);
    }
  }
  errno = ETIMEDOUT;
  fail("the kernel neither took nor refused a device");
}

// Gives the kernel a device with this report descriptor and reads what became of it.
Decoded decode(const Bytes& descriptor, const File& log) {
  new_messages(log);
  const File device("/dev/uhid", O_RDWR | O_NONBLOCK);
  uhid_event event{};
  event.type = UHID_CREATE2;
  uhid_create2_req& request = event.u.create2;
  std::strcpy(reinterpret_cast<char*>(request.name), "report descriptor");
  request.bus = BUS_USB;
  request.vendor = 0x1209;
  request.product = 0x0001;
  if (descriptor.size() > sizeof request.rd_data) return {"too long", {}};
  request.rd_size = static_cast<std::uint16_t>(descriptor.size());
  std::memcpy(request.rd_data, descriptor.data(), descriptor.size());
  if (write(device.fd(), &event, sizeof event) < 0) return {std::strerror(errno), {}};
  Decoded decoded{refusal_of(device, log), {}};
  if (!decoded.refusal.empty()) return decoded;
  for (const auto& entry : std::filesystem::directory_iterator("/sys/kernel/debug/hid")) {
    std::ifstream text(entry.path() / "rdesc");
    decoded.reports = reports_in(text);
  }
  return decoded;
}

// `descriptor` with a field of one bit more at the end of each of `reports`, in a collection of its
// own.
Bytes with_last_fields(Bytes descriptor, const std::vector<Report>& reports) {
  const auto append = [&](std::initializer_list<std::uint8_t> items) {
    descriptor.insert(descriptor.end(), items);
  };
  append(
      {0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x15, 0x00, 0x25, 0x01, 0x75, 0x01, 0x95, 0x01});
  for (const Report& report : reports) {
    if (report.id != 0) append({0x85, static_cast<std::uint8_t>(report.id)});
    append({0x09, 0x01, kMainItems[report.direction], 0x02});
  }
  append({0xc0});
  return descriptor;
}

void print_reports(const std::string& name, const Bytes& descriptor, const File& log) {
  const Decoded plain = decode(descriptor, log);
  if (!plain.refusal.empty()) {
    std::printf("%s refused %s\n", name.c_str(), plain.refusal.c_str());
    return;
  }
  const Decoded longer = decode(with_last_fields(descriptor, plain.reports), log);
  if (!longer.refusal.empty() || longer.reports.size() != plain.reports.size()) {
    std::printf("%s unmeasured %s\n", name.c_str(), longer.refusal.c_str());
    return;
  }
  for (std::size_t i = 0; i < plain.reports.size(); ++i) {
    const Report& report = longer.reports[i];
    if (report.fields != plain.reports[i].fields + 1) {
      std::printf("%s unmeasured the kernel takes no more fields\n", name.c_str());
      return;
    }
    std::printf("%s %s %u %u\n", name.c_str(), kNames[report.direction], report.id,
                report.last_offset_bits);
  }
  std::printf("%s accepted\n", name.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  const File log("/dev/kmsg", O_RDONLY | O_NONBLOCK);
  lseek(log.fd(), 0, SEEK_END);
  for (int i = 1; i < argc; ++i) {
    std::ifstream file(argv[i], std::ios::binary);
    const Bytes descriptor{std::istreambuf_iterator<char>(file), {}};
    if (!file) fail(argv[i]);
    print_reports(std::filesystem::path(argv[i]).filename(), descriptor, log);
  }
  return 0;
}
