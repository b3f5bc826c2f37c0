#pragma once
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "palpate/mesh/spec.h"

namespace palpate::compare {

/// Makes a shape of the model program at another resolution.
/// @throws Error where it cannot be made
using MakeModel = std::function<void(const std::string& name, long tetrahedra, long skin_vertices,
                                     const std::string& path)>;

/// Files with refined copies of the meshes and models of a scene, made on first request.
class RefinedMeshes {
 public:
  /// @param folder  folder of the files, created on first use
  /// @param make_model  empty: shapes are divided as other models
  RefinedMeshes(std::string folder, MakeModel make_model)
      : folder_(std::move(folder)), make_model_(std::move(make_model)) {}

  /// Returns the path of a copy whose tetrahedra are divided into eight `tets` times and whose skin triangles
  /// are divided into four `skin` times.  A shape of the model program ("model:head") with other tetrahedra
  /// is made anew from its formula, with eight times as many; then the numbers may be negative.  Otherwise
  /// shape, materials and bones stay as they are; a new node belongs to a bone where both ends of its edge
  /// do.  A skin is embedded anew.  The copy lists the edges whose midpoints its new nodes are, so that
  /// attachments hold the same part of the body.
  /// @param spec  mesh with a file or a generator, whose mesh is divided as one from a file
  /// @param scene_folder  base of a relative path
  /// @throws Error where the file cannot be read or written, or its skin cannot be embedded
  std::string path(const MeshSpec& spec, const std::string& scene_folder, int tets, int skin);

 private:
  void make_shape(const std::string& name, const std::string& from, int tets, int skin,
                  const std::string& out) const;

  std::string folder_;
  MakeModel make_model_;
  std::map<std::string, std::string> made_;  ///< By file and numbers of divisions.
};

}  // namespace palpate::compare
