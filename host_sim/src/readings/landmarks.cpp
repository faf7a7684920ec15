// SPDX-License-Identifier: Apache-2.0
#include "readings/landmarks.h"

#include <fmt/format.h>

#include <algorithm>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "hosted/files/toml_reader.h"

namespace condyle::host {
namespace {

constexpr double kMillimetre = 1e-3;
// Limits of what can be a jaw, wide.
constexpr double kLeastCondyleDistance_m = 0.02, kMostCondyleDistance_m = 0.25;
constexpr double kLeastPlaneHeight_m = 0.01, kLeastIncisorDistance_m = 0.01;
constexpr double kMostDistance_m = 0.35;

void refuse(const TomlReader& file, const char* key, const std::string& problem,
            const std::string& mend) {
  throw InputError(file.place("landmarks", key), problem, mend);
}

void check_frame(const Landmarks& landmarks, const TomlReader& file) {
  const auto& p = landmarks.point_m;
  const Eigen::Vector3d across = p[Landmarks::condyle_left] - p[Landmarks::condyle_right];
  if (across.norm() < kLeastCondyleDistance_m || across.norm() > kMostCondyleDistance_m) {
    refuse(file, "condyle_left",
           fmt::format("the condylar points are {:.1f} mm apart", across.norm() / kMillimetre),
           "give both in mm, in the instrument's frame; 80 to 130 mm are usual");
  }
  const Eigen::Vector3d a = p[Landmarks::plane_right] - p[Landmarks::plane_left];
  const Eigen::Vector3d b = p[Landmarks::plane_front] - p[Landmarks::plane_left];
  const double longest = std::max({a.norm(), b.norm(), (b - a).norm()});
  const Eigen::Vector3d normal = a.cross(b);
  if (!(longest > 0) || normal.norm() / longest < kLeastPlaneHeight_m) {
    refuse(file, "plane_left", "the points of the reference plane coincide or lie on a line",
           "give three points that span a plane, at least 10 mm off a line");
  }
  const Eigen::Vector3d up = normal.normalized();
  const Eigen::Vector3d middle = (p[Landmarks::condyle_left] + p[Landmarks::condyle_right]) / 2;
  const Eigen::Vector3d incisor = p[Landmarks::incisor_lower] - middle;
  if (std::abs(across.normalized().dot(up)) > 0.7) {
    refuse(file, "plane_left", "the reference plane is nearly perpendicular to the condylar axis",
           "check that left and right, and the points' names, are not exchanged");
  }
  if (std::abs((p[Landmarks::incisor_lower] - p[Landmarks::plane_left]).dot(up)) < 1e-3) {
    refuse(file, "incisor_lower", "the lower incisor lies in the reference plane",
           "the head is above the plane where the incisor is not; check the points");
  }
  const Eigen::Matrix3d axes = head_frame(landmarks).linear();
  const double forward = incisor.dot(axes.col(0));
  if (incisor.cross(across.normalized()).norm() < kLeastIncisorDistance_m) {
    refuse(file, "incisor_lower", "the lower incisor lies on the condylar axis",
           "check the points: three different ones are needed");
  }
  if (forward < 0) {
    refuse(file, "condyle_left", "the lower incisor lies behind the condyles",
           "left and right are exchanged, or the incisor is not in the same frame");
  }
}

// Where the points of a body were: KEY = "A,B,C" and KEY_mm = [x, y, z, x, ...].
StatedBody read_body(TomlReader& file, const std::string& key) {
  StatedBody body;
  std::string names;
  std::vector<double> values_mm;
  const std::string places = key + "_mm";
  const bool has_names = file.text("landmarks", key, names);
  const bool has_places = file.list("landmarks", places, values_mm, "mm", {-1e4, 1e4});
  if (!has_names && !has_places) return body;
  for (std::size_t begin = 0; begin <= names.size();) {
    const std::size_t comma = std::min(names.find(',', begin), names.size());
    body.names.emplace_back(trim(std::string_view(names).substr(begin, comma - begin)));
    begin = comma + 1;
  }
  if (values_mm.size() != 3 * body.names.size()) {
    refuse(file, (has_places ? places : key).c_str(),
           fmt::format("{} names {} points and {} holds {} numbers", key, body.names.size(), places,
                       values_mm.size()),
           "give x, y, z of each point, as condyle landmarks writes them");
  }
  body.points_m =
      Eigen::Matrix3Xd::Map(values_mm.data(), 3, static_cast<Eigen::Index>(body.names.size())) *
      kMillimetre;
  return body;
}

}  // namespace

Eigen::Isometry3d head_frame(const Landmarks& landmarks) {
  const auto& p = landmarks.point_m;
  const Eigen::Vector3d left = p[Landmarks::plane_left];
  Eigen::Vector3d Z =
      (p[Landmarks::plane_right] - left).cross(p[Landmarks::plane_front] - left).normalized();
  if (Z.dot(p[Landmarks::incisor_lower] - left) > 0) Z = -Z;
  const Eigen::Vector3d across = p[Landmarks::condyle_left] - p[Landmarks::condyle_right];
  const Eigen::Vector3d Y = (across - across.dot(Z) * Z).normalized();
  Eigen::Isometry3d frame;
  frame.linear() << Y.cross(Z), Y, Z;
  frame.translation() = (p[Landmarks::condyle_left] + p[Landmarks::condyle_right]) / 2;
  return frame;
}

// Its errors name `path`.
static Landmarks read_landmarks(TomlReader& file, const std::string& path) {
  Landmarks landmarks;
  std::array<bool, Landmarks::kPoints> is_there{};
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    double values_mm[3] = {};
    is_there[i] = file.numbers("landmarks", Landmarks::kNames[i], values_mm, 3, "mm", {-1e4, 1e4});
    landmarks.point_m[i] = Eigen::Vector3d(values_mm[0], values_mm[1], values_mm[2]) * kMillimetre;
  }
  double sd_mm = 1;
  file.number("landmarks", "sd_mm", sd_mm, "mm", {0, 50});
  double condyle_mm = sd_mm, incisor_mm = sd_mm, plane_mm = sd_mm;
  file.number("landmarks", "condyle_sd_mm", condyle_mm, "mm", {0, 50});
  file.number("landmarks", "incisor_sd_mm", incisor_mm, "mm", {0, 50});
  file.number("landmarks", "plane_sd_mm", plane_mm, "mm", {0, 50});
  const double sds_mm[Landmarks::kPoints] = {condyle_mm, condyle_mm, incisor_mm,
                                             plane_mm,   plane_mm,   plane_mm};
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    landmarks.sd_m[i] = sds_mm[i] * kMillimetre;
  }
  file.text("landmarks", "kind", landmarks.condyle_kind);
  file.text("landmarks", "plane", landmarks.plane);
  landmarks.jaw = read_body(file, "jaw_points");
  landmarks.head = read_body(file, "head_points");
  file.finish();  // first: a mistyped name is then not called missing
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    if (is_there[i]) continue;
    throw InputError(
        path, fmt::format("lacks {} in [landmarks]", Landmarks::kNames[i]),
        fmt::format("add {} = [x, y, z], in mm, in the instrument's frame", Landmarks::kNames[i]));
  }
  check_frame(landmarks, file);
  return landmarks;
}

Landmarks load_landmarks(const std::string& path) {
  TomlReader file(path);
  return read_landmarks(file, path);
}

Landmarks landmarks_from(const std::string& text, const std::string& name) {
  TomlReader file(name, text);
  return read_landmarks(file, name);
}

void check_near(const Landmarks& landmarks, const Eigen::Vector3d& middle_m,
                const std::string& path) {
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    const double distance_m = (landmarks.point_m[i] - middle_m).norm();
    if (distance_m <= kMostDistance_m) continue;
    throw InputError(path,
                     fmt::format("{} is {:.0f} mm from the points that the recording tracks",
                                 Landmarks::kNames[i], distance_m / kMillimetre),
                     "give landmarks in mm, in the frame of this recording's instrument");
  }
}

}  // namespace condyle::host
