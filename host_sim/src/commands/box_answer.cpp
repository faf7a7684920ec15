// SPDX-License-Identifier: Apache-2.0
#include "commands/box_answer.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

nlohmann::json parse(const std::string& box, int status, const std::string& text) {
  nlohmann::json json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) refuse_stranger(box, fmt::format("HTTP status {} without JSON", status));
  return json;
}

// The text of a required key of an answer.
std::string text_of(const std::string& box, int status, const nlohmann::json& json,
                    const char* key) {
  const auto found = json.find(key);
  if (found == json.end() || !found->is_string()) {
    refuse_stranger(box, fmt::format("HTTP status {} without \"{}\"", status, key));
  }
  return found->get<std::string>();
}

}  // namespace

void refuse_stranger(const std::string& box, const std::string& why) {
  throw InputError(box, "the server at this address is not condyle-box: " + why,
                   "give the address of the box with --box");
}

std::string read_command_answer(const std::string& box, int status, const std::string& text) {
  const nlohmann::json json = parse(box, status, text);
  if (status != 200) throw InputError(box, text_of(box, status, json, "problem"), "");
  return clean_line(text_of(box, status, json, "done"));
}

std::string read_status_answer(const std::string& box, int status, const std::string& text) {
  const nlohmann::json json = parse(box, status, text);
  if (status != 200) throw InputError(box, text_of(box, status, json, "problem"), "");
  if (text_of(box, status, json, "format") != "condyle-box-status-1") {
    refuse_stranger(box, "its status has another format");
  }
  return text;
}

}  // namespace condyle::host
