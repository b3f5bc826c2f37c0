#pragma once
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include "model/foreign_files.h"
#include "temporary_folder.h"

/// Files of other programs in a folder of the test.
namespace foreign_files {

using namespace palpate;

class ForeignFiles : public testing::Test {
 protected:
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::string put(const std::string& name, const std::string& text) const {
    std::ofstream(at(name), std::ios::binary) << text;
    return at(name);
  }
  TemporaryFolder folder_;
};

/// Returns "NAME: COUNT; " for each region.
inline std::string regions_of(const model::SourceFile& file) {
  std::string out;
  for (const MaterialRegion& region : file.regions)
    out += fmt::format("{}: {}; ", region.name, region.tets.size());
  return out;
}

/// A box of 80 tetrahedra in two volumes of 40, with those of volume 2 first in the file.
inline std::string msh_of_two(const std::string& names, const std::array<int, 2>& physical) {
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

}  // namespace foreign_files
