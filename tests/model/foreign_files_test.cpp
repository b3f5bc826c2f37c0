#include "model/foreign_files.h"

extern "C" {
#include <gmshc.h>
}
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "foreign_files_fixture.h"
#include "mesh/tet_checks.h"
#include "model/gmsh_start.h"
#include "surfaces.h"

using namespace foreign_files;
using namespace palpate;
using namespace surfaces;

namespace {

std::string words(const TriMesh& mesh, const std::string& before_point, const std::string& before_face,
                  int first) {
  std::string out;
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v)
    out += fmt::format("{}{:.17g} {:.17g} {:.17g}\n", before_point, mesh.vertices(0, v), mesh.vertices(1, v),
                       mesh.vertices(2, v));
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    out += fmt::format("{}{} {} {}\n", before_face, mesh.faces(0, f) + first, mesh.faces(1, f) + first,
                       mesh.faces(2, f) + first);
  return out;
}

void expect_surface(const std::string& path, const TriMesh& requested, double tolerance) {
  const model::SourceFile got = model::read_source(path);
  const model::RepairedSurface result = model::repair(got.surface, got.from);
  EXPECT_EQ(result.surface.vertices.cols(), requested.vertices.cols()) << path;
  EXPECT_EQ(result.surface.faces.cols(), requested.faces.cols()) << path;
  EXPECT_NEAR(volume(result.surface), volume(requested), tolerance) << path;
}

TEST_F(ForeignFiles, SurfacesAsText) {
  const TriMesh b = box();
  expect_surface(put("a.obj", words(b, "v ", "f ", 1)), b, 1e-12);
  expect_surface(
      put("a.off", fmt::format("OFF\n{} {} 0\n", b.vertices.cols(), b.faces.cols()) + words(b, "", "3 ", 0)),
      b, 1e-12);
  expect_surface(
      put("a.ply", fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double "
                               "y\nproperty double z\nelement face {}\nproperty list uchar int "
                               "vertex_indices\nend_header\n",
                               b.vertices.cols(), b.faces.cols()) +
                       words(b, "", "3 ", 0)),
      b, 1e-12);
  std::string stl = "solid a\n";
  for (Eigen::Index f = 0; f < b.faces.cols(); ++f) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k)
      stl += fmt::format("vertex {:.9g} {:.9g} {:.9g}\n", b.vertices(0, b.faces(k, f)),
                         b.vertices(1, b.faces(k, f)), b.vertices(2, b.faces(k, f)));
    stl += "endloop\nendfacet\n";
  }
  expect_surface(put("a.stl", stl + "endsolid a\n"), b, 1e-6);
}

TEST_F(ForeignFiles, SurfacesAsBytes) {
  const TriMesh b = box();
  std::string stl(80, ' '),
      ply = fmt::format(
          "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float "
          "y\nproperty float z\nelement face {}\nproperty list uchar int "
          "vertex_indices\nend_header\n",
          b.vertices.cols(), b.faces.cols());
  const auto add = [](std::string& to, const auto& value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  add(stl, static_cast<std::uint32_t>(b.faces.cols()));
  for (Eigen::Index f = 0; f < b.faces.cols(); ++f) {
    for (int i = 0; i < 3; ++i) add(stl, 0.0f);
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) add(stl, static_cast<float>(b.vertices(i, b.faces(k, f))));
    add(stl, std::uint16_t{0});
  }
  for (Eigen::Index i = 0; i < b.vertices.size(); ++i) add(ply, static_cast<float>(b.vertices.data()[i]));
  for (Eigen::Index f = 0; f < b.faces.cols(); ++f) {
    add(ply, std::uint8_t{3});
    for (int k = 0; k < 3; ++k) add(ply, static_cast<std::int32_t>(b.faces(k, f)));
  }
  expect_surface(put("b.stl", stl), b, 1e-6);
  expect_surface(put("b.ply", ply), b, 1e-6);
}

