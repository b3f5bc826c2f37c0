#include "palpate/model/foreign_files.h"

extern "C" {
#include <gmshc.h>
}
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "palpate/mesh/checks.h"
#include "surfaces.h"

using namespace palpate;
using namespace surfaces;

namespace {

class ForeignFiles : public testing::Test {
 protected:
  ForeignFiles() : folder_(std::filesystem::temp_directory_path() / ("palpate-model-" + std::to_string(::getpid()))) { std::filesystem::create_directories(folder_); }
  ~ForeignFiles() override { std::filesystem::remove_all(folder_); }
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string put(const std::string& name, const std::string& text) const {
    std::ofstream(at(name), std::ios::binary) << text;
    return at(name);
  }
  std::filesystem::path folder_;
};

std::string words(const TriMesh& mesh, const std::string& before_point, const std::string& before_face, int first) {
  std::string out;
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) out += fmt::format("{}{:.17g} {:.17g} {:.17g}\n", before_point, mesh.vertices(0, v), mesh.vertices(1, v), mesh.vertices(2, v));
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) out += fmt::format("{}{} {} {}\n", before_face, mesh.faces(0, f) + first, mesh.faces(1, f) + first, mesh.faces(2, f) + first);
  return out;
}

void expect_surface(const std::string& path, const TriMesh& wanted, double tolerance) {
  const model::SourceFile got = model::read_source(path);
  const model::RepairedSurface result = model::repair(got.surface, got.from);
  EXPECT_EQ(result.surface.vertices.cols(), wanted.vertices.cols()) << path;
  EXPECT_EQ(result.surface.faces.cols(), wanted.faces.cols()) << path;
  EXPECT_NEAR(volume(result.surface), volume(wanted), tolerance) << path;
}

TEST_F(ForeignFiles, SurfacesAsText) {
  const TriMesh b = box();
  expect_surface(put("a.obj", words(b, "v ", "f ", 1)), b, 1e-12);
  expect_surface(put("a.off", fmt::format("OFF\n{} {} 0\n", b.vertices.cols(), b.faces.cols()) + words(b, "", "3 ", 0)), b, 1e-12);
  expect_surface(put("a.ply", fmt::format("ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\nelement face {}\nproperty list uchar int "
                                          "vertex_indices\nend_header\n",
                                          b.vertices.cols(), b.faces.cols()) +
                                  words(b, "", "3 ", 0)),
                 b, 1e-12);
  std::string stl = "solid a\n";
  for (Eigen::Index f = 0; f < b.faces.cols(); ++f) {
    stl += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) stl += fmt::format("vertex {:.9g} {:.9g} {:.9g}\n", b.vertices(0, b.faces(k, f)), b.vertices(1, b.faces(k, f)), b.vertices(2, b.faces(k, f)));
    stl += "endloop\nendfacet\n";
  }
  expect_surface(put("a.stl", stl + "endsolid a\n"), b, 1e-6);
}

TEST_F(ForeignFiles, SurfacesAsBytes) {
  const TriMesh b = box();
  std::string stl(80, ' '), ply = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\nproperty list uchar int "
                                              "vertex_indices\nend_header\n",
                                              b.vertices.cols(), b.faces.cols());
  const auto add = [](std::string& to, const auto& value) { to.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
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

/// Gmsh itself writes the tetrahedra of a box in every format that it has.
TEST_F(ForeignFiles, TetrahedraByGmsh) {
  const TetMesh b = mesh::box(Vec3(2, 1, 1), {4, 2, 2});
  std::string msh = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", b.nodes.cols());
  for (Eigen::Index i = 0; i < b.nodes.cols(); ++i) msh += fmt::format("{} {:.17g} {:.17g} {:.17g}\n", i + 1, b.nodes(0, i), b.nodes(1, i), b.nodes(2, i));
  msh += fmt::format("$EndNodes\n$Elements\n{}\n", b.tets.cols());
  for (Eigen::Index t = 0; t < b.tets.cols(); ++t) msh += fmt::format("{} 4 2 1 1 {} {} {} {}\n", t + 1, b.tets(0, t) + 1, b.tets(1, t) + 1, b.tets(2, t) + 1, b.tets(3, t) + 1);
  put("a.msh", msh + "$EndElements\n");

  int error = 0;
  gmshInitialize(0, nullptr, 0, &error);
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
  const std::vector<std::tuple<std::string, double, double>> kinds = {{"1.msh", 1.0, 0}, {"22.msh", 2.2, 0}, {"22b.msh", 2.2, 1}, {"41.msh", 4.1, 0}, {"41b.msh", 4.1, 1}, {"a.vtk", 4.1, 0}, {"b.vtk", 4.1, 1},
                                                                      {"a.mesh", 4.1, 0}};
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

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

template <class T>
std::string raw(const std::vector<T>& values) { return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)}; }

/// The four arrays of a VTU file, each in one of the ways in which VTK writes them.
struct Vtu {
  std::string attributes, appended, appended_encoding;
  std::function<std::string(const std::string& type, const std::string& name, int components, const std::string& bytes, const std::string& text)> array;
};

