#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "cells.h"
#include "format_readers.h"
#include "palpate/core/error.h"
#include "store/atomic_file.h"

// Medit's binary form (Marechal, "Handling unstructured meshes and solutions", libMeshb's manual):
//   int32 1 in the writer's byte order; int32 version; then blocks:  int32 keyword, position of the next
//   block (0: the last), content.
//   Version 1 has float coordinates, 2 and above double; positions are int32 up to version 2, int64 from 3;
//   counts and indices are int32 up to 3, int64 in 4.
//   Dimension (3): int32.   Vertices (4): count, then 3 numbers and a reference each.   Triangles (6),
//   quadrilaterals (7), tetrahedra (8) and other cells:
//   count, then the vertices from 1 and a reference each.   End (54).
namespace palpate::model {
namespace {

constexpr int kDimension = 3, kVertices = 4, kTriangles = 6, kQuadrilaterals = 7, kTetrahedra = 8,
              kPrisms = 9, kHexahedra = 10, kPyramids = 49, kEnd = 54;

class Meshb {
 public:
  explicit Meshb(std::string path) : path_(std::move(path)), bytes_(store::read_file(path_)) {
    const auto order = number<std::int32_t>();
    swap_ = order == 0x01000000;
    if (!swap_ && order != 1)
      fail("{}: is not a binary Medit file: it does not start with the number 1", path_);
    version_ = number<std::int32_t>();
    if (version_ < 1 || version_ > 4) fail("{}: has version {}, 1 to 4 are read", path_, version_);
  }

  SourceFile read() {
    Cells cells(path_);
    for (bool more = true; more && at_ < bytes_.size();) {
      const auto keyword = number<std::int32_t>();
      const std::int64_t next = version_ < 3 ? number<std::int32_t>() : number<std::int64_t>();
      if (keyword == kEnd) break;
      take(keyword, cells);
      more = next != 0;
      if (more && next < static_cast<std::int64_t>(at_))
        fail("{}: the block of keyword {} ends at byte {}, its content at {}", path_, keyword, next, at_);
      if (more && next > static_cast<std::int64_t>(bytes_.size()))
        fail("{}: is truncated: a block is expected at byte {} of {}", path_, next, bytes_.size());
      if (more) at_ = static_cast<std::size_t>(next);
    }
    return cells.finish("Medit binary");
  }

 private:
  void take(int keyword, Cells& cells) {
    if (keyword == kDimension) {
      if (const auto dimension = number<std::int32_t>(); dimension != 3)
        fail("{}: has {} dimensions, must have 3", path_, dimension);
    } else if (keyword == kVertices) {
      for (std::int64_t n = count(); n > 0; --n) {
        const double x = coordinate(), y = coordinate(), z = coordinate();
        cells.points.emplace_back(x, y, z);
        index();
      }
    } else if (keyword == kTriangles || keyword == kQuadrilaterals) {
      for (std::int64_t n = count(); n > 0; --n) cells.polygon(corners(keyword == kTriangles ? 3 : 4));
    } else if (keyword == kTetrahedra) {
      for (std::int64_t n = count(); n > 0; --n) {
        const std::vector<int> c = corners(4);
        cells.tetrahedron(c[0], c[1], c[2], c[3]);
        cells.labels.push_back(static_cast<double>(reference_));
      }
    } else if (keyword == kPrisms || keyword == kHexahedra || keyword == kPyramids) {
      if (count() > 0)
        cells.unread(keyword == kPrisms ? "prisms" : keyword == kHexahedra ? "hexahedra" : "pyramids");
    }
  }
  /// Reads the points of one element, counted from 0, and stores its reference.
  std::vector<int> corners(int number_of_them) {
    std::vector<int> out;
    // Cells::finish rejects indices out of range.
    for (int k = 0; k < number_of_them; ++k)
      out.push_back(static_cast<int>(std::clamp<std::int64_t>(index(), 0, 2'000'000'000)) - 1);
    reference_ = index();
    return out;
  }
  std::int64_t index() { return version_ < 4 ? number<std::int32_t>() : number<std::int64_t>(); }
  double coordinate() { return version_ == 1 ? number<float>() : number<double>(); }
  std::int64_t count() {
    const std::int64_t n = index();
    if (n < 0 || n > static_cast<std::int64_t>(bytes_.size()))
      fail("{}: declares {} entries in {} bytes", path_, n, bytes_.size());
    return n;
  }
  template <class T>
  T number() {
    if (at_ + sizeof(T) > bytes_.size()) fail("{}: is truncated at byte {}", path_, bytes_.size());
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if (swap_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

  std::string path_, bytes_;
  std::size_t at_ = 0;
  bool swap_ = false;
  int version_ = 0;
  std::int64_t reference_ = 0;
};

}  // namespace

SourceFile read_meshb(const std::string& path) { return Meshb(path).read(); }

}  // namespace palpate::model
