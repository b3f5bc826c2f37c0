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

#include "mesh/tet_checks.h"
#include "model/gmsh_start.h"
#include "surfaces.h"
#include "temporary_folder.h"

using namespace palpate;
using namespace surfaces;

namespace {

class ForeignFiles : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string put(const std::string& name, const std::string& text) const {
    std::ofstream(at(name), std::ios::binary) << text;
    return at(name);
  }
  TemporaryFolder folder_;
};

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

/// Returns "NAME: COUNT; " for each region.
std::string regions_of(const model::SourceFile& file) {
  std::string out;
  for (const MaterialRegion& region : file.regions)
    out += fmt::format("{}: {}; ", region.name, region.tets.size());
  return out;
}

/// A box of 80 tetrahedra in two volumes of 40, with those of volume 2 first in the file.
std::string msh_of_two(const std::string& names, const std::array<int, 2>& physical) {
  const TetMesh b = mesh::box(Vec3(2, 1, 1), {4, 2, 2});
  std::string msh =
      fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{}$Nodes\n{}\n", names, b.nodes.cols());
  for (Eigen::Index i = 0; i < b.nodes.cols(); ++i)
    msh += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", i + 1, b.nodes(0, i), b.nodes(1, i), b.nodes(2, i));
  msh += fmt::format("$EndNodes\n$Elements\n{}\n", b.tets.cols());
  for (Eigen::Index t = 0; t < b.tets.cols(); ++t) {
    const int volume = b.nodes(0, b.tets.col(t)).mean() < 0 ? 2 : 5;
    msh += fmt::format("{} 4 2 {} {} {} {} {} {}\n", t + 1, physical[volume == 5], volume, b.tets(0, t) + 1,
                       b.tets(1, t) + 1, b.tets(2, t) + 1, b.tets(3, t) + 1);
  }
  return msh + "$EndElements\n";
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

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

template <class T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// The four arrays of a VTU file, each in one of the encodings that VTK writes.
struct Vtu {
  std::string attributes, appended, appended_encoding;
  std::function<std::string(const std::string& type, const std::string& name, int components,
                            const std::string& bytes, const std::string& text)>
      array;
};

std::string vtu_text(const TetMesh& mesh, Vtu way) {
  std::vector<double> points(mesh.nodes.data(), mesh.nodes.data() + mesh.nodes.size());
  std::vector<std::int64_t> connectivity(mesh.tets.data(), mesh.tets.data() + mesh.tets.size()), offsets;
  std::vector<std::uint8_t> types(static_cast<std::size_t>(mesh.tets.cols()), 10);
  for (Eigen::Index t = 1; t <= mesh.tets.cols(); ++t) offsets.push_back(4 * t);
  const std::string body =
      fmt::format("<Points>{}</Points><Cells>{}{}{}</Cells>",
                  way.array("Float64", "Points", 3, raw(points), fmt::format("{}", fmt::join(points, " "))),
                  way.array("Int64", "connectivity", 1, raw(connectivity),
                            fmt::format("{}", fmt::join(connectivity, " "))),
                  way.array("Int64", "offsets", 1, raw(offsets), fmt::format("{}", fmt::join(offsets, "\n"))),
                  way.array("UInt8", "types", 1, raw(types), fmt::format("{}", fmt::join(types, " "))));
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\" {}><UnstructuredGrid><Piece NumberOfPoints=\"{}\" "
      "NumberOfCells=\"{}\">{}</Piece></UnstructuredGrid>",
      way.attributes, mesh.nodes.cols(), mesh.tets.cols(), body);
}

std::string header(const std::string& type, const std::string& name, int components,
                   const std::string& format) {
  return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" {}>", type, name,
                     components, format);
}

