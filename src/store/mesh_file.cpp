#include "store/mesh_file.h"

#include <limits>

#include "core/sandbox.h"
#include "palpate/core/error.h"
#include "store/h5.h"
#include "store/model_format.h"

namespace palpate::store {
namespace {

/// Returns the number of rows of a data set n x width, or throws Error.
Eigen::Index rows_of(const h5::Opened& set, const char* name, hsize_t width, const std::string& path) {
  if (set.shape[1] != width)
    fail("{}: \"{}\" is {} x {}, must be n x {}", path, name, set.shape[0], set.shape[1], width);
  if (set.shape[0] == 0 || set.shape[0] > static_cast<hsize_t>(std::numeric_limits<int>::max()))
    fail("{}: \"{}\" has {} rows, must have between 1 and {}", path, name, set.shape[0],
         std::numeric_limits<int>::max());
  return static_cast<Eigen::Index>(set.shape[0]);
}

TetMesh mesh_in(const std::string& path) {
  const h5::Quiet quiet;
  const h5::Id file = h5::open_file(path);
  // Files made by other programs may lack the attribute; another value means another format.
  if (H5Aexists(file, "format") > 0)
    if (const std::string format = h5::read_attribute_text(file, "format", path);
        format != kMeshFormat && format != kModelFormat)
      fail("{}: format is \"{}\", must be \"{}\" or \"{}\"", path, format, kMeshFormat, kModelFormat);

  TetMesh mesh;
  const h5::Opened nodes = h5::open(file, "nodes", H5T_FLOAT, 2, path),
                   tets = h5::open(file, "tets", H5T_INTEGER, 2, path);
  mesh.nodes.resize(3, rows_of(nodes, "nodes", 3, path));
  Eigen::Matrix<long long, 4, Eigen::Dynamic> wide(4, rows_of(tets, "tets", 4, path));
  h5::read(nodes, "nodes", H5T_NATIVE_DOUBLE, mesh.nodes.data(), path);
  h5::read(tets, "tets", H5T_NATIVE_LLONG, wide.data(), path);
  for (Eigen::Index i = 0; i < mesh.nodes.cols(); ++i)
    if (!mesh.nodes.col(i).allFinite())
      fail("{}: nodes[{}] = ({}, {}, {}) is not finite", path, i, mesh.nodes(0, i), mesh.nodes(1, i),
           mesh.nodes(2, i));
  for (Eigen::Index i = 0; i < wide.cols(); ++i)
    for (int corner = 0; corner < 4; ++corner)
      if (wide(corner, i) < 0 || wide(corner, i) >= mesh.nodes.cols())
        fail("{}: tets[{}] refers to node {}, must lie in [0, {}); indices count from 0", path, i,
             wide(corner, i), mesh.nodes.cols());
  mesh.tets = wide.cast<int>();
  return mesh;
}

}  // namespace

void write_mesh(const std::string& path, const TetMesh& mesh) {
  const h5::Quiet quiet;
  const h5::Id file = h5::create_file(path);
  h5::write_attribute_text(file, "format", kMeshFormat, path);
  h5::write(file, "nodes", H5T_NATIVE_DOUBLE, {static_cast<hsize_t>(mesh.nodes.cols()), 3}, mesh.nodes.data(),
            path);
  h5::write(file, "tets", H5T_NATIVE_INT, {static_cast<hsize_t>(mesh.tets.cols()), 4}, mesh.tets.data(),
            path);
  h5::check(H5Fflush(file, H5F_SCOPE_LOCAL), path, "cannot be flushed; is the disk full?");
}

TetMesh read_mesh(const std::string& path) {
  return rehearsed(path, "HDF5", [&] { return mesh_in(path); });
}

}  // namespace palpate::store
