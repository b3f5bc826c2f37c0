#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/types.h"

/// A run on disk: one HDF5 file in VTKHDF form, version 2.0, UnstructuredGrid with a temporal Steps group.
/// ParaView (5.12 or newer) opens it as a time series; h5py reads it.  The topology stands once, the points
/// and their data once a step.  Older ParaViews open the sidecar that is written beside it (xdmf.h).
namespace palpate::store {

/// One object of a run: a soft body by its tetrahedra, or a tool by its triangles.
struct RunPart {
  std::string name;  ///< of the object in the scene
  Points reference;  ///< positions at the start, from which displacements are measured [m]
  Tets tets;         ///< of a body; indices into its own points
  Faces faces;       ///< of a tool
};

/// What a run says of itself.
struct RunInfo {
  std::string scene_name;    ///< as the scene calls itself
  std::string scene_source;  ///< the effective TOML
  std::string version;       ///< of palpate, with its commit
  /// steps that the file has room for from the start: duration over period.  More can be appended, but a kill
  /// at the very moment when the file grows (at each doubling) can damage it.
  int expected_steps = 100;
};

/// Writes a run.  A step is committed by one number, the attribute NSteps, after all else of it is in the
/// file, and the room for the expected steps is made beforehand; so a process killed while it writes them
/// leaves a readable file with every committed step.
class RunFile {
 public:
  /// @param path  of the file, which is replaced  @param info  kept with it
  /// @param parts  their points follow one another in this order  @throws Error when the file cannot be made
  RunFile(const std::string& path, const std::vector<RunPart>& parts, const RunInfo& info);
  /// How far a file was written.
  struct Place {
    int steps = 0;        ///< that are whole
    std::string content;  ///< hash of their times, positions, velocities and stresses
  };
  /// Where the file is now.
  Place place() const;
  /// Goes on with a run's file behind that place: the steps before are brought into a new file, which takes
  /// the place of the old one.
  /// @throws Error where the file cannot be read, has fewer steps, other ones than were written, or other
  /// parts
  static RunFile continued(const std::string& path, const std::vector<RunPart>& parts, const RunInfo& info,
                           const Place& place);
  ~RunFile();
  /// Moved from, it may only be destroyed.
  RunFile(RunFile&&) noexcept;

  /// Appends one instant.
  /// @param time_s  greater than the last one's
  /// @param points, velocity  3 x point_count [m], [m/s]
  /// @param stress  point_count, von Mises [Pa]; all finite
  /// @throws Error when the disk refuses; the steps before stay readable
  void append(double time_s, const Points& points, const Points& velocity, const VecX& stress);
  /// Instants so far.
  int steps() const;
  /// Points of all parts together.
  int point_count() const;
  /// Releases room that was not needed, and writes the sidecar for older ParaViews.  Called by the destructor
  /// too, which swallows errors.
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads a run back, finished or not.
class RunReader {
 public:
  explicit RunReader(const std::string& path);  ///< @throws Error when this is no run of ours
  ~RunReader();
  /// Moved from, it may only be destroyed.
  RunReader(RunReader&&) noexcept;

  /// Complete instants in the file.
  int steps() const;
  /// Points of all parts together.
  int point_count() const;
  /// Of each instant [s].
  const std::vector<double>& times_s() const;
  /// What was kept with it.
  const RunInfo& info() const;
  /// As they were given to RunFile.
  const std::vector<RunPart>& parts() const;
  int first_point(int part) const;  ///< where a part's points begin

  /// Positions [m], 3 x point_count.
  Points points(int step) const;
  /// From the reference positions [m], 3 x point_count.
  Points displacement(int step) const;
  /// [m/s], 3 x point_count.
  Points velocity(int step) const;
  /// Von Mises stress at the points [Pa].
  VecX stress(int step) const;

 private:
  void read_through() const;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::store
