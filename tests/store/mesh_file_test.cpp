#include "store/mesh_file.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <fstream>

#include "palpate/core/error.h"
#include "store/sample_run.h"

using namespace palpate;

namespace {

TetMesh two_tets() { return {sample_run::parts()[0].reference, sample_run::parts()[0].tets}; }

TEST(MeshFile, RoundTrip) {
  const sample_run::Folder folder;
  TetMesh mesh = two_tets();
  mesh.nodes(0, 0) = 0.1 + 0.2;
  store::write_mesh(folder / "mesh.h5", mesh);
  const TetMesh again = store::read_mesh(folder / "mesh.h5");
  EXPECT_EQ(again.nodes, mesh.nodes);
  EXPECT_EQ(again.tets, mesh.tets);
}

/// Writes a data set without palpate's library.
void put(const std::string& path, bool first, const char* name, hid_t type, std::vector<hsize_t> shape,
         const void* data) {
  const hid_t file = first ? H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)
                           : H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  const hid_t set = H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
  H5Dclose(set);
  H5Sclose(space);
  H5Fclose(file);
}

std::string refusal(const std::string& path) {
  try {
    store::read_mesh(path);
  } catch (const Error& e) { return std::string(e.what()).substr(path.size()); }
  return "accepted";
}

TEST(MeshFile, OtherHandsAndOtherTypes) {
  const sample_run::Folder folder;
  const std::string path = folder / "mesh.h5";
  const float nodes[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const unsigned short tet[4] = {0, 1, 2, 3};
  put(path, true, "nodes", H5T_NATIVE_FLOAT, {4, 3}, nodes);
  put(path, false, "tets", H5T_NATIVE_USHORT, {1, 4}, tet);
  EXPECT_EQ(store::read_mesh(path).tets, (Tets(4, 1) << 0, 1, 2, 3).finished());
}

TEST(MeshFile, RefusesWrongShapesTypesAndValues) {
  const sample_run::Folder folder;
  const std::string path = folder / "mesh.h5";
  double nodes[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  long long tet[4] = {0, 1, 2, 4};
  EXPECT_EQ(refusal(path), ": no such file");
  std::ofstream(path) << "Gmsh";
  EXPECT_TRUE(refusal(path).starts_with(": is not an HDF5 file that can be read"));
  put(path, true, "points", H5T_NATIVE_DOUBLE, {4, 3}, nodes);
  EXPECT_EQ(refusal(path), ": has no data set \"nodes\"");
  put(path, false, "nodes", H5T_NATIVE_DOUBLE, {4, 3}, nodes);
  put(path, false, "tets", H5T_NATIVE_LLONG, {1, 4}, tet);
  EXPECT_EQ(refusal(path), ": tets[0] refers to node 4, must lie in [0, 4); indices count from 0");
  tet[3] = 1LL << 32;  // not 0 after conversion to 32 bits
  put(path, true, "nodes", H5T_NATIVE_DOUBLE, {4, 3}, nodes);
  put(path, false, "tets", H5T_NATIVE_LLONG, {1, 4}, tet);
  EXPECT_EQ(refusal(path), ": tets[0] refers to node 4294967296, must lie in [0, 4); indices count from 0");
  nodes[7] = std::nan("");
  put(path, true, "nodes", H5T_NATIVE_DOUBLE, {4, 3}, nodes);
  put(path, false, "tets", H5T_NATIVE_LLONG, {1, 4}, tet);
  EXPECT_EQ(refusal(path), ": nodes[2] = (0, nan, 0) is not finite");
  put(path, true, "nodes", H5T_NATIVE_DOUBLE, {3, 4}, nodes);
  put(path, false, "tets", H5T_NATIVE_LLONG, {1, 4}, tet);
  EXPECT_EQ(refusal(path), ": \"nodes\" is 3 x 4, must be n x 3");
  put(path, true, "nodes", H5T_NATIVE_DOUBLE, {12}, nodes);
  put(path, false, "tets", H5T_NATIVE_LLONG, {1, 4}, tet);
  EXPECT_EQ(refusal(path), ": \"nodes\" has 1 dimensions, must have 2");
  put(path, true, "nodes", H5T_NATIVE_LLONG, {1, 4}, tet);
  EXPECT_EQ(refusal(path), ": \"nodes\" must hold floating-point numbers");
  put(path, true, "nodes", H5T_NATIVE_DOUBLE, {0, 3}, nodes);
  put(path, false, "tets", H5T_NATIVE_LLONG, {1, 4}, tet);
  EXPECT_EQ(refusal(path), ": \"nodes\" has 0 rows, must have between 1 and 2147483647");
}

}  // namespace
