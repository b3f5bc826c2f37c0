#include "store/model_file.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <chrono>
#include <thread>

#include "palpate/core/error.h"
#include "store/atomic_file.h"
#include "store/mesh_file.h"
#include "store/sample_run.h"

using namespace palpate;

namespace {

/// A unit corner tetrahedron as its own skin, with every optional part of a model.
store::ModelFile small_model() {
  store::ModelFile out;
  LayeredModel& m = out.model;
  m.name = "corner";
  m.tets.nodes = (Points(3, 5) << 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1).finished();
  m.tets.tets = (Tets(4, 2) << 0, 1, 1, 2, 2, 4, 3, 3).finished();
  m.skin.vertices = m.tets.nodes.leftCols(4);
  m.skin.faces = (Faces(3, 4) << 1, 0, 0, 0, 2, 3, 1, 2, 3, 2, 3, 1).finished();
  m.embedding.tet = {0, 0, 0, 0};
  m.embedding.weights = Eigen::Matrix4d::Identity();
  m.proxies = {{m.skin.vertices.leftCols(3), {0, 1, 2}, 0}, {m.skin.vertices.rightCols(2), {2, 3}, -1}};
  m.skeleton.bones = {{"root", -1, Vec3::Zero(), Vec3::UnitX(), 0.1, 0.2},
                      {"tip of it", 0, Vec3::UnitX(), Vec3::UnitY(), 0.3, 0.1 + 0.2}};
  m.bone_of_node = {0, -1, 1, -1, -1};
  m.regions = {{"soft", {0}, 0.5, 1.0}, {"hard", {1}, 20.0, 1.1}};
  out.record = {"corner.obj",
                "0123",
                "--tetrahedra 2",
                "0.1.0",
                {"one hole of 3 edges was closed", "nothing else"},
                {{"tetrahedra", 2.0}, {"volume_m3", 1.0 / 3.0}}};
  return out;
}

TEST(ModelFile, KeepsTheEdgesOfADividedMeshAndRejectsEdgesThatComeLater) {
  const sample_run::Folder folder;
  store::ModelFile requested = small_model();
  store::write_model(folder / "m.h5", requested);
  EXPECT_TRUE(store::read_edges(folder / "m.h5", 5).empty()) << "not divided";
  requested.edges = {{0, 1}, {3, 2}};  // nodes 3 and 4 are midpoints; node 3 comes before node 4
  store::write_model(folder / "m.h5", requested);
  EXPECT_EQ(store::read_edges(folder / "m.h5", 5), requested.edges);
  EXPECT_EQ(store::read_model(folder / "m.h5").edges, requested.edges);
  requested.edges = {{0, 3}, {1, 2}};
  store::write_model(folder / "m.h5", requested);
  try {
    store::read_edges(folder / "m.h5", 5);
    FAIL() << "node 3 is not the midpoint of an edge of its own";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("\"refined/edges\" refers to 3, must lie in [0, 3)"),
              std::string::npos)
        << e.what();
  }
}

TEST(ModelFile, RoundTripOfEverything) {
  const sample_run::Folder folder;
  const store::ModelFile requested = small_model();
  store::write_model(folder / "m.h5", requested);
  const store::ModelFile got = store::read_model(folder / "m.h5");
  EXPECT_EQ(got.model.name, "corner");
  EXPECT_EQ(got.model.tets.nodes, requested.model.tets.nodes);
  EXPECT_EQ(got.model.tets.tets, requested.model.tets.tets);
  EXPECT_EQ(got.model.skin.vertices, requested.model.skin.vertices);
  EXPECT_EQ(got.model.skin.faces, requested.model.skin.faces);
  EXPECT_EQ(got.model.embedding.tet, requested.model.embedding.tet);
  EXPECT_EQ(got.model.embedding.weights, requested.model.embedding.weights);
  ASSERT_EQ(got.model.proxies.size(), 2u);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(got.model.proxies[p].corners, requested.model.proxies[p].corners);
    EXPECT_EQ(got.model.proxies[p].members, requested.model.proxies[p].members);
    EXPECT_EQ(got.model.proxies[p].bone, requested.model.proxies[p].bone);
  }
  ASSERT_EQ(got.model.skeleton.bones.size(), 2u);
  EXPECT_EQ(got.model.skeleton.bones[1].name, "tip of it");
  EXPECT_EQ(got.model.skeleton.bones[1].parent, 0);
  EXPECT_EQ(got.model.skeleton.bones[1].tail, Vec3::UnitY());
  EXPECT_EQ(got.model.skeleton.bones[1].tail_radius, 0.1 + 0.2);
  EXPECT_EQ(got.model.bone_of_node, requested.model.bone_of_node);
  ASSERT_EQ(got.model.regions.size(), 2u);
  EXPECT_EQ(got.model.regions[1].name, "hard");
  EXPECT_EQ(got.model.regions[1].tets, std::vector<int>{1});
  EXPECT_EQ(got.model.regions[1].youngs_modulus_factor, 20.0);
  EXPECT_EQ(got.record.source, "corner.obj");
  EXPECT_EQ(got.record.options, "--tetrahedra 2");
  EXPECT_EQ(got.record.notes, requested.record.notes);
  EXPECT_EQ(got.record.figures, requested.record.figures);
}