/// Gmsh writes the tetrahedra of a box in each of its formats.
TEST_F(ForeignFiles, TetrahedraByGmsh) {
  const TetMesh b = mesh::box(Vec3(2, 1, 1), {4, 2, 2});
  std::string msh = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", b.nodes.cols());
  for (Eigen::Index i = 0; i < b.nodes.cols(); ++i)
    msh += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", i + 1, b.nodes(0, i), b.nodes(1, i), b.nodes(2, i));
  msh += fmt::format("$EndNodes\n$Elements\n{}\n", b.tets.cols());
  for (Eigen::Index t = 0; t < b.tets.cols(); ++t)
    msh += fmt::format("{} 4 2 1 1 {} {} {} {}\n", t + 1, b.tets(0, t) + 1, b.tets(1, t) + 1,
                       b.tets(2, t) + 1, b.tets(3, t) + 1);
  put("a.msh", msh + "$EndElements\n");

  int error = 0;
  model::start_gmsh(gmshInitialize, &error);
  gmshOptionSetNumber("General.Terminal", 0, &error);
  gmshOptionSetNumber("Mesh.SaveAll", 1, &error);
  gmshOpen(at("a.msh").c_str(), &error);
  ASSERT_EQ(error, 0);
  const auto write = [&](const std::string& name, double version, double binary) {
    gmshOptionSetNumber("Mesh.MshFileVersion", version, &error);
    gmshOptionSetNumber("Mesh.Binary", binary, &error);
    gmshWrite(at(name).c_str(), &error);
    EXPECT_EQ(error, 0) << name;
  };
  const std::vector<std::tuple<std::string, double, double>> kinds = {
      {"1.msh", 1.0, 0},   {"22.msh", 2.2, 0}, {"22b.msh", 2.2, 1}, {"41.msh", 4.1, 0},
      {"41b.msh", 4.1, 1}, {"a.vtk", 4.1, 0},  {"b.vtk", 4.1, 1},   {"a.mesh", 4.1, 0}};
  for (const auto& [name, version, binary] : kinds) write(name, version, binary);
  gmshFinalize(&error);

  int read = 0;
  for (const auto& [name, version, binary] : kinds) {
    model::SourceFile got = model::read_source(at(name));
    ASSERT_EQ(got.tets.tets.cols(), b.tets.cols()) << name;
    EXPECT_EQ(got.tets.nodes.cols(), b.nodes.cols()) << name;
    EXPECT_NEAR(mesh::check_tets(got.tets, got.from).volume, 2.0, 1e-12) << name;
    ++read;
  }
  EXPECT_EQ(read, 8);
}

TEST_F(ForeignFiles, RegionsOfEveryFormatOfGmsh) {
  const std::string names = "$PhysicalNames\n2\n3 7 \"hard bone\"\n3 9 \"tissue\"\n$EndPhysicalNames\n";
  put("named.msh", msh_of_two(names, {7, 9}));
  put("plain.msh", msh_of_two("", {0, 0}));
  put("half.msh", msh_of_two(names, {0, 9}));
  int error = 0, read = 0;
  const auto expect = [&](const std::string& from, const std::string& name, double version, double binary,
                          const std::string& requested) {
    model::start_gmsh(gmshInitialize, &error);
    gmshOptionSetNumber("General.Terminal", 0, &error);
    gmshOptionSetNumber("Mesh.SaveAll", from == "plain.msh", &error);  // else version 2.2 omits the groups
    gmshOpen(at(from).c_str(), &error);
    gmshOptionSetNumber("Mesh.MshFileVersion", version, &error);
    gmshOptionSetNumber("Mesh.Binary", binary, &error);
    gmshWrite(at(name).c_str(), &error);
    EXPECT_EQ(error, 0) << name;
    gmshFinalize(&error);
    const model::SourceFile got = model::read_source(at(name));
    ASSERT_EQ(regions_of(got), requested) << name << " of " << from;
    for (const int tet : got.regions[0].tets)
      EXPECT_LT(got.tets.nodes(0, got.tets.tets.col(tet)).mean(), 0.0) << name;
    ++read;
  };
  for (const double binary : {0.0, 1.0})
    for (const double version : {2.2, 4.1}) {
      expect("named.msh", "a.msh", version, binary, "hard bone: 40; tissue: 40; ");
      expect("plain.msh", "b.msh", version, binary, "region-2: 40; region-5: 40; ");
    }
  expect("plain.msh", "a.mesh", 4.1, 0, "region-2: 40; region-5: 40; ");
  EXPECT_EQ(read, 9);
  for (const double binary : {0.0, 1.0}) {
    model::start_gmsh(gmshInitialize, &error);
    gmshOptionSetNumber("General.Terminal", 0, &error);
    gmshOpen(at("half.msh").c_str(), &error);
    gmshOptionSetNumber("Mesh.SaveAll", 1, &error);
    gmshOptionSetNumber("Mesh.MshFileVersion", 4.1, &error);
    gmshOptionSetNumber("Mesh.Binary", binary, &error);
    gmshWrite(at("c.msh").c_str(), &error);
    gmshFinalize(&error);
    EXPECT_EQ(regions_of(model::read_source(at("c.msh"))), "tissue: 40; ");
  }
}

