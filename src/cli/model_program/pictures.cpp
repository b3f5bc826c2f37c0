#include "pictures.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <numbers>
#include "palpate/core/error.h"

#include "palpate/mesh/boundary.h"
#include "palpate/mesh/generators.h"
#include "palpate/mesh/quality.h"
#include "render/available.h"
#include "render/scene.h"

namespace palpate::cli {

namespace {

constexpr int kWidth = 900, kHeight = 720;

/// Returns the half of the tetrahedra behind the vertical plane through the centre of the bounding box that
/// faces the eye, limited to tetrahedra for which `keep` is true. Faces share no vertices, so that each can
/// be shaded by its element.
template <class Keep>
render::Surface cut_open(const TetMesh& tets, const Keep& keep) {
  const Vec3 middle = (tets.nodes.rowwise().minCoeff() + tets.nodes.rowwise().maxCoeff()) / 2;
  const double azimuth = render::View{}.azimuth_deg * std::numbers::pi / 180;
  const Vec3 to_eye(std::cos(azimuth), std::sin(azimuth), 0.0);
  TetMesh half{tets.nodes, Tets(4, tets.tets.cols())};
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < tets.tets.cols(); ++t) {
    Vec3 at = Vec3::Zero();
    for (int k = 0; k < 4; ++k) at += tets.nodes.col(tets.tets(k, t)) / 4;
    if (keep(t) && to_eye.dot(at - middle) <= 0) half.tets.col(kept++) = tets.tets.col(t);
  }
  half.tets.conservativeResize(4, kept);
  const mesh::Boundary boundary = mesh::boundary(half);
  render::Surface out;
  const Eigen::Index faces = boundary.surface.faces.cols();
  out.points.resize(3, 3 * faces);
  out.faces.resize(3, faces);
  out.values.resize(3 * faces);
  for (Eigen::Index f = 0; f < faces; ++f) {
    const auto angles = mesh::dihedral_angles(half, boundary.tet_of_face[static_cast<std::size_t>(f)]);
    for (int k = 0; k < 3; ++k) {
      out.points.col(3 * f + k) = boundary.surface.vertices.col(boundary.surface.faces(k, f));
      out.faces(k, f) = static_cast<int>(3 * f) + k;
      out.values[3 * f + k] = *std::min_element(angles.begin(), angles.end()) * 180 / std::numbers::pi;
    }
  }
  return out;
}

/// Returns the faces of the convex hull of a few points: the triples with all other points on one side.
Faces hull_faces(const Points& corners) {
  std::vector<std::array<int, 3>> found;
  const int n = static_cast<int>(corners.cols());
  const double size = (corners.rowwise().maxCoeff() - corners.rowwise().minCoeff()).norm();
  for (int a = 0; a < n; ++a)
    for (int b = a + 1; b < n; ++b)
      for (int c = b + 1; c < n; ++c) {
        const Vec3 normal =
            (corners.col(b) - corners.col(a)).cross(corners.col(c) - corners.col(a)).normalized();
        double above = 0, below = 0;
        for (int i = 0; i < n; ++i) {
          const double d = normal.dot(corners.col(i) - corners.col(a));
          above = std::max(above, d);
          below = std::max(below, -d);
        }
        if (above <= 1e-9 * size)
          found.push_back({a, b, c});
        else if (below <= 1e-9 * size)
          found.push_back({a, c, b});
      }
  Faces out(3, static_cast<Eigen::Index>(found.size()));
  for (std::size_t f = 0; f < found.size(); ++f)
    out.col(static_cast<Eigen::Index>(f)) << found[f][0], found[f][1], found[f][2];
  return out;
}

render::Rgb hue(std::size_t i) {
  const double turn = std::numbers::phi * static_cast<double>(i);
  const auto channel = [&](double shift) {
    return static_cast<float>(0.62 + 0.28 * std::cos(2 * std::numbers::pi * (turn + shift)));
  };
  return {channel(0), channel(1.0 / 3), channel(2.0 / 3)};
}

/// Adds one surface per region, and one for the tetrahedra in no region.
void add_regions(const LayeredModel& model, render::Scene& scene) {
  const std::vector<int> owner =
      mesh::region_of_element(model.regions, static_cast<int>(model.tets.tets.cols()));
  for (int r = -1; r < static_cast<int>(model.regions.size()); ++r) {
    render::Surface surface =
        cut_open(model.tets, [&](Eigen::Index t) { return owner[static_cast<std::size_t>(t)] == r; });
    if (surface.faces.cols() == 0) continue;
    surface.values.resize(0);
    surface.crease_deg = 1.0;
    if (r >= 0) surface.colour = hue(static_cast<std::size_t>(r));
    scene.surfaces.push_back(std::move(surface));
  }
}

std::string region_names(const LayeredModel& model) {
  std::string out;
  for (const MaterialRegion& region : model.regions)
    out += (out.empty() ? "; regions: " : ", ") + region.name;
  return out;
}

void add_bones(const Skeleton& skeleton, render::Scene& scene) {
  const TriMesh ball = mesh::sphere(1.0, 4);
  for (const Bone& bone : skeleton.bones)
    for (int i = 0; i <= 6; ++i) {
      const double t = i / 6.0;
      Points points = (bone.head_radius + t * (bone.tail_radius - bone.head_radius)) * ball.vertices;
      points.colwise() += bone.head + t * (bone.tail - bone.head);
      render::Surface surface{"", points, ball.faces};
      surface.colour = {0.93f, 0.90f, 0.80f};
      scene.surfaces.push_back(surface);
    }
}

render::Picture panel(render::Scene scene, const std::string& title, const std::string& subtitle) {
  scene.title = title;
  scene.subtitle = subtitle;
  render::Options options;
  options.width = kWidth;
  options.height = kHeight;
  return render::draw(scene, options);
}

}  // namespace

