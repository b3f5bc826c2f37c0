#include "store/surface_files.h"

#include <bit>
#include <iterator>

#include "palpate/core/error.h"

namespace palpate::store {
namespace {

static_assert(std::endian::native == std::endian::little, "the PLY header says so");

/// Replaces control characters: a line break would end the comment.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

/// Replaces blanks: in many readers an OBJ name ends at the first space.
std::string one_word(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) <= 0x20) c = '_';
  return text;
}

void check(const SurfaceState& s) {
  const Eigen::Index n = s.points.cols();
  PALPATE_CHECK(
      s.displacement.size() == n && s.stress.size() == n && s.colours.size() == static_cast<std::size_t>(n),
      "surface \"{}\": {} points, {} displacements, {} stresses, {} colours", s.name, n,
      s.displacement.size(), s.stress.size(), s.colours.size());
  PALPATE_CHECK(s.faces.size() == 0 || (s.faces.minCoeff() >= 0 && s.faces.maxCoeff() < n),
                "surface \"{}\": faces of {} points", s.name, n);
}

void append_bytes(std::string& out, auto value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

std::string obj_of(const std::vector<SurfaceState>& surfaces, const std::string& title) {
  std::string out = fmt::format("# {}\n# metres\n", one_line(title));
  const auto end = std::back_inserter(out);
  Eigen::Index first = 1;  // OBJ indices count from one, over all objects.
  for (const SurfaceState& s : surfaces) {
    check(s);
    fmt::format_to(end, "o {}\n", one_word(s.name));
    for (const auto& p : s.points.colwise()) fmt::format_to(end, "v {} {} {}\n", p[0], p[1], p[2]);
    for (const auto& f : s.faces.colwise())
      fmt::format_to(end, "f {} {} {}\n", first + f[0], first + f[1], first + f[2]);
    first += s.points.cols();
  }
  return out;
}

std::string ply_of(const std::vector<SurfaceState>& surfaces, const std::string& title) {
  Eigen::Index points = 0, faces = 0;
  for (const SurfaceState& s : surfaces) {
    check(s);
    points += s.points.cols();
    faces += s.faces.cols();
  }
  std::string out = fmt::format("ply\nformat binary_little_endian 1.0\ncomment {}\n", one_line(title));
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    out += fmt::format("comment object {} is {}\n", i, one_line(surfaces[i].name));
  out += fmt::format("element vertex {}\n", points);
  for (const char* property : {"float x", "float y", "float z", "uchar red", "uchar green", "uchar blue",
                               "float displacement", "float stress", "int object"})
    out += fmt::format("property {}\n", property);
  out += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", faces);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    const SurfaceState& s = surfaces[i];
    for (Eigen::Index p = 0; p < s.points.cols(); ++p) {
      for (int axis = 0; axis < 3; ++axis) append_bytes(out, static_cast<float>(s.points(axis, p)));
      for (const std::uint8_t channel : s.colours[static_cast<std::size_t>(p)]) append_bytes(out, channel);
      append_bytes(out, static_cast<float>(s.displacement[p]));
      append_bytes(out, static_cast<float>(s.stress[p]));
      append_bytes(out, static_cast<std::int32_t>(i));
    }
  }
  Eigen::Index first = 0;
  for (const SurfaceState& s : surfaces) {
    for (const auto& f : s.faces.colwise()) {
      append_bytes(out, std::uint8_t{3});
      for (const int corner : f) append_bytes(out, static_cast<std::int32_t>(first + corner));
    }
    first += s.points.cols();
  }
  return out;
}

}  // namespace palpate::store