TEST(ModelFile, RegionsAreReadAlone) {
  const sample_run::Folder folder;
  store::ModelFile requested = small_model();
  store::write_model(folder / "m.h5", requested);
  const std::vector<MaterialRegion> got = store::read_regions(folder / "m.h5", 2);
  ASSERT_EQ(got.size(), 2u);
  EXPECT_EQ(got[0].name, "soft");
  EXPECT_EQ(got[1].density_factor, 1.1);
  store::write_mesh(folder / "mesh.h5", requested.model.tets);
  EXPECT_TRUE(store::read_regions(folder / "mesh.h5", 2).empty());
  const auto refusal = [&](std::vector<MaterialRegion> regions) -> std::string {
    requested.model.regions = std::move(regions);
    store::write_model(folder / "bad.h5", requested);
    try {
      store::read_regions(folder / "bad.h5", 2);
      return "accepted";
    } catch (const Error& e) { return e.what(); }
  };
  EXPECT_EQ(refusal({{"a", {0, 1}}, {"b", {1}}}), "accepted");  // Gmsh's groups may overlap
  EXPECT_NE(refusal({{"a", {1, 1}}}).find("the tetrahedra of region \"a\" must increase strictly"),
            std::string::npos);
  EXPECT_NE(refusal({{"a", {0}}, {"a", {1}}}).find("\"a\" is the name of two regions"), std::string::npos);
  EXPECT_NE(refusal({{"a", {1, 0}}}).find("the tetrahedra of region \"a\" must increase"), std::string::npos);
  EXPECT_NE(refusal({{"a", {0, 2}}}).find("refers to 2, must lie in [0, 2)"), std::string::npos);
  EXPECT_NE(refusal({{"a", {0}, -1.0}}).find("has factors -1 and 1, must be positive"), std::string::npos);
}

TEST(ModelFile, TetrahedraAreReadByTheMeshReader) {
  const sample_run::Folder folder;
  const store::ModelFile requested = small_model();
  store::write_model(folder / "m.h5", requested);
  EXPECT_EQ(store::read_mesh(folder / "m.h5").tets, requested.model.tets.tets);
  EXPECT_TRUE(store::is_model(folder / "m.h5"));
  store::write_mesh(folder / "mesh.h5", requested.model.tets);
  EXPECT_FALSE(store::is_model(folder / "mesh.h5"));
}

TEST(ModelFile, WhatIsEmptyIsNotThere) {
  const sample_run::Folder folder;
  store::ModelFile bare;
  bare.model.tets = small_model().model.tets;
  store::write_model(folder / "bare.h5", bare);
  const store::ModelFile got = store::read_model(folder / "bare.h5");
  EXPECT_EQ(got.model.skin.vertices.cols(), 0);
  EXPECT_TRUE(got.model.proxies.empty());
  EXPECT_TRUE(got.model.bone_of_node.empty());
  EXPECT_TRUE(got.record.notes.empty());
}