void check_pictures(const std::string& path) {
  render::check_available();
  if (!path.ends_with(".png")) fail("--picture {}: pictures are PNG files; end the name in .png", path);
}

void draw_model(const LayeredModel& model, const std::string& path) {
  std::vector<render::Picture> panels;
  render::Scene skin, cut, over, hulls;
  skin.surfaces.push_back({"", model.skin.vertices, model.skin.faces});
  panels.push_back(
      panel(skin, model.name + ": the skin", fmt::format("{} vertices", model.skin.vertices.cols())));

  if (model.regions.empty()) {
    cut.surfaces.push_back(cut_open(model.tets, [](Eigen::Index) { return true; }));
    cut.scale.label = "smallest dihedral angle";
    cut.scale.unit = "deg";
  } else {
    add_regions(model, cut);
  }
  panels.push_back(panel(
      cut, "the tetrahedra, cut open",
      fmt::format("{} of {} nodes{}", model.tets.tets.cols(), model.tets.nodes.cols(), region_names(model))));

  const TriMesh boundary = mesh::boundary(model.tets).surface;
  over.surfaces.push_back({"tetrahedra", boundary.vertices, boundary.faces});
  over.surfaces.back().colour = {0.80f, 0.42f, 0.20f};
  over.surfaces.back().crease_deg = 1.0;
  over.surfaces.push_back({"skin", model.skin.vertices, model.skin.faces});
  over.surfaces.back().opacity = 0.45;
  panels.push_back(panel(over, "the skin over the tetrahedra", ""));

  for (std::size_t p = 0; p < model.proxies.size(); ++p) {
    const Faces faces = hull_faces(model.proxies[p].corners);
    if (faces.cols() == 0) continue;
    hulls.surfaces.push_back({"", model.proxies[p].corners, faces});
    hulls.surfaces.back().colour = hue(p);
    hulls.surfaces.back().crease_deg = 1.0;
    if (!model.skeleton.bones.empty()) hulls.surfaces.back().opacity = 0.5;
  }
  add_bones(model.skeleton, hulls);
  if (hulls.surfaces.empty()) hulls = skin;
  panels.push_back(panel(
      hulls, model.proxies.empty() ? "no proxies" : fmt::format("{} convex proxies", model.proxies.size()),
      model.skeleton.bones.empty() ? "" : fmt::format("{} bones", model.skeleton.bones.size())));

  render::Picture sheet(2 * kWidth, 2 * kHeight, render::Options{}.background);
  for (int i = 0; i < 4; ++i)
    for (int y = 0; y < kHeight; ++y)
      std::copy_n(panels[static_cast<std::size_t>(i)].pixel(0, y), 4 * kWidth,
                  sheet.pixel(i % 2 * kWidth, i / 2 * kHeight + y));
  render::save_png(sheet, path);
}

}  // namespace palpate::cli