/// Two tetrahedra on one face in Medit's binary form, assembled by hand.
std::string meshb(int version, bool swapped, int last_corner = 5) {
  std::string out;
  const auto add = [&](auto value) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof(value));
    if (swapped) std::reverse(raw.begin(), raw.end());
    out += raw;
  };
  const auto integer = [&](int value) {
    version < 4 ? add(static_cast<std::int32_t>(value)) : add(static_cast<std::int64_t>(value));
  };
  const auto block = [&](int keyword, const auto& content) {
    add(static_cast<std::int32_t>(keyword));
    const std::size_t place = out.size(), width = version < 3 ? 4 : 8;
    out.append(width, '\0');
    content();
    const std::string after = out.substr(place + width);
    out.resize(place);
    const auto next = static_cast<std::int64_t>(place + width + after.size());
    version < 3 ? add(static_cast<std::int32_t>(next)) : add(next);
    out += after;
  };
  add(std::int32_t{1});
  add(static_cast<std::int32_t>(version));
  block(3, [&] { add(std::int32_t{3}); });
  block(77, [&] { add(std::int32_t{123456}); });  // an unknown keyword
  block(4, [&] {
    integer(5);
    for (const Vec3& p : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 1, 1)}) {
      for (const double c : {p.x(), p.y(), p.z()}) version == 1 ? add(static_cast<float>(c)) : add(c);
      integer(0);
    }
  });
  block(6, [&] {
    integer(1);
    for (const int i : {1, 2, 3, 9}) integer(i);
  });
  block(8, [&] {
    integer(2);
    for (const int i : {1, 2, 3, 4, 7, 2, 3, 4, last_corner, 3}) integer(i);
  });
  add(std::int32_t{54});
  version < 3 ? add(std::int32_t{0}) : add(std::int64_t{0});
  return out;
}

TEST_F(ForeignFiles, MeditsBinaryForm) {
  for (const int version : {1, 2, 3, 4})
    for (const bool swapped : {false, true}) {
      model::SourceFile got = model::read_source(put("a.meshb", meshb(version, swapped)));
      ASSERT_EQ(got.tets.tets.cols(), 2) << version;
      EXPECT_EQ(got.tets.nodes.col(4), Vec3(1, 1, 1));
      EXPECT_EQ(got.tets.tets.col(1), Eigen::Vector4i(1, 2, 3, 4));
      EXPECT_EQ(regions_of(got), "region-3: 1; region-7: 1; ");
      EXPECT_NEAR(mesh::check_tets(got.tets, got.from).volume, 0.5, 1e-15);
    }
  const auto message = [&](const std::string& text) {
    const std::string path = put("b.meshb", text);
    return refusal([&] { model::read_source(path); });
  };
  const std::string good = meshb(2, false);
  EXPECT_NE(message("no mesh at all").find("does not start with the number 1"), std::string::npos);
  EXPECT_NE(message(good.substr(0, good.size() - 40)).find("is truncated"), std::string::npos);
  EXPECT_NE(message(meshb(2, false, 6)).find("refers to point 5, but the file has 5 points"),
            std::string::npos)
      << message(meshb(2, false, 6));
  EXPECT_NE(message(meshb(2, false, 0)).find("refers to point -1"), std::string::npos);
  EXPECT_NE(message(std::string("\1\0\0\0\11\0\0\0", 8)).find("has version 9"), std::string::npos);
}

