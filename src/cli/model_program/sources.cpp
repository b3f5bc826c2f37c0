#include "sources.h"

#include <filesystem>

#include "palpate/core/error.h"
#include "shapes/shapes.h"
#include "store/content_hash.h"

namespace palpate::cli {

namespace {

std::string_view bytes_of(const Points& points) {
  return {reinterpret_cast<const char*>(points.data()),
          static_cast<std::size_t>(points.size()) * sizeof(double)};
}

model::Input input_of_shape(ModelArguments& arguments) {
  shapes::Shape shape = shapes::make(arguments.source, {.skin_vertices = arguments.skin_vertices});
  model::Input out;
  out.name = shape.name;
  out.source = "shape " + shape.name;
  store::ContentHash hash;
  out.source_hash = hash.add(bytes_of(shape.base.vertices)).add(bytes_of(shape.skin.vertices)).hex();
  out.from = mesh::surface_provenance(out.source);
  out.surface = std::move(shape.base);
  out.skin = std::move(shape.skin);
  out.creases = std::move(shape.creases);
  out.skeleton = std::move(shape.skeleton);
  out.sound = true;
  if (model::TetrahedraOptions& requested = arguments.options.tetrahedra;
      !arguments.counted && requested.element_size_m == 0) {
    // the number is met within 3 %; for the objects of the paper without a number of nodes it is a lower
    // limit
    constexpr double kAtLeast = 1.03;
    requested.tetrahedra = static_cast<int>(shape.tetrahedra * (shape.nodes > 0 ? 1.0 : kAtLeast));
    requested.nodes = shape.nodes;
    requested.at_least = shape.nodes == 0;
  }
  return out;
}

}  // namespace

std::string shape_names() {
  std::string out;
  for (const shapes::ShapeEntry& shape : shapes::shapes()) out += (out.empty() ? "" : ", ") + shape.name;
  return out;
}

model::Input input_of(ModelArguments& arguments) {
  const std::string& source = arguments.source;
  if (std::filesystem::exists(source) || source.find_first_of("./") != std::string::npos) {
    if (arguments.skin_vertices > 0)
      fail(
          "--skin-vertices {}: {} is a file, and its surface is the skin; use the option only with the "
          "shapes ({})",
          arguments.skin_vertices, source, shape_names());
    return model::input_of_file(source);
  }
  return input_of_shape(arguments);
}

}  // namespace palpate::cli
