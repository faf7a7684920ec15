// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "hosted/files/nearest_word.h"
#include "recordings/named_points.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

using Eigen::Index;

std::vector<Index> numbers_of(const std::vector<std::string>& markers,
                              const std::vector<std::string>& names, const std::string& path) {
  std::vector<Index> numbers;
  if (names.empty() && !markers.empty()) {
    throw InputError(path, "has no markers with names", "leave out --marker");
  }
  for (const std::string& marker : markers) {
    const auto found = std::find(names.begin(), names.end(), marker);
    if (found == names.end()) {
      const std::string nearest = nearest_word(marker, names);
      throw InputError(path, fmt::format("has no marker {}", marker),
                       nearest.empty() ? "its markers are " + list_of_points(names)
                                       : fmt::format("did you mean {}? It has {} markers", nearest,
                                                     names.size()));
    }
    if (std::find(found + 1, names.end(), marker) != names.end()) {
      throw InputError(path, fmt::format("has several markers {}", marker),
                       "give them different names, and export the recording again");
    }
    if (std::find(numbers.begin(), numbers.end(), found - names.begin()) != numbers.end()) {
      throw InputError("--marker", fmt::format("names {} twice", marker), "name each marker once");
    }
    numbers.push_back(found - names.begin());
  }
  return numbers;
}

class ChosenMarkers final : public NamedPointsRecording {
 public:
  ChosenMarkers(std::unique_ptr<NamedPointsRecording> recording, std::vector<Index> numbers)
      : recording_(std::move(recording)), numbers_(std::move(numbers)) {
    for (const Index number : numbers_) {
      names_.push_back(recording_->names()[static_cast<std::size_t>(number)]);
    }
    kind_ = names_.size() == 1 ? SampleKind::one_point : SampleKind::three_points;
    copy_info();
  }

  bool next(Sample& sample) override {
    if (!recording_->next(sample)) {
      copy_info();  // some notes are known at the end only
      return false;
    }
    points_m_ = recording_->points_m()(Eigen::all, numbers_);
    sample.kind = kind_;
    const Index own = names_.size() == 1 ? 1 : 3;
    Eigen::Map<Eigen::Matrix3Xd>(sample.coordinates, 3, own) = points_m_.leftCols(own);
    sample.position_valid = points_m_.leftCols(own).allFinite();
    return true;
  }

  const std::vector<std::string>& names() const override { return names_; }
  const Eigen::Matrix3Xd& points_m() const override { return points_m_; }
  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return recording_->place(); }
  double progress() const override { return recording_->progress(); }

 private:
  void copy_info() {
    info_ = recording_->info();
    info_.kind = kind_;
    // Of one or three: whoever takes more by name says which.
    const bool are_numbered = names_ == std::vector<std::string>{"p1", "p2", "p3"};
    if (names_.size() == 1 && names_[0] != "p1") info_.notes.push_back("the point is " + names_[0]);
    if (names_.size() == 3 && !are_numbered) {
      info_.notes.push_back(fmt::format("point 1 is {}, point 2 is {}, point 3 is {}", names_[0],
                                        names_[1], names_[2]));
    }
  }

  std::unique_ptr<NamedPointsRecording> recording_;
  std::vector<Index> numbers_;
  std::vector<std::string> names_;
  SampleKind kind_ = SampleKind::one_point;
  RecordingInfo info_;
  Eigen::Matrix3Xd points_m_;
};

}  // namespace

std::unique_ptr<NamedPointsRecording> with_markers(std::unique_ptr<NamedPointsRecording> recording,
                                                   const std::vector<std::string>& markers,
                                                   PointCount count, const std::string& path) {
  const std::vector<std::string>& names = recording->names();
  std::vector<Index> numbers = numbers_of(markers, names, path);
  if (markers.empty()) {
    for (std::size_t i = 0; i < names.size(); ++i) numbers.push_back(static_cast<Index>(i));
  }
  const std::size_t points = numbers.size();
  if (points == 0) {
    throw InputError(path, "has no markers", "condyle info shows what it holds");
  }
  if (points == 2 || (points > 3 && count == PointCount::one_or_three)) {
    throw InputError(
        markers.empty() ? path : "--marker",
        markers.empty() ? fmt::format("has {} markers: {}", points, list_of_points(names))
                        : fmt::format("names {} markers", points),
        "choose one with --marker NAME, or three of one rigid body with three --marker NAME");
  }
  return std::make_unique<ChosenMarkers>(std::move(recording), std::move(numbers));
}

}  // namespace condyle::host
