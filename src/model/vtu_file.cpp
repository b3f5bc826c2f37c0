#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <pugixml.hpp>

#include "cells.h"
#include "foreign_files.h"
#include "format_readers.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

// VTK's XML files (VTK User's Guide 11, "VTK file formats"): arrays as text, as base64 in place, or appended
// (base64 or raw) at an offset; the bytes are
//   [size][data]                                                        uncompressed, or
//   [blocks][size of a block][size of the last, 0: whole][sizes when compressed ...][compressed blocks ...]
// with all sizes of type header_type.  In base64 the sizes may be encoded separately from the data, each
// ending with padding: decoding continues after padding.
namespace palpate::model {
namespace {

struct Document {
  std::string path;
  pugi::xml_document xml;
  std::string kind;      ///< "UnstructuredGrid" or "PolyData"
  std::string appended;  ///< the data after the underscore
  bool appended_raw = false, compressed = false, wide_header = false, swap = false;
};

/// Decodes base64 text up to its end or the first character that is neither base64 nor white space; continues
/// after padding.
std::string decode_base64(std::string_view text) {
  const auto value = [](char c) -> int {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : c == '=' ? -1 : -2;
  };
  std::string out;
  std::uint32_t bits = 0;
  int held = 0, padding = 0;
  for (const char c : text) {
    const int v = value(c);
    if (v == -2) {
      if (c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
      break;  // end of appended data
    }
    bits = (bits << 6) | static_cast<std::uint32_t>(v < 0 ? 0 : v);
    padding += v < 0;
    if (++held < 4) continue;
    for (int byte = 0; byte < 3 - padding; ++byte) out += static_cast<char>((bits >> (16 - 8 * byte)) & 0xff);
    bits = 0;
    held = padding = 0;
  }
  return out;
}

template <class T>
T value_at(const Document& document, const std::string& bytes, std::size_t at, const std::string& what) {
  if (at + sizeof(T) > bytes.size()) fail("{}: {} is truncated", document.path, what);
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), bytes.data() + at, sizeof(T));
  if (document.swap) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<T>(raw);
}

std::uint64_t header_at(const Document& document, const std::string& bytes, std::size_t number,
                        const std::string& what) {
  return document.wide_header ? value_at<std::uint64_t>(document, bytes, 8 * number, what)
                              : value_at<std::uint32_t>(document, bytes, 4 * number, what);
}

/// Returns the array's bytes, without sizes, uncompressed.
std::string payload(const Document& document, const std::string& bytes, const std::string& what) {
  const std::size_t word = document.wide_header ? 8 : 4;
  if (!document.compressed) {
    const std::uint64_t size = header_at(document, bytes, 0, what);
    if (size > bytes.size() - word)
      fail("{}: {} is truncated: {} of {} bytes", document.path, what, bytes.size() - word, size);
    return bytes.substr(word, size);
  }
  const std::uint64_t blocks = header_at(document, bytes, 0, what),
                      whole = header_at(document, bytes, 1, what), last = header_at(document, bytes, 2, what);
  if (blocks > bytes.size() || whole > (std::uint64_t{1} << 32))
    fail("{}: {} has a damaged header", document.path, what);
  std::string out;
  std::size_t at = (3 + blocks) * word;
  for (std::uint64_t b = 0; b < blocks; ++b) {
    const std::uint64_t packed = header_at(document, bytes, 3 + b, what);
    if (at > bytes.size() || packed > bytes.size() - at) fail("{}: {} is truncated", document.path, what);
    uLongf size = b + 1 == blocks && last != 0 ? last : whole;
    constexpr std::uint64_t kMostCompressed = 1100;  // deflate reaches 1032
    if (size > kMostCompressed * (packed + 1))
      fail("{}: {} has a damaged header: {} bytes in {} compressed ones", document.path, what, size, packed);
    std::string block(size, '\0');
    if (::uncompress(reinterpret_cast<Bytef*>(block.data()), &size,
                     reinterpret_cast<const Bytef*>(bytes.data() + at), packed) != Z_OK)
      fail("{}: {} cannot be decompressed", document.path, what);
    out.append(block, 0, size);
    at += packed;
  }
  return out;
}

template <class T, class Out>
void convert(const Document& document, const std::string& bytes, const std::string& what,
             std::vector<Out>& out) {
  for (std::size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T))
    out.push_back(static_cast<Out>(value_at<T>(document, bytes, at, what)));
}

