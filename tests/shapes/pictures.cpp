#include <cmath>
#include <cstdio>
#include <ctime>
#include <exception>
#include <filesystem>
#include <numbers>

#include "palpate/mesh/boundary.h"
#include "render/scene.h"
#include "shapes/shapes.h"

// Draws the shapes of docs/models.md: shapes_pictures FOLDER [NAME...]
using namespace palpate;

namespace {

/// A surface rotated about the vertical and shifted.
render::Surface placed(const TriMesh& mesh, double turn_deg, const Vec3& shift, render::Rgb colour) {
  render::Surface surface;
  surface.points = Eigen::AngleAxisd(turn_deg * std::numbers::pi / 180.0, Vec3::UnitZ()).toRotationMatrix() *
                   mesh.vertices;
  surface.points.colwise() += shift;
  surface.faces = mesh.faces;
  surface.colour = colour;
  return surface;
}

struct Look {
  std::string name;
  render::Rgb colour;
  double apart;                ///< between two views [m]; 0: one view
  double turn_deg, other_deg;  ///< rotation of either view
  double elevation_deg;
  int width, height;
  double crease_deg;
};

const Look kLooks[] = {
    {"head", {0.86f, 0.68f, 0.58f}, 0.26, 0.0, 52.0, 6.0, 760, 490, 50.0},
    {"human", {0.80f, 0.64f, 0.55f}, 1.1, 0.0, 140.0, 6.0, 800, 720, 60.0},
    {"gear", {0.66f, 0.69f, 0.73f}, 0.0, 0.0, 0.0, 38.0, 800, 560, 30.0},
    {"pumpkin", {0.90f, 0.48f, 0.12f}, 0.0, 0.0, 0.0, 24.0, 780, 540, 50.0},
};

void draw(const Look& look, const std::filesystem::path& folder, bool of_base) {
  const std::clock_t start = std::clock();
  const shapes::Shape shape = shapes::make(look.name);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const TriMesh& mesh = of_base ? shape.base : shape.skin;
  render::Scene scene;
  scene.surfaces.push_back(placed(mesh, look.turn_deg, Vec3(-0.5 * look.apart, 0, 0), look.colour));
  if (look.apart > 0.0)
    scene.surfaces.push_back(placed(mesh, look.other_deg, Vec3(0.5 * look.apart, 0, 0), look.colour));
  for (render::Surface& surface : scene.surfaces) surface.crease_deg = look.crease_deg;
  scene.ground = render::Ground{mesh.vertices.row(2).minCoeff()};
  render::Options options;
  options.width = look.width, options.height = look.height;
  options.annotated = false;
  options.view.azimuth_deg = look.apart > 0.0 ? -90.0 : -60.0;
  options.view.elevation_deg = look.elevation_deg;
  const std::filesystem::path file = folder / (look.name + (of_base ? "-base.png" : ".png"));
  render::save_png(render::draw(scene, options), file);
  std::printf(
      "%s: Euler %d, %d vertices, %d faces, base %d vertices, %.4g m^3, %.2f s of CPU, %s (%.0f kB)\n",
      look.name.c_str(), static_cast<int>(shape.skin.vertices.cols() - shape.skin.faces.cols() / 2),
      static_cast<int>(shape.skin.vertices.cols()), static_cast<int>(shape.skin.faces.cols()),
      static_cast<int>(shape.base.vertices.cols()), mesh::enclosed_volume(shape.skin), seconds, file.c_str(),
      static_cast<double>(std::filesystem::file_size(file)) / 1000.0);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2) return std::fprintf(stderr, "shapes_pictures FOLDER [NAME...] [--base]\n"), 2;
    bool of_base = false;
    for (int i = 2; i < argc; ++i) of_base = of_base || std::string(argv[i]) == "--base";
    for (const Look& look : kLooks) {
      bool requested = argc == 2 || (argc == 3 && of_base);
      for (int i = 2; i < argc; ++i) requested = requested || look.name == argv[i];
      if (requested) draw(look, argv[1], of_base);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
