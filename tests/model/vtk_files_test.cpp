extern "C" {
#include <gmshc.h>
}
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <fstream>
#include <functional>

#include "foreign_files_fixture.h"
#include "model/gmsh_start.h"
#include "surfaces.h"

using namespace foreign_files;
using namespace palpate;
using namespace surfaces;

namespace {

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

}  // namespace
