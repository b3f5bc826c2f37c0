#pragma once
#include <array>
#include <string>

#include "mesh/layered_model.h"
#include "palpate/core/pose.h"
#include "palpate/mesh/generators.h"
#include "proxy/decompose.h"
#include "store/model_file.h"
#include "temporary_folder.h"

/// Layered blocks, and temporary model files for scenes that load a file.
namespace block_model {

using namespace palpate;

/// A block at `pose`, cut into eight proxies, under a skin that is `finer` times finer than its cells.
inline LayeredModel block(const Pose& pose, const Vec3& size, const std::array<int, 3>& cells,
                          int finer = 5) {
  LayeredModel model;
  model.name = "block";
  model.tets = mesh::box(size, cells);
  model.skin = mesh::box_surface(size, {finer * cells[0], finer * cells[1], finer * cells[2]});
  for (Points* points : {&model.tets.nodes, &model.skin.vertices})
    for (auto x : points->colwise()) x = pose * Vec3(x);
  model.embedding = mesh::embed(model.tets, model.skin.vertices);
  model.proxies = proxy::decompose(model, {.count = 8});
  return model;
}

/// A model file that exists for the duration of the test.
struct ModelOnDisk {
  TemporaryFolder folder;
  std::string path;
  ModelOnDisk(const LayeredModel& model, const std::string& name) : path((folder / name).string()) {
    store::write_model(path, {model, {}});
  }
};

}  // namespace block_model