TEST_F(ForeignFiles, VtuInEveryEncoding) {
  const TetMesh b = mesh::box(Vec3(2, 1, 1), {4, 2, 2});
  const std::string end = "</VTKFile>\n";
  const auto expect = [&](const std::string& name, const std::string& text) {
    model::SourceFile got = model::read_source(put(name, text));
    EXPECT_EQ(got.tets.tets, b.tets) << name;
    EXPECT_EQ(got.tets.nodes, b.nodes) << name;
  };
  Vtu ascii;
  ascii.array = [](const auto& type, const auto& name, int n, const auto&, const auto& text) {
    return header(type, name, n, "format=\"ascii\"") + text + "</DataArray>";
  };
  expect("ascii.vtu", vtu_text(b, ascii) + end);

  Vtu binary;
  binary.array = [](const auto& type, const auto& name, int n, const auto& bytes, const auto&) {
    return header(type, name, n, "format=\"binary\"") + "\n  " +
           base64(raw<std::uint64_t>({bytes.size()}) + bytes) + "\n</DataArray>";
  };
  expect("binary.vtu", vtu_text(b, binary) + end);

  Vtu zipped;  // blocks of 1000 bytes, with the sizes in a separate base64 block
  zipped.attributes = "compressor=\"vtkZLibDataCompressor\"";
  zipped.array = [](const auto& type, const auto& name, int n, const auto& bytes, const auto&) {
    std::vector<std::uint64_t> sizes = {(bytes.size() + 999) / 1000, 1000, bytes.size() % 1000};
    std::string packed;
    for (std::size_t at = 0; at < bytes.size(); at += 1000) {
      const std::size_t size = std::min<std::size_t>(1000, bytes.size() - at);
      uLongf room = compressBound(size);
      std::string block(room, '\0');
      compress(reinterpret_cast<Bytef*>(block.data()), &room,
               reinterpret_cast<const Bytef*>(bytes.data() + at), size);
      packed.append(block, 0, room);
      sizes.push_back(room);
    }
    return header(type, name, n, "format=\"binary\"") + base64(raw(sizes)) + base64(packed) + "</DataArray>";
  };
  expect("zipped.vtu", vtu_text(b, zipped) + end);

  std::string all;  // raw bytes after the XML, which make the file invalid XML
  Vtu appended;
  appended.array = [&all](const auto& type, const auto& name, int n, const auto& bytes, const auto&) {
    const std::string out =
        header(type, name, n, fmt::format("format=\"appended\" offset=\"{}\"", all.size())) + "</DataArray>";
    all += raw<std::uint64_t>({bytes.size()}) + bytes;
    return out;
  };
  const std::string text = vtu_text(b, appended);
  expect("appended.vtu", text + "<AppendedData encoding=\"raw\">\n   _" + all + "\n</AppendedData>" + end);
}

