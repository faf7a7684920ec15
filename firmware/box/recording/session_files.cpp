// SPDX-License-Identifier: Apache-2.0
#include "box/recording/session_files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <utility>
#include <vector>

#include "box/outlets/http_answer.h"

namespace condyle::box {
namespace {

constexpr std::size_t kMostListed = 200, kBlock = 128 * 1024;

// An open file.
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

void send_json(Document& document, int status, std::string json) {
  document.begin({status, "application/json", "", json.size()});
  document.give(std::move(json));
}

void refuse(Document& document, int status, const std::string& words) {
  send_json(document, status, answer_json({status, words}));
}

void refuse_missing(Document& document) {
  refuse(document, 404, "this session log does not exist");
}

bool is_regular(const std::string& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

void send_file(Document& document, const std::string& folder, const std::string& name) {
  const std::string path = folder + "/" + name;
  const File file(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK));
  struct stat status {};
  if (file.descriptor() < 0 || ::fstat(file.descriptor(), &status) != 0 ||
      !S_ISREG(status.st_mode)) {
    return refuse_missing(document);
  }
  auto left = static_cast<std::uint64_t>(status.st_size);
  document.begin({200, "application/octet-stream", name, left});
  std::string block;
  while (left > 0) {
    block.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, left)));
    const ssize_t size = ::read(file.descriptor(), block.data(), block.size());
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) {
      throw std::runtime_error(path + ": " + (size < 0 ? std::strerror(errno) : "became shorter"));
    }
    block.resize(static_cast<std::size_t>(size));
    left -= static_cast<std::uint64_t>(size);
    if (!document.give(std::exchange(block, {}))) return;
  }
}

}  // namespace

Document::Make SessionFiles::list(const std::string& recorded) const {
  return [folder = folder_, has_reports = static_cast<bool>(make_report_),
          recorded](Document& document) {
    std::vector<std::pair<std::string, std::uint64_t>> found;
    std::error_code error;
    if (!folder.empty()) {
      for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end;
           entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        std::error_code ignored;
        if (!is_session_file(name) ||
            entry->symlink_status(ignored).type() != std::filesystem::file_type::regular) {
          continue;
        }
        const std::uintmax_t size = entry->file_size(ignored);
        if (!ignored) found.emplace_back(name, size);
      }
    }
    if (error) return refuse(document, 500, folder + ": " + error.message());
    // Names begin with their time: the newest come first.
    std::sort(found.begin(), found.end(), std::greater<>());
    const std::size_t more = found.size() - std::min(found.size(), kMostListed);
    found.resize(found.size() - more);
    nlohmann::ordered_json json;
    json["format"] = "condyle-box-sessions-1";
    json["reports"] = has_reports;
    json["more"] = more;
    json["sessions"] = nlohmann::ordered_json::array();
    for (const auto& [name, size] : found) {
      json["sessions"].push_back(
          {{"name", name}, {"bytes", size}, {"recording", name == recorded}});
    }
    send_json(document, 200, json.dump() + "\n");
  };
}

Document::Make SessionFiles::log(const std::string& name, const std::string& recorded) const {
  return [folder = folder_, name, recorded](Document& document) {
    if (name == recorded) {
      return refuse(document, 409, "the session is being recorded; stop it first");
    }
    if (folder.empty()) return refuse_missing(document);
    send_file(document, folder, name);
  };
}

Document::Make SessionFiles::report(const std::string& name, const std::string& recorded) const {
  return [folder = folder_, make = make_report_, name, recorded](Document& document) {
    if (!make) {
      return refuse(document, 404, "the box makes no reports; condyle report " + name + " does");
    }
    if (name == recorded) {
      return refuse(document, 409, "the session is being recorded; stop it first");
    }
    if (folder.empty() || !is_regular(folder + "/" + name)) return refuse_missing(document);
    std::string page;
    try {
      page = make(folder + "/" + name);
    } catch (const std::exception& error) {
      return refuse(document, 422, error.what());
    }
    document.begin({200, "text/html; charset=utf-8",
                    name.substr(0, name.size() - kSessionFileEnd.size()) + ".html", page.size()});
    document.give(std::move(page));
  };
}

}  // namespace condyle::box
