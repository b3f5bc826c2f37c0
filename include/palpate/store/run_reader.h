#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/types.h"

namespace palpate::store {

/// Object of a run: a soft body given by tetrahedra, or a tool given by triangles.
struct RunPart {
  std::string name;  ///< Name of the object in the scene.
  Points reference;  ///< Initial positions, the reference for displacements [m].
  Tets tets;         ///< Tetrahedra of a body; indices into this part's points.
  Faces faces;       ///< Triangles of a tool; indices into this part's points.
};

/// Description of a run, stored in its file.
struct RunInfo {
  std::string scene_name;    ///< Name given in the scene.
  std::string scene_source;  ///< Effective scene, as TOML.
  std::string version;       ///< Version of palpate, with its commit.
  /// Number of steps for which space is allocated at the start: duration over period.  More can be appended,
  /// but a kill while the file grows (at each doubling) can damage it.
  int expected_steps = 100;
};

/// Reads a run file, finished or not.
class RunReader {
 public:
  explicit RunReader(const std::string& path);  ///< @throws Error when the file is no run of palpate
  ~RunReader();
  /// Moves the reader; the source may only be destroyed.
  RunReader(RunReader&&) noexcept;

  /// Returns the number of complete steps in the file.
  int steps() const;
  /// Returns the total number of points of all parts.
  int point_count() const;
  /// Returns the time of each step [s].
  const std::vector<double>& times_s() const;
  /// Returns the description that was stored with the run.
  const RunInfo& info() const;
  /// Returns the parts as they were given to RunFile.
  const std::vector<RunPart>& parts() const;
  int first_point(int part) const;  ///< Index of a part's first point.

  /// Returns the positions, 3 x point_count [m].
  Points points(int step) const;
  /// Returns the displacements from the reference positions, 3 x point_count [m].
  Points displacement(int step) const;
  /// Returns the velocities, 3 x point_count [m/s].
  Points velocity(int step) const;
  /// Returns the von Mises stress at the points [Pa].
  VecX stress(int step) const;

 private:
  void read_through() const;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::store