template <class Out>
std::vector<Out> from_text(const Document& document, std::string_view text, const std::string& what) {
  std::vector<Out> out;
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (;;) {
    while (at != end && (*at == ' ' || *at == '\n' || *at == '\r' || *at == '\t')) ++at;
    if (at == end) return out;
    Out value{};
    const auto [next, code] = std::from_chars(at, end, value);
    if (code != std::errc())
      fail("{}: {}: \"{}\" is not a number", document.path, what,
           std::string_view(at, std::min<std::size_t>(20, static_cast<std::size_t>(end - at))));
    out.push_back(value);
    at = next;
  }
}

template <class Out>
std::vector<Out> numbers(const Document& document, const pugi::xml_node& array, const std::string& what) {
  if (!array) fail("{}: has no {}", document.path, what);
  const std::string format = array.attribute("format").as_string("ascii"),
                    type = array.attribute("type").as_string();
  if (format == "ascii") return from_text<Out>(document, array.child_value(), what);
  std::string bytes;
  if (format == "binary") {
    bytes = decode_base64(array.child_value());
  } else if (format == "appended") {
    const std::size_t offset = array.attribute("offset").as_ullong();
    if (offset >= document.appended.size())
      fail("{}: {} starts at {} of {} appended bytes", document.path, what, offset, document.appended.size());
    bytes = document.appended_raw ? document.appended.substr(offset)
                                  : decode_base64(std::string_view(document.appended).substr(offset));
  } else {
    fail("{}: {} has the unknown format \"{}\"", document.path, what, format);
  }
  bytes = payload(document, bytes, what);
  std::vector<Out> out;
  if (type == "Float64")
    convert<double>(document, bytes, what, out);
  else if (type == "Float32")
    convert<float>(document, bytes, what, out);
  else if (type == "Int64")
    convert<std::int64_t>(document, bytes, what, out);
  else if (type == "UInt64")
    convert<std::uint64_t>(document, bytes, what, out);
  else if (type == "Int32")
    convert<std::int32_t>(document, bytes, what, out);
  else if (type == "UInt32")
    convert<std::uint32_t>(document, bytes, what, out);
  else if (type == "UInt8")
    convert<std::uint8_t>(document, bytes, what, out);
  else if (type == "Int8")
    convert<std::int8_t>(document, bytes, what, out);
  else
    fail("{}: {} has the unknown type \"{}\"", document.path, what, type);
  return out;
}

/// Loads the document.  Appended raw bytes are not XML and are removed before the rest is parsed.
void load(Document& document) {
  std::string text = store::read_file(document.path);
  if (const std::size_t tag = text.find("<AppendedData"); tag != std::string::npos) {
    const std::size_t close = text.find('>', tag), start = text.find('_', close);
    if (close == std::string::npos || start == std::string::npos)
      fail("{}: its appended data do not start with an underscore", document.path);
    document.appended_raw = text.substr(tag, close - tag).find("raw") != std::string::npos;
    document.appended = text.substr(start + 1);
    text = text.substr(0, tag) + "</VTKFile>";
  }
  if (const pugi::xml_parse_result parsed = document.xml.load_buffer(text.data(), text.size()); !parsed)
    fail("{}: is not valid XML at byte {}: {}", document.path, parsed.offset, parsed.description());
  const pugi::xml_node root = document.xml.child("VTKFile");
  document.kind = root.attribute("type").as_string();
  if (document.kind != "UnstructuredGrid" && document.kind != "PolyData")
    fail("{}: is not a VTK file of an unstructured grid or a surface (PolyData), but of \"{}\"",
         document.path, document.kind);
  const std::string compressor = root.attribute("compressor").as_string();
  if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
    fail("{}: is compressed by {}; only vtkZLibDataCompressor is supported", document.path, compressor);
  document.compressed = !compressor.empty();
  document.wide_header = std::string(root.attribute("header_type").as_string("UInt32")) == "UInt64";
  document.swap = (std::string(root.attribute("byte_order").as_string("LittleEndian")) == "BigEndian") !=
                  (std::endian::native == std::endian::big);
}