std::string vtu_text(const TetMesh& mesh, Vtu way) {
  std::vector<double> points(mesh.nodes.data(), mesh.nodes.data() + mesh.nodes.size());
  std::vector<std::int64_t> connectivity(mesh.tets.data(), mesh.tets.data() + mesh.tets.size()), offsets;
  std::vector<std::uint8_t> types(static_cast<std::size_t>(mesh.tets.cols()), 10);
  for (Eigen::Index t = 1; t <= mesh.tets.cols(); ++t) offsets.push_back(4 * t);
  const std::string body = fmt::format("<Points>{}</Points><Cells>{}{}{}</Cells>", way.array("Float64", "Points", 3, raw(points), fmt::format("{}", fmt::join(points, " "))),
                                       way.array("Int64", "connectivity", 1, raw(connectivity), fmt::format("{}", fmt::join(connectivity, " "))),
                                       way.array("Int64", "offsets", 1, raw(offsets), fmt::format("{}", fmt::join(offsets, "\n"))),
                                       way.array("UInt8", "types", 1, raw(types), fmt::format("{}", fmt::join(types, " "))));
  return fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" {}><UnstructuredGrid><Piece NumberOfPoints=\"{}\" "
                     "NumberOfCells=\"{}\">{}</Piece></UnstructuredGrid>",
                     way.attributes, mesh.nodes.cols(), mesh.tets.cols(), body);
}

std::string header(const std::string& type, const std::string& name, int components, const std::string& format) {
  return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" {}>", type, name, components, format);
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
  ascii.array = [](const auto& type, const auto& name, int n, const auto&, const auto& text) { return header(type, name, n, "format=\"ascii\"") + text + "</DataArray>"; };
  expect("ascii.vtu", vtu_text(b, ascii) + end);

  Vtu binary;
  binary.array = [](const auto& type, const auto& name, int n, const auto& bytes, const auto&) {
    return header(type, name, n, "format=\"binary\"") + "\n  " + base64(raw<std::uint64_t>({bytes.size()}) + bytes) + "\n</DataArray>";
  };
  expect("binary.vtu", vtu_text(b, binary) + end);

  Vtu zipped;  // blocks of 1000 bytes, the sizes in base64 of their own
  zipped.attributes = "compressor=\"vtkZLibDataCompressor\"";
  zipped.array = [](const auto& type, const auto& name, int n, const auto& bytes, const auto&) {
    std::vector<std::uint64_t> sizes = {(bytes.size() + 999) / 1000, 1000, bytes.size() % 1000};
    std::string packed;
    for (std::size_t at = 0; at < bytes.size(); at += 1000) {
      const std::size_t size = std::min<std::size_t>(1000, bytes.size() - at);
      uLongf room = compressBound(size);
      std::string block(room, '\0');
      compress(reinterpret_cast<Bytef*>(block.data()), &room, reinterpret_cast<const Bytef*>(bytes.data() + at), size);
      packed.append(block, 0, room);
      sizes.push_back(room);
    }
    return header(type, name, n, "format=\"binary\"") + base64(raw(sizes)) + base64(packed) + "</DataArray>";
  };
  expect("zipped.vtu", vtu_text(b, zipped) + end);

  std::string all;  // raw bytes after the XML, which is no XML any more
  Vtu appended;
  appended.array = [&all](const auto& type, const auto& name, int n, const auto& bytes, const auto&) {
    const std::string out = header(type, name, n, fmt::format("format=\"appended\" offset=\"{}\"", all.size())) + "</DataArray>";
    all += raw<std::uint64_t>({bytes.size()}) + bytes;
    return out;
  };
  const std::string text = vtu_text(b, appended);
  expect("appended.vtu", text + "<AppendedData encoding=\"raw\">\n   _" + all + "\n</AppendedData>" + end);
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
  EXPECT_NE(message("a.vtu", "<VTKFile type=\"PolyData\"/>").find("is no VTK file of an unstructured grid, but of \"PolyData\""), std::string::npos);
  EXPECT_NE(message("b.vtu", "<VTKFile").find("is no XML"), std::string::npos);
  EXPECT_NE(message("a.mesh", "MeshVersionFormatted 1\nDimension 3\nEnd\n"), "accepted");
  EXPECT_NE(message("a.msh", "$NOD\n1\n1 0 0 0\n$ENDNOD\n$ELM\n0\n$ENDELM\n"), "accepted");
  EXPECT_NE(refusal([&] { model::read_source(at("nothing.obj")); }).find("no such file"), std::string::npos);
}

TEST_F(ForeignFiles, HexahedraAreRefusedByName) {
  const std::string path = put("hex.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n1\n1 5 2 1 1 1 2 3 4 5 6 7 8\n$EndElements\n");
  EXPECT_NE(refusal([&] { model::read_source(path); }).find("holds 1 hexahedra, which are not read"), std::string::npos) << refusal([&] { model::read_source(path); });
}

TEST_F(ForeignFiles, RealGmsh1) {
  const char* folder = std::getenv("PALPATE_TEST_DATA");
  if (folder == nullptr) GTEST_SKIP() << "PALPATE_TEST_DATA is not set";
  const model::SourceFile got = model::read_source(std::string(folder) + "/liver2.msh");
  EXPECT_EQ(got.format, "Gmsh 1");
  EXPECT_EQ(got.tets.nodes.cols(), 507);
  EXPECT_EQ(got.tets.tets.cols(), 1493);  // beside 931 triangles, 2,424 elements in all
}

}  // namespace