/// TetGen's two files through the program's reader, with attributes, numbered from 0 or from 1.
TEST_F(ForeignFiles, TetGensTwoFiles) {
  for (const int first : {0, 1}) {
    const TetMesh b = mesh::box(Vec3(2, 1, 1), {4, 2, 2});
    std::string nodes = fmt::format("{} 3 0 0\n", b.nodes.cols()),
                elements = fmt::format("{} 4 1\n", b.tets.cols());
    for (Eigen::Index i = 0; i < b.nodes.cols(); ++i)
      nodes +=
          fmt::format("{} {:.17g} {:.17g} {:.17g}\n", i + first, b.nodes(0, i), b.nodes(1, i), b.nodes(2, i));
    for (Eigen::Index t = 0; t < b.tets.cols(); ++t)
      elements += fmt::format("{} {} {} {} {} {}\n", t + first, b.tets(0, t) + first, b.tets(1, t) + first,
                              b.tets(2, t) + first, b.tets(3, t) + first,
                              b.nodes(0, b.tets.col(t)).mean() < 0 ? 2 : 5);
    put("a.node", nodes);
    const model::SourceFile got = model::read_source(put("a.ele", elements + "# end\n"));
    EXPECT_EQ(got.tets.tets, b.tets);
    EXPECT_EQ(got.tets.nodes, b.nodes);
    EXPECT_EQ(regions_of(got), "region-2: 40; region-5: 40; ");
  }
}

TEST_F(ForeignFiles, BrokenFilesAreRefusedWithTheirName) {
  const auto message = [&](const std::string& name, const std::string& text) {
    const std::string path = put(name, text);
    return refusal([&] { model::read_source(path); });
  };
  EXPECT_NE(message("a.xyz", "").find("unknown ending \".xyz\"; these are read: .obj"), std::string::npos);
  EXPECT_NE(message("a.stl", "not at all").find("cannot be read as STL"), std::string::npos);
  EXPECT_NE(message("a.ply", "ply\n").find("cannot be read as PLY"), std::string::npos);
  EXPECT_NE(message("a.off", "OFF\n3 1 0\n0 0 0\n").find("a.off: "), std::string::npos);
  EXPECT_NE(
      message("a.vtu", "<VTKFile type=\"ImageData\"/>")
          .find("is not a VTK file of an unstructured grid or a surface (PolyData), but of \"ImageData\""),
      std::string::npos);
  EXPECT_NE(message("b.vtu", "<VTKFile").find("is not valid XML"), std::string::npos);
  EXPECT_NE(message("a.mesh", "MeshVersionFormatted 1\nDimension 3\nEnd\n"), "accepted");
  EXPECT_NE(message("a.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n0\n$ENDELM\n"), "accepted");
  EXPECT_NE(refusal([&] { model::read_source(at("nothing.obj")); }).find("no such file"), std::string::npos);
}

TEST_F(ForeignFiles, HexahedraAreRefusedByName) {
  const std::string path =
      put("hex.msh",
          "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 "
          "0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n");
  EXPECT_NE(refusal([&] { model::read_source(path); }).find("contains 1 hexahedra, which are not supported"),
            std::string::npos)
      << refusal([&] { model::read_source(path); });
}

TEST_F(ForeignFiles, RealGmsh1) {
  const char* folder = std::getenv("PALPATE_TEST_DATA");
  if (folder == nullptr) GTEST_SKIP() << "PALPATE_TEST_DATA is not set";
  const model::SourceFile got = model::read_source(std::string(folder) + "/liver2.msh");
  EXPECT_EQ(got.format, "Gmsh 1");
  EXPECT_EQ(got.tets.nodes.cols(), 507);
  EXPECT_EQ(got.tets.tets.cols(), 1493);  // as well as 931 triangles: 2,424 elements in all
}

}  // namespace