/// Returns the region numbers of a piece's cells; empty if it has no known region array.
std::vector<double> labels_of(const Document& document, const pugi::xml_node& piece, std::size_t cells) {
  for (const std::string& known : known_region_arrays())
    for (const pugi::xml_node& array : piece.child("CellData").children("DataArray")) {
      if (lower(array.attribute("Name").as_string()) != lower(known)) continue;
      std::vector<double> out =
          numbers<double>(document, array, fmt::format("array \"{}\"", array.attribute("Name").as_string()));
      if (out.size() != cells)
        fail("{}: array \"{}\" has {} numbers for {} cells", document.path,
             array.attribute("Name").as_string(), out.size(), cells);
      return out;
    }
  return {};
}

/// Reads the cells of one section, from their connectivity and end offsets.
std::vector<std::vector<int>> cells_in(const Document& document, const pugi::xml_node& section, int first,
                                       std::size_t points) {
  const auto array = [&](const char* name) {
    return numbers<long long>(document, section.find_child_by_attribute("DataArray", "Name", name),
                              fmt::format("array \"{}\"", name));
  };
  const std::vector<long long> connectivity = array("connectivity"), offsets = array("offsets");
  std::vector<std::vector<int>> out;
  long long begin = 0;
  for (std::size_t c = 0; c < offsets.size(); ++c) {
    if (offsets[c] < begin || offsets[c] > static_cast<long long>(connectivity.size()))
      fail("{}: cell {} ends at {} of {} entries", document.path, c, offsets[c], connectivity.size());
    std::vector<int>& corners = out.emplace_back();
    for (; begin < offsets[c]; ++begin) {
      const long long corner = connectivity[static_cast<std::size_t>(begin)];
      if (corner < 0 || corner >= static_cast<long long>(points))
        fail("{}: cell {} refers to point {}, but the piece has {} points", document.path, c, corner, points);
      corners.push_back(first + static_cast<int>(corner));
    }
  }
  return out;
}

void take_grid(const Document& document, const pugi::xml_node& piece, int first, std::size_t points,
               Cells& cells) {
  const auto list = cells_in(document, piece.child("Cells"), first, points);
  const auto types =
      numbers<long long>(document, piece.child("Cells").find_child_by_attribute("DataArray", "Name", "types"),
                         "array \"types\"");
  if (list.size() != types.size())
    fail("{}: has {} offsets and {} types of cells", document.path, list.size(), types.size());
  const std::vector<double> labels = labels_of(document, piece, list.size());
  if (!labels.empty()) cells.labels.resize(cells.tetrahedra(), 0.0);
  for (std::size_t c = 0; c < list.size(); ++c) {
    const std::size_t before = cells.tetrahedra();
    take_vtk_cell(cells, static_cast<int>(types[c]), list[c]);
    if ((!labels.empty() || !cells.labels.empty()) && cells.tetrahedra() > before)
      cells.labels.push_back(labels.empty() ? 0.0 : labels[c]);
  }
}

void take_surface(const Document& document, const pugi::xml_node& piece, int first, std::size_t points,
                  Cells& cells) {
  constexpr int kStrip = 6, kPolygon = 7;
  for (const auto& [section, type] : {std::pair("Polys", kPolygon), std::pair("Strips", kStrip)})
    if (piece.child(section).child("DataArray"))
      for (const std::vector<int>& corners : cells_in(document, piece.child(section), first, points))
        take_vtk_cell(cells, type, corners);
}

}  // namespace

SourceFile read_vtk_xml(const std::string& path) {
  Document document;
  document.path = path;
  load(document);
  const pugi::xml_node root = document.xml.child("VTKFile");
  const bool grid = document.kind == "UnstructuredGrid";
  Cells cells(path);
  for (const pugi::xml_node& piece : root.child(document.kind.c_str()).children("Piece")) {
    const int first = static_cast<int>(cells.points.size());
    // An empty piece may have no arrays.
    if (piece.attribute("NumberOfPoints").as_ullong() == 0) continue;
    const auto x = numbers<double>(document, piece.child("Points").child("DataArray"), "points");
    for (std::size_t i = 0; i + 2 < x.size(); i += 3) cells.points.emplace_back(x[i], x[i + 1], x[i + 2]);
    grid ? take_grid(document, piece, first, x.size() / 3, cells)
         : take_surface(document, piece, first, x.size() / 3, cells);
  }
  return cells.finish("VTK XML");
}

}  // namespace palpate::model