TEST(ModelFile, SameModelSameBytesAtAnotherTime) {
  const sample_run::Folder folder;
  store::write_model(folder / "one.h5", small_model());
  // HDF5 stores times in whole seconds, where it stores them
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  store::write_model(folder / "two.h5", small_model());
  EXPECT_EQ(store::read_file(folder / "one.h5"), store::read_file(folder / "two.h5"));
}

/// Returns the message for a model that was changed before it was written; `accepted` if there is none.
template <class Change>
std::string refusal(Change change) {
  const sample_run::Folder folder;
  const std::string path = folder / "m.h5";
  store::ModelFile file = small_model();
  change(file.model);
  store::write_model(path, file);
  try {
    store::read_model(path);
  } catch (const Error& e) { return std::string(e.what()).substr(path.size()); }
  return "accepted";
}

TEST(ModelFile, RefusesPartsThatDoNotFit) {
  EXPECT_EQ(refusal([](LayeredModel&) {}), "accepted");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.tets.tets(0, 1) = 9; }),
            ": tets[1] refers to node 9, must lie in [0, 5); indices count from 0");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.skin.faces(0, 0) = 4; }),
            ": \"skin/faces\" refers to 4, must lie in [0, 4); indices count from 0");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.skin.vertices(1, 2) = NAN; }),
            ": \"skin/vertices\": row 2 is not finite");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.embedding.tet.pop_back(); }),
            ": \"embedding/tet\" has 3 rows, must have 4");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.embedding.tet[1] = 2; }),
            ": \"embedding/tet\" refers to 2, must lie in [0, 2); indices count from 0");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.embedding.weights(0, 3) = 0.5; }),
            ": \"embedding/weights\": row 3 sums to 1.5, must sum to 1");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.proxies[1].members = {2}; }),
            ": skin vertex 3 belongs to no proxy");
  EXPECT_EQ(refusal([](LayeredModel& m) {
              m.proxies[1].members = {3, 2};
            }),
            ": the members of proxy 1 must increase strictly");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.proxies[0].bone = 2; }),
            ": \"proxies/bone\" refers to 2, must lie in [-1, 2); indices count from 0");
  EXPECT_EQ(
      refusal([](LayeredModel& m) { m.proxies[0].corners.resize(3, 33), m.proxies[0].corners.setZero(); }),
      ": proxy 0 has 33 corners, must have between 1 and 32");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.skeleton.bones[0].parent = 1; }),
            ": \"skeleton/parent\" refers to 1, must lie in [-1, 0); indices count from 0");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.skeleton.bones[1].head_radius = 0; }),
            ": bone \"tip of it\" has radii 0 and 0.30000000000000004 m, must be positive");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.bone_of_node[0] = 2; }),
            ": \"skeleton/bone_of_node\" refers to 2, must lie in [-1, 2); indices count from 0");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.regions[1].tets = {2}; }),
            ": \"regions/tets\" refers to 2, must lie in [0, 2); indices count from 0");
  EXPECT_EQ(refusal([](LayeredModel& m) { m.regions[1].density_factor = -1; }),
            ": region \"hard\" has factors 20 and -1, must be positive");
}

TEST(ModelFile, RefusesOtherFiles) {
  const sample_run::Folder folder;
  store::write_mesh(folder / "mesh.h5", small_model().model.tets);
  EXPECT_THROW(store::read_model(folder / "mesh.h5"), Error);
  store::write_atomically(folder / "text.h5", "not HDF5");
  EXPECT_THROW(store::read_model(folder / "text.h5"), Error);
  EXPECT_THROW(store::read_model(folder / "nothing.h5"), Error);
  EXPECT_THROW(store::write_model(folder / "no/such/folder.h5", small_model()), Error);
}

TEST(ModelFile, OffsetsThatDoNotRiseAreRefused) {
  const sample_run::Folder folder;
  const std::string path = folder / "m.h5";
  store::write_model(path, small_model());
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT),
              set = H5Dopen2(file, "proxies/corner_offsets", H5P_DEFAULT);
  const int wrong[3] = {0, 9, 5};
  H5Dwrite(set, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, wrong);
  H5Dclose(set);
  H5Fclose(file);
  try {
    store::read_model(path);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).substr(path.size()),
              ": \"proxies/corner_offsets\" must increase from 0 to 5");
  }
}

}  // namespace
