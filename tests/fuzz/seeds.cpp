#include "fuzz/seeds.h"

#include <cstdio>

#include "palpate/store/run_file.h"
#include "store/checkpoint_file.h"
#include "store/mesh_file.h"
#include "store/model_file.h"
#include "store/xdmf.h"

namespace palpate::fuzz {
namespace {

TetMesh two_tets() {
  TetMesh mesh;
  mesh.nodes = (Points(3, 5) << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1).finished();
  mesh.tets = (Tets(4, 2) << 0, 1, 1, 2, 2, 4, 3, 3).finished();
  return mesh;
}

store::ModelFile model() {
  store::ModelFile out;
  LayeredModel& m = out.model;
  m.name = "corner";
  m.tets = two_tets();
  m.skin.vertices = m.tets.nodes.leftCols(4);
  m.skin.faces = (Faces(3, 4) << 1, 0, 0, 0, 2, 3, 1, 2, 3, 2, 3, 1).finished();
  m.embedding.tet = {0, 0, 0, 0};
  m.embedding.weights = Eigen::Matrix4d::Identity();
  m.proxies = {{m.skin.vertices.leftCols(3), {0, 1, 2}, 0}, {m.skin.vertices.rightCols(2), {2, 3}, -1}};
  m.skeleton.bones = {{"root", -1, Vec3::Zero(), Vec3::UnitX(), 0.1, 0.2},
                      {"tip", 0, Vec3::UnitX(), Vec3::UnitY(), 0.3, 0.3}};
  m.bone_of_node = {0, -1, 1, -1, -1};
  m.regions = {{"soft", {0}, 0.5, 1.0}, {"hard", {1}, 20.0, 1.1}};
  out.record = {"corner.obj", "0123", "", "0.1.0", {"a hole was closed"}, {{"tetrahedra", 2.0}}};
  return out;
}

}  // namespace

void write_mesh_seed(const std::string& path) { store::write_mesh(path, two_tets()); }

void write_model_seed(const std::string& path) { store::write_model(path, model()); }

void write_bare_model_seed(const std::string& path) {
  store::ModelFile bare = model();
  bare.model.proxies.clear(), bare.model.skeleton.bones.clear(), bare.model.bone_of_node.clear();
  bare.model.regions.clear(), bare.record = {};
  store::write_model(path, bare);
}

void write_run_seed(const std::string& path) {
  const TetMesh mesh = two_tets();
  const store::RunPart body{.name = "ball", .reference = mesh.nodes, .tets = mesh.tets, .faces = Faces(3, 0)};
  {
    store::RunFile file(
        path, {body},
        {.scene_name = "seed", .scene_source = "[scene]\n", .version = "0", .expected_steps = 2});
    for (int step = 0; step < 2; ++step)
      file.append(0.25 * step, mesh.nodes, Points::Zero(3, 5), VecX::Ones(5));
  }
  std::remove(store::xdmf_path(path).c_str());
}

void write_checkpoint_seed(const std::string& path) {
  store::Checkpoint checkpoint{"0.1.0", 0.25, "[scene]\nname = \"one-tet\"\n", {}};
  checkpoint.values["bodies.state.q"] = std::vector<double>{0.0, 0.5, -1.0};
  checkpoint.values["bodies.counts.steps"] = std::vector<std::int64_t>{12};
  checkpoint.values["command.integrator"] = std::string("bdf2");
  store::write_checkpoint(path, checkpoint);
}

}  // namespace palpate::fuzz