TEST_F(ForeignFiles, ArraysOfVtuCellsAreRegions) {
  const auto text = [](const std::string& name, const std::string& values) {
    return "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
           "byte_order=\"LittleEndian\"><UnstructuredGrid><Piece NumberOfPoints=\"5\" "
           "NumberOfCells=\"3\"><CellData><DataArray type=\"Float64\" "
           "Name=\"stress\" format=\"ascii\">1 2 3</DataArray><DataArray type=\"Int32\" Name=\"" +
           name + "\" format=\"ascii\">" + values +
           "</DataArray></CellData><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
           "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points><Cells><DataArray "
           "type=\"Int64\" "
           "Name=\"connectivity\" format=\"ascii\">0 1 2 3 0 1 2 1 2 4 3</DataArray><DataArray "
           "type=\"Int64\" Name=\"offsets\" format=\"ascii\">4 7 11</DataArray><DataArray type=\"UInt8\" "
           "Name=\"types\" format=\"ascii\">10 5 10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
  };
  for (const std::string& name : model::known_region_arrays())
    EXPECT_EQ(regions_of(model::read_source(put("a.vtu", text(name, "4 8 3")))), "region-3: 1; region-4: 1; ")
        << name;
  EXPECT_EQ(regions_of(model::read_source(put("a.vtu", text("materialIDs", "4 8 3")))),
            "region-3: 1; region-4: 1; ");
  EXPECT_EQ(regions_of(model::read_source(put("a.vtu", text("temperature", "4 8 3")))), "");
  EXPECT_EQ(regions_of(model::read_source(put("a.vtu", text("Material", "4 8 4")))), "") << "all alike";
  const std::string path = put("a.vtu", text("Material", "4 8"));
  EXPECT_NE(refusal([&] { model::read_source(path); }).find("array \"Material\" has 2 numbers for 3 cells"),
            std::string::npos);
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

TEST_F(ForeignFiles, FieldsOfLegacyVtkCellsAreRegions) {
  const std::string head =
      "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 "
      "0 0 1 1 1 1\nCELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 1 2 4 3\nCELL_TYPES 3\n10 5 10\n";
  EXPECT_EQ(
      regions_of(model::read_source(put(
          "a.vtk", head + "POINT_DATA 5\nSCALARS Material int 1\nLOOKUP_TABLE default\n1 2 3 4 5\nCELL_DATA "
                          "3\nVECTORS flow float\n1 1 1 2 2 2 3 3 3\nFIELD all 2\nt 1 3 double\n1 2 3\n"
                          "Material 1 3 int\n4 8 3\n"))),
      "region-3: 1; region-4: 1; ");
  // Gmsh's output, in the form in which later versions end it.
  const std::string plain = put("plain.msh", msh_of_two("", {0, 0}));
  for (const bool binary : {false, true}) {
    int error = 0;
    model::start_gmsh(gmshInitialize, &error);
    gmshOptionSetNumber("General.Terminal", 0, &error);
    gmshOptionSetNumber("Mesh.SaveAll", 1, &error);
    gmshOptionSetNumber("Mesh.Binary", binary, &error);
    gmshOpen(plain.c_str(), &error);
    gmshWrite(at("d.vtk").c_str(), &error);
    gmshFinalize(&error);
    EXPECT_EQ(regions_of(model::read_source(at("d.vtk"))), "");
    std::string values;
    for (int t = 0; t < 80; ++t)
      values += binary ? std::string{'\0', '\0', '\0', t < 40 ? '\2' : '\5'} : t < 40 ? "2\n" : "5\n";
    std::ofstream(at("d.vtk"), std::ios::binary | std::ios::app)
        << "\nCELL_DATA 80\nSCALARS CellEntityIds int 1\nLOOKUP_TABLE default\n"
        << values;
    EXPECT_EQ(regions_of(model::read_source(at("d.vtk"))), "region-2: 40; region-5: 40; ") << binary;
  }
  EXPECT_EQ(regions_of(model::read_source(
                put("b.vtk", head + "CELL_DATA 3\nSCALARS heat int\nLOOKUP_TABLE default\n4 8 3\n"))),
            "");
  EXPECT_EQ(regions_of(model::read_source(put("c.vtk", head))), "");
}

TEST_F(ForeignFiles, TextsInALegacyVtkFileAreNoNumbers) {
  const std::string start = "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\n",
                    points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n";
  for (const std::string type : {"string", "bit"})
    for (const std::string& text :
         {start + "POINTS 2 " + type + "\n0\n0\n0\n1\n0\n0\n",
          start + points + "CELLS 2 4\nOFFSETS " + type + "\n0\n1\nCONNECTIVITY vtktypeint64\n0 1 2 3\n",
          start + points + "CELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY " + type + "\n0\n1\n0\n1\n"})
      EXPECT_NE(refusal([&] {
                  model::read_source(put("a.vtk", text));
                }).find("a.vtk: found type \"" + type + "\" where numbers are expected"),
                std::string::npos)
          << text;
  const std::string huge = start + points + "CELL_DATA 1\nFIELD f 1\nnames 99 99 string\n";
  EXPECT_NE(refusal([&] { model::read_source(put("b.vtk", huge)); }).find("b.vtk: is truncated"),
            std::string::npos);
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
