#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/types.h"

/// Run files: one HDF5 file per run in VTKHDF form, version 2.0, UnstructuredGrid with a temporal Steps
/// group. ParaView (5.12 or newer) opens it as a time series; h5py reads it.  The topology is stored once,
/// points and point data once per step.  Older ParaViews open the XDMF sidecar written next to it (xdmf.h).
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

/// Writes a run.  A step is committed by one number, the attribute NSteps, after all its data are in the
/// file, and the space for the expected steps is allocated beforehand; so a process killed while it writes
/// them leaves a readable file with every committed step.
class RunFile {
 public:
  /// Creates the file.
  /// @param path  file, which is replaced
  /// @param info  stored with the run
  /// @param parts  objects; their points are concatenated in this order
  /// @throws Error when the file cannot be created
  RunFile(const std::string& path, const std::vector<RunPart>& parts, const RunInfo& info);
  /// Progress of a file.
  struct Place {
    int steps = 0;        ///< Number of complete steps.
    std::string content;  ///< Hash of their times, positions, velocities and stresses.
  };
  /// Returns the present progress.
  Place place() const;
  /// Resumes a run's file at that place: copies the earlier steps into a new file, which then replaces the
  /// old one.
  /// @throws Error where the file cannot be read, has fewer steps, steps other than those written, or other
  ///   parts
  static RunFile continued(const std::string& path, const std::vector<RunPart>& parts, const RunInfo& info,
                           const Place& place);
  ~RunFile();
  /// Moves the file; the source may only be destroyed.
  RunFile(RunFile&&) noexcept;

  /// Appends one step.
  /// @param time_s  time, greater than in the previous step [s]
  /// @param points, velocity  3 x point_count [m], [m/s]
  /// @param stress  von Mises stress, point_count entries [Pa]; all values must be finite
  /// @throws Error when writing fails; earlier steps stay readable
  void append(double time_s, const Points& points, const Points& velocity, const VecX& stress);
  /// Returns the number of steps so far.
  int steps() const;
  /// Returns the total number of points of all parts.
  int point_count() const;
  /// Releases unused space, and writes the sidecar for older ParaViews.  The destructor calls it too, and
  /// ignores errors.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
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
