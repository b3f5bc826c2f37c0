#pragma once
#include <memory>
#include <string>
#include <vector>

#include "palpate/core/types.h"
#include "palpate/store/run_reader.h"

/// Run files: one HDF5 file per run in VTKHDF form, version 2.0, UnstructuredGrid with a temporal Steps
/// group. ParaView (5.12 or newer) opens it as a time series; h5py reads it.  The topology is stored once,
/// points and point data once per step.  Older ParaViews open the XDMF sidecar written next to it (xdmf.h).
namespace palpate::store {

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

}  // namespace palpate::store
