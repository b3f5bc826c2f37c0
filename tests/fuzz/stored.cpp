// Files written by palpate: models, runs, their tables. They may have been damaged on disk or edited.
#include "core/sandbox.h"
#include "fuzz/h5_edits.h"
#include "fuzz/input.h"
#include "fuzz/seeds.h"
#include "fuzz/targets.h"
#include "palpate/store/run_file.h"
#include "store/bone_file.h"
#include "store/checkpoint_file.h"
#include "store/force_file.h"
#include "store/mesh_file.h"
#include "store/model_file.h"
#include "store/summary.h"

namespace palpate::fuzz {

namespace {

void read_mesh(const std::string& path) {
  is_read([&] {
    const TetMesh mesh = store::read_mesh(path);
    promise(mesh.nodes.allFinite(), "coordinates are finite");
    promise(mesh.tets.minCoeff() >= 0 && mesh.tets.maxCoeff() < mesh.nodes.cols(),
            "tetrahedra name nodes that are there");
  });
}

void read_model(const std::string& path) {
  is_read([&] {
    const LayeredModel model = store::read_model(path).model;
    promise(model.tets.nodes.allFinite() && model.skin.vertices.allFinite(), "coordinates are finite");
    promise(model.embedding.tet.empty() ||
                static_cast<Eigen::Index>(model.embedding.tet.size()) == model.skin.vertices.cols(),
            "every vertex of the skin is embedded");
  });
  is_read([&] { store::read_regions(path, 2); });
}

void read_run(const std::string& path) {
  is_read([&] {
    const store::RunReader run(path);
    promise(run.times_s().size() == static_cast<std::size_t>(run.steps()), "every step has a time");
    for (const store::RunPart& part : run.parts()) {
      const auto names_points = [&](const auto& cells) {
        return cells.size() == 0 || (cells.minCoeff() >= 0 && cells.maxCoeff() < part.reference.cols());
      };
      promise(names_points(part.tets) && names_points(part.faces), "cells name points that are there");
    }
    constexpr int kLooks = 3;
    for (int step = 0; step < std::min(run.steps(), kLooks); ++step) {
      is_read([&] { run.points(step); });
      is_read([&] { run.displacement(step); });
      is_read([&] { run.velocity(step); });
      is_read([&] { run.stress(step); });
    }
  });
}

void read_checkpoint(const std::string& path) {
  is_read([&] { store::read_checkpoint(path); });
}

}  // namespace

// Raw bytes of the file. HDF5 does not survive all of them, and must run in its child process.
void mesh_file(std::string_view bytes) { read_mesh(InputFile("fuzz.h5", bytes).path()); }
void model_file(std::string_view bytes) { read_model(InputFile("fuzz.h5", bytes).path()); }
void run_file(std::string_view bytes) { read_run(InputFile("fuzz.vtkhdf", bytes).path()); }
void checkpoint_file(std::string_view bytes) { read_checkpoint(InputFile("fuzz.h5", bytes).path()); }

// A valid file with other content: tests palpate's readers only, in this process.
void mesh_content(std::string_view bytes) {
  const NoSandbox here;
  read_mesh(edited("mesh.h5", write_mesh_seed, bytes));
}
void model_content(std::string_view bytes) {
  const NoSandbox here;
  read_model(edited("model.h5", write_model_seed, bytes));
}
void run_content(std::string_view bytes) {
  const NoSandbox here;
  read_run(edited("run.vtkhdf", write_run_seed, bytes));
}
void checkpoint_content(std::string_view bytes) {
  const NoSandbox here;
  read_checkpoint(edited("checkpoint.h5", write_checkpoint_seed, bytes));
}

/// Selects the kind of result by its first letter, which is unique.
void results(std::string_view bytes) {
  const InputFile file("fuzz.txt", bytes);
  if (bytes.starts_with('{')) {
    is_read([&] { store::to_json(store::read_summary(file.path())); });
  } else {
    is_read([&] { store::read_forces(file.path()); });
    is_read([&] { store::read_bones(file.path()); });
  }
}

}  // namespace palpate::fuzz
